// What the forces on the particles get of the flow, and what comes back of the pressure gradient.
#include "cfd_server/vans/flow_fields.hpp"

#include <gtest/gtest.h>

#include <set>

#include "cfd_server/backends/native/fluid_participant.hpp"
#include "proto/base/errors.hpp"
#include "proto/participant/asked_fields.hpp"
#include "proto/participant/field_names.hpp"
#include "tests/unit/cfd_server/fluid_case.hpp"
#include "tests/unit/cfd_server/perturbed_box.hpp"

namespace fluxpact {
namespace {

const std::vector<InterphaseForce> all_forces{
    InterphaseForce::pressure_gradient, InterphaseForce::viscous,
    InterphaseForce::added_mass,        InterphaseForce::saffman_lift,
    InterphaseForce::magnus_lift,       InterphaseForce::turbulent_dispersion};

/// A closed box whose walls move as the test's own field says.
struct Flow {
  explicit Flow(bool irregular) : c({5, 4, 6}, {1, 0.8, 1.2}) {
    c.scene.fluid.viscosity = 2;
    c.scene.fluid.boundaries["walls"] = wall(Slip::none);
    c.scene.interphase.forces = all_forces;
    c.make_mesh();
    if (irregular) c.mesh = perturbed(c.mesh, {0.2, 0.2, 0.2}, 0.15, 4);
    problem = make_problem(c.scene, c.mesh);
    fields.emplace(c.scene, problem);
  }
  template <class Velocity, class Voidage>
  void update(const Velocity& velocity, const Voidage& voidage) {
    std::vector<Vector3> u;
    std::vector<double> e;
    BoundaryValues boundary;
    for (const Vector3& x : c.mesh.cell_centres) {
      u.push_back(velocity(x));
      e.push_back(voidage(x));
    }
    for (int f = c.mesh.internal_faces(); f < c.mesh.faces(); ++f)
      boundary.velocity.push_back(velocity(c.mesh.face_centres[f]));
    fields->update(u, e, boundary);
  }
  bool inside(int cell) const {
    const Vector3& x = c.mesh.cell_centres[cell];
    return (x.array() > 0.2).all() && (x.array() < Eigen::Array3d(0.8, 0.6, 1.0)).all();
  }

