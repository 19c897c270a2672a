// The turbulence models piece by piece: closed forms, positivity, and no trace where they are off.
#include "cfd_server/turbulence/turbulence.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "cfd_server/scalars/fluid_scalars.hpp"
#include "cfd_server/turbulence/eddy_viscosity.hpp"
#include "proto/base/errors.hpp"
#include "tests/unit/cfd_server/rough_flow.hpp"

namespace fluxpact {
namespace {

TEST(StrainRate, is_the_rate_of_a_simple_shear_and_none_of_a_rotation) {
  Matrix3 shear = Matrix3::Zero();
  shear(0, 2) = 7;
  EXPECT_NEAR(strain_rate(shear), 7, 1e-14);
  Matrix3 rotation = Matrix3::Zero();
  rotation(0, 1) = 3;
  rotation(1, 0) = -3;
  EXPECT_EQ(strain_rate(rotation), 0);
}

/// u = (γ z, 0, 0) between two walls, the upper one moving with it.
struct ShearFlow {
  FluidCase box{{3, 3, 6}, {0.03, 0.03, 0.06}};
  Stencil stencil;
  BoundaryConditions conditions;
  BoundaryValues boundary;
  std::vector<Vector3> velocity;
  static constexpr double rate = 50;

  ShearFlow() {
    box.scene.fluid.mesh.periodic = {Axis::x, Axis::y};
    BoundarySettings lid = wall(Slip::none);
    lid.velocity = Vector3(rate * 0.06, 0, 0);
    box.side("floor", Side::z_min, wall(Slip::none));
    box.side("lid", Side::z_max, lid);
    box.make_mesh();
    stencil = make_stencil(box.mesh);
    conditions = read_boundaries(box.scene, box.mesh, stencil);
    const Solids solids(box.mesh);
    update_boundary_values(stencil, conditions, solids.voidage, 0, boundary);
    for (const Vector3& centre : stencil.centre) velocity.emplace_back(rate * centre.z(), 0, 0);
  }
};

TEST(Smagorinsky, is_exact_in_a_linear_shear) {
  ShearFlow flow;
  flow.box.scene.fluid.turbulence.model = TurbulenceModel::smagorinsky;
  flow.box.scene.fluid.turbulence.smagorinsky_constant = 0.1;
  Turbulence turbulence(flow.box.scene, flow.box.mesh, flow.stencil, flow.conditions);
  turbulence.start();
  const ViscosityFields viscosity = turbulence.prepare(flow.velocity, flow.boundary);
  // ρ (C_s Δ)² γ with Δ = 10 mm, and the fluid's own.
  const double expected = 1.2 * 0.1 * 0.1 * 0.01 * 0.01 * ShearFlow::rate + 1.8e-5;
  for (const double value : viscosity.of_cells) EXPECT_NEAR(value, expected, 1e-12 * expected);
  EXPECT_TRUE(viscosity.of_boundary.empty());
}

TEST(WallFunction, meets_the_viscous_layer_and_is_in_equilibrium) {
  const KEpsilonConstants c;
  const double layer = viscous_layer(c);
  EXPECT_NEAR(layer, std::log(c.roughness * layer) / c.kappa, 1e-13);
  EXPECT_NEAR(layer, 11.53, 0.01);
  // A cell at y* = 100 with k = u*²/√C_μ, moving at the log law's speed: τ_w = ρ u*², G = ρ ε.
  const double density = 1.2, friction = 0.5, viscosity = 1.8e-5;
  const double distance = 100 * viscosity / (density * friction);
  const double energy = friction * friction / std::sqrt(c.c_mu);
  const double speed = friction * std::log(c.roughness * 100) / c.kappa;
  const WallState state = at_wall(c, layer, density, viscosity, distance, energy, speed);
  EXPECT_NEAR(state.viscosity * speed / distance, density * friction * friction, 1e-12);
  EXPECT_NEAR(state.production, density * state.dissipation, 1e-11 * state.production);
  // At the edge of the layer the wall's viscosity is the fluid's own, from both sides.
  const double edge = layer * viscosity / (density * friction);
  const double just_above =
      at_wall(c, layer, density, viscosity, 1.000001 * edge, energy, 1).viscosity;
  EXPECT_NEAR(just_above, viscosity, 1e-6 * viscosity);
  const WallState below = at_wall(c, layer, density, viscosity, 0.5 * edge, energy, 1);
  EXPECT_EQ(below.viscosity, viscosity);
  EXPECT_EQ(below.production, 0);
}

/// Still fluid in a box without walls that hold it: k and ε decay.
double energy_after(double time, int steps) {
  FluidCase box({2, 2, 2}, {0.1, 0.1, 0.1});
  box.scene.fluid.mesh.periodic = {Axis::x, Axis::y, Axis::z};
  TurbulenceSettings& turbulence = box.scene.fluid.turbulence;
  turbulence.model = TurbulenceModel::k_epsilon;
  turbulence.kinetic_energy = 2;
  turbulence.dissipation = 5;
  box.make_mesh();
  VansSolver solver(box.scene, box.mesh);
  const Solids solids(box.mesh);
  solver.start(solids.voidage);
  for (int step = 1; step <= steps; ++step) run_window(solver, solids, step, time / steps);
  return solver.turbulence()->committed().energy[3];
}

TEST(KEpsilon, decays_like_homogeneous_turbulence) {
  // dk/dt = −ε, dε/dt = −C_2 ε²/k: k = k_0 (1 + (C_2 − 1) t ε_0/k_0)^(−1/(C_2 − 1)).
  const double time = 1.0;
  const double exact = 2 * std::pow(1 + 0.92 * time * 5 / 2, -1 / 0.92);
  const double coarse = std::abs(energy_after(time, 1000) - exact);
  const double fine = std::abs(energy_after(time, 2000) - exact);
  EXPECT_LT(fine, 0.01 * exact);
  EXPECT_NEAR(std::log2(coarse / fine), 1, 0.1);  // Euler
}

TEST(KEpsilon, stays_positive_in_a_rough_flow_for_any_window) {
  for (const double window : {1e-4, 1e-2, 1.0}) {
    RoughFlow flow(3);
    flow.window = window;
    Scene scene = flow.fluid.scene;
    scene.fluid.turbulence.model = TurbulenceModel::k_epsilon;
    scene.fluid.turbulence.kinetic_energy = 0.1;
    scene.fluid.turbulence.dissipation = 10;
    scene.fluid.turbulence.inlets["inlet"] = {0.1, 1e-3};
    const BoundaryConditions conditions = read_boundaries(scene, flow.fluid.mesh, flow.stencil);
    Turbulence turbulence(scene, flow.fluid.mesh, flow.stencil, conditions);
    turbulence.start();
    BoundaryValues boundary;
    std::vector<Vector3> velocity(static_cast<std::size_t>(flow.stencil.cells));
    for (int step = 0; step < 20; ++step) {
      flow.renew(1);
      update_boundary_values(flow.stencil, conditions, flow.voidage, 0, boundary);
      for (Vector3& u : velocity)
        u = Vector3(flow.uniform(-1, 1), flow.uniform(-1, 1), flow.uniform(-1, 1));
      turbulence.open_window();
      turbulence.prepare(velocity, boundary);
      turbulence.advance(flow.step(), velocity, boundary);
      turbulence.commit();
      for (const double k : turbulence.committed().energy) ASSERT_GT(k, 0) << window;
      for (const double e : turbulence.committed().dissipation) ASSERT_GT(e, 0) << window;
    }
  }
}

TEST(Off, neither_scalars_nor_turbulence_exist) {
  const FluidCase c = column(4, 0.04, 1);
  const VansSolver solver(c.scene, c.mesh);
  EXPECT_EQ(solver.scalars(), nullptr);
  EXPECT_EQ(solver.turbulence(), nullptr);
}

TEST(Transaction, of_scalars_and_turbulence_forgets_what_is_rolled_back) {
  FluidCase c = column(12, 0.12, 1);
  c.scene.fluid.turbulence.model = TurbulenceModel::k_epsilon;
  c.scene.fluid.turbulence.kinetic_energy = 0.1;
  c.scene.fluid.turbulence.dissipation = 10;
  c.scene.fluid.turbulence.inlets["inlet"] = {0.1, 1e-3};
  ScalarSettings& tracer = c.scene.fluid.scalars["tracer"];
  tracer.boundaries["inlet"].value = Formula(1);
  VansSolver solver(c.scene, c.mesh);
  VansSolver other(c.scene, c.mesh);
  Solids solids(c.mesh);
  solver.start(solids.voidage);
  other.start(solids.voidage);
  for (int step = 1; step <= 5; ++step) {
    Solids wrong(c.mesh, 0.7);
    solver.advance({step, (step - 1) * 1e-3, 1e-3}, wrong.view(), {});
    solver.rollback();
    run_window(solver, solids, step, 1e-3);
    run_window(other, solids, step, 1e-3);
    EXPECT_EQ(solver.scalars()->committed(0).value, other.scalars()->committed(0).value);
    EXPECT_EQ(solver.scalars()->committed(0).boundary_flux,
              other.scalars()->committed(0).boundary_flux);
    EXPECT_EQ(solver.turbulence()->committed().energy, other.turbulence()->committed().energy);
  }
  EXPECT_GT(solver.scalars()->committed(0).value.front(), 0.1);
}

}  // namespace
}  // namespace fluxpact