  FluidCase c;
  FluidProblem problem;
  std::optional<FlowFields> fields;
};

const Matrix3 slope = (Matrix3() << 1.0, 2.0, -0.5, 0.7, -1.3, 0.2, 0.0, 0.4, 0.3).finished();

TEST(FlowFields, are_exact_for_a_linear_velocity_on_an_irregular_mesh) {
  Flow flow(true);
  const auto velocity = [](const Vector3& x) { return Vector3(Vector3(0.3, -1, 2) + slope * x); };
  flow.update(velocity, [](const Vector3&) { return 0.6; });
  const Vector3 curl(0.4 - 0.2, -0.5 - 0.0, 0.7 - 2.0);
  for (int cell = 0; cell < flow.c.mesh.cells(); ++cell) {
    const Vector3 u = velocity(flow.c.mesh.cell_centres[cell]);
    // Rounding of gradients from some dozen terms.
    EXPECT_LE((flow.fields->vorticity()[cell] - curl).norm(), 1e-13);
    EXPECT_LE((flow.fields->convective_acceleration()[cell] - slope * u).norm(), 1e-12);
    if (flow.inside(cell)) {
      // 2 Pa s over 0.2 m and faces of 0.04 m² around 0.008 m³.
      EXPECT_LE(flow.fields->viscous_force()[cell].norm(), 1e-10);
    }
  }
}

TEST(FlowFields, turns_the_way_the_fluid_does) {
  Flow flow(false);  // faster upwards in y: it turns clockwise seen from +z
  flow.update([](const Vector3& x) { return Vector3(3 * x.y(), 0, 0); },
              [](const Vector3&) { return 1.0; });
  for (const Vector3& vorticity : flow.fields->vorticity())
    EXPECT_LE((vorticity - Vector3(0, 0, -3)).norm(), 1e-13);
}

TEST(FlowFields, gives_the_viscous_force_of_a_curved_profile_and_of_a_changing_voidage) {
  Flow flow(false);
  // ∇·τ = ε μ u'' = 0.5 · 2 · 6: it drags slower fluid along, towards the larger velocity around.
  flow.update([](const Vector3& x) { return Vector3(3 * x.y() * x.y(), 0, 0); },
              [](const Vector3&) { return 0.5; });
  for (int cell = 0; cell < flow.c.mesh.cells(); ++cell) {
    if (!flow.inside(cell)) continue;
    EXPECT_LE((flow.fields->viscous_force()[cell] - Vector3(6, 0, 0)).norm(), 1e-11);
  }
  // u = γ y in x, and ε along y: γ μ ε_y in x; along x: the transposed part, in y.
  for (const bool along_x : {false, true}) {
    flow.update([](const Vector3& x) { return Vector3(3 * x.y(), 0, 0); },
                [&](const Vector3& x) { return 0.5 + 0.2 * (along_x ? x.x() : x.y()); });
    const Vector3 expected = along_x ? Vector3(0, 1.2, 0) : Vector3(1.2, 0, 0);
    for (int cell = 0; cell < flow.c.mesh.cells(); ++cell) {
      if (!flow.inside(cell)) continue;
      EXPECT_LE((flow.fields->viscous_force()[cell] - expected).norm(), 1e-11);
    }
  }
}

std::set<std::string> names_at_start(const std::vector<InterphaseForce>& forces) {
  FluidCase c = column(4, 0.04, 1.0);
  c.scene.interphase.forces = forces;
  if (has_force(c.scene, InterphaseForce::turbulent_dispersion)) {
    c.scene.fluid.turbulence.model = TurbulenceModel::k_epsilon;
    c.scene.fluid.turbulence.kinetic_energy = 0.01;
    c.scene.fluid.turbulence.dissipation = 0.1;
    c.scene.fluid.turbulence.inlets["inlet"] = {0.05, 0.01};
  }
  NativeFluid fluid;
  fluid.configure(c.scene, c.mesh);
  const Solids solids(c.mesh);
  Fields in;
  in.add(field::voidage, solids.voidage);
  Fields out;
  fluid.start(in, out);
  std::set<std::string> names;
  for (const FieldView& view : out.views()) names.insert(view.name);
  return names;
}

TEST(FluidParticipant, sends_what_the_forces_ask_for_and_nothing_else) {
  const std::set<std::string> usual{field::face_flux, field::velocity, field::pressure,
                                    field::pressure_gradient};
  EXPECT_EQ(names_at_start({}), usual);
  EXPECT_EQ(names_at_start({InterphaseForce::pressure_gradient}), usual);
  const std::vector<std::pair<InterphaseForce, std::vector<std::string>>> each{
      {InterphaseForce::viscous, {field::viscous_force}},
      {InterphaseForce::added_mass, {field::convective_acceleration}},
      {InterphaseForce::saffman_lift, {field::vorticity}},
      {InterphaseForce::magnus_lift, {field::vorticity}},
      {InterphaseForce::turbulent_dispersion,
       {field::turbulent_energy, field::turbulent_dissipation}}};
  for (const auto& [force, fields] : each) {
    std::set<std::string> expected = usual;
    expected.insert(fields.begin(), fields.end());
    EXPECT_EQ(names_at_start({force}), expected);
  }
  std::set<std::string> all = usual;
  for (const std::string& name : all_asked_of_fluid()) all.insert(name);
  EXPECT_EQ(names_at_start(all_forces), all);
}

TEST(FluidParticipant, bears_the_pressure_on_what_particles_return_too) {
  // A uniform bed in steady flow: (ε V + A) ∇p = S − B u in every cell.
  FluidCase c = column(10, 0.1, 0.5);
  c.scene.interphase.forces = {InterphaseForce::pressure_gradient, InterphaseForce::added_mass};
  Solids solids(c.mesh, 0.6);
  const std::vector<double> returned(solids.drag.size(), 0.3 * c.mesh.cell_volumes[0]);
  std::ranges::fill(solids.drag, 5e-3);
  std::ranges::fill(solids.source, Vector3(1e-3, 0, 0));
  NativeFluid fluid;
  fluid.configure(c.scene, c.mesh);
  Fields in;
  in.add(field::voidage, solids.voidage);
  in.add(field::drag_coefficient, solids.drag);
  in.add(field::drag_source, solids.source);
  Fields out;
  fluid.start(in, out);
  EXPECT_THROW(fluid.advance({1, 0, 0.01}, in, out, {}), ProtocolError);  // without A
  in.add(field::pressure_return, returned);
  for (int step = 1; step <= 30; ++step) {
    Fields next;
    fluid.advance({step, (step - 1) * 0.01, 0.01}, in, next, {});
    fluid.commit();
    out = next;
  }
  const double u = 0.5 / 0.6;
  const double expected = (1e-3 - 5e-3 * u) / (0.9 * c.mesh.cell_volumes[0]);
  const auto gradient = out.vectors(field::pressure_gradient, 10);
  const auto impulse = out.vectors(field::impulse_taken, 10);
  for (int cell = 0; cell < 10; ++cell) {
    EXPECT_NEAR(gradient[cell].x() / expected, 1, 1e-10);  // the tolerance of the solver is 1e-12
    const double taken = 0.01 * (1e-3 - 5e-3 * u - returned[cell] * gradient[cell].x());
    EXPECT_NEAR(impulse[cell].x() / taken, 1, 1e-10);
  }
  std::vector<double> negative = returned;
  negative[3] = -1;
  Fields bad;
  for (const FieldView& view : in.views())
    if (view.name != field::pressure_return)
      view.components == 1 ? bad.add(view.name, view.values)
                           : bad.add(view.name, as_vectors(view.values));
  bad.add(field::pressure_return, negative);
  EXPECT_THROW(fluid.advance({31, 0.3, 0.01}, bad, out, {}), NumericsError);
}

}  // namespace
}  // namespace fluxpact
