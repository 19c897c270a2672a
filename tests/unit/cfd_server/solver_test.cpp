// What the solver promises to its callers: transactions, checks of its input, clear refusals,
// extremes.
#include <gtest/gtest.h>

#include <random>

#include "cfd_server/backends/native/fluid_participant.hpp"
#include "cfd_server/discretisation/stencil.hpp"
#include "proto/base/errors.hpp"
#include "proto/participant/field_names.hpp"
#include "tests/unit/cfd_server/fluid_case.hpp"
#include "tests/unit/cfd_server/perturbed_box.hpp"

namespace fluxpact {
namespace {

FluidCase small_bed() {
  FluidCase c({6, 3, 8}, {0.06, 0.03, 0.08});
  c.side("inlet", Side::z_min, superficial_inlet({0, 0, 1}));
  c.side("outlet", Side::z_max, pressure_outlet());
  c.scene.fluid.initial.superficial = Vector3(0, 0, 1);
  c.make_mesh();
  return c;
}

Solids random_bed(const Mesh& mesh, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  Solids solids(mesh);
  for (int cell = 0; cell < mesh.cells(); ++cell) {
    solids.voidage[cell] = 0.4 + 0.5 * unit(random);
    solids.drag[cell] = 3000 * unit(random) * mesh.cell_volumes[cell];
    solids.source[cell] = solids.drag[cell] * Vector3(0, 0, unit(random));
  }
  return solids;
}

template <class Action>
std::string message_of(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Transaction, a_repeated_window_gives_the_same_bits) {
  const FluidCase c = small_bed();
  VansSolver solver(c.scene, c.mesh);
  VansSolver other(c.scene, c.mesh);
  solver.start(random_bed(c.mesh, 0).voidage);
  other.start(random_bed(c.mesh, 0).voidage);
  for (unsigned step = 1; step <= 5; ++step) {
    const Window window{step, (step - 1) * 1e-3, 1e-3};
    solver.advance(window, random_bed(c.mesh, step + 100).view(),
                   {});  // a candidate that is given up
    solver.rollback();
    solver.advance(window, random_bed(c.mesh, step).view(), {});
    other.advance(window, random_bed(c.mesh, step).view(), {});
    const FluidState& a = solver.candidate();
    const FluidState& b = other.candidate();
    EXPECT_EQ(a.face_flux, b.face_flux);
    EXPECT_EQ(a.velocity, b.velocity);
    EXPECT_EQ(a.pressure, b.pressure);
    EXPECT_EQ(a.pressure_gradient, b.pressure_gradient);
    EXPECT_EQ(a.voidage, random_bed(c.mesh, step).voidage);
    solver.commit();
    other.commit();
  }
}

/// Two windows of a bed large enough for three threads.
FluidState after_two_windows(bool lattice, int threads) {
  FluidCase c({33, 32, 32}, {0.33, 0.32, 0.32});
  c.side("inlet", Side::z_min, superficial_inlet({0, 0, 1}));
  c.side("outlet", Side::z_max, pressure_outlet());
  c.scene.fluid.initial.superficial = Vector3(0, 0, 1);
  c.scene.fluid.numerics.pressure_tolerance = 1e-6;
  c.scene.fluid.numerics.threads = threads;
  c.make_mesh();
  if (!lattice) c.mesh = perturbed(c.mesh, Vector3::Constant(0.01), 0.1, 1);
  VansSolver solver(c.scene, c.mesh);
  solver.start(random_bed(c.mesh, 0).voidage);
  for (unsigned step = 1; step <= 2; ++step)
    run_window(solver, random_bed(c.mesh, step), static_cast<int>(step), 1e-4);
  return solver.committed();
}

TEST(Threads, give_the_same_bits_for_any_number) {
  ASSERT_EQ(threads_for(3, 33 * 32 * 32), 3);
  for (const bool lattice : {true, false}) {
    const FluidState one = after_two_windows(lattice, 1);
    for (const int threads : lattice ? std::vector{2, 3} : std::vector{3}) {
      const FluidState many = after_two_windows(lattice, threads);
      EXPECT_EQ(one.face_flux, many.face_flux);
      EXPECT_EQ(one.velocity, many.velocity);
      EXPECT_EQ(one.pressure, many.pressure);
      EXPECT_EQ(one.pressure_gradient, many.pressure_gradient);
    }
  }
}

TEST(Threads, are_not_started_for_a_few_cells) {
  EXPECT_EQ(threads_for(8, 8000), 1);
  EXPECT_EQ(threads_for(8, 64000), 6);
  EXPECT_EQ(threads_for(2, 1000000), 2);
  EXPECT_GE(threads_for(0, 1000000), 1);
}

TEST(Transaction, nothing_to_commit_is_an_error) {
  const FluidCase c = small_bed();
  VansSolver solver(c.scene, c.mesh);
  solver.start(Solids(c.mesh).voidage);
  EXPECT_THROW(solver.commit(), NumericsError);
  solver.advance({1, 0, 1e-3}, random_bed(c.mesh, 1).view(), {});
  solver.rollback();
  EXPECT_THROW(solver.commit(), NumericsError);
}

TEST(Input, bad_values_are_refused_with_field_cell_value_and_step) {
  const FluidCase c = small_bed();
  VansSolver solver(c.scene, c.mesh);
  solver.start(Solids(c.mesh).voidage);
  const auto refuse = [&](const auto& spoil) {
    Solids solids = random_bed(c.mesh, 1);
    spoil(solids);
    return message_of([&] { solver.advance({7, 0, 1e-3}, solids.view(), {}); });
  };
  const double nan = std::nan("");
  EXPECT_NE(refuse([&](Solids& s) { s.voidage[5] = nan; }).find("step 7: voidage is nan in cell 5"),
            std::string::npos);
  EXPECT_NE(refuse([&](Solids& s) { s.voidage[6] = 0; }).find("voidage is 0 in cell 6"),
            std::string::npos);
  EXPECT_NE(refuse([&](Solids& s) { s.voidage[7] = 1.1; }).find("voidage is 1.1 in cell 7"),
            std::string::npos);
  EXPECT_NE(refuse([&](Solids& s) { s.drag[8] = -1; }).find("drag_coefficient is -1 in cell 8"),
            std::string::npos);
  EXPECT_NE(refuse([&](Solids& s) { s.source[9].y() = nan; }).find("drag_source is nan in cell 9"),
            std::string::npos);
  EXPECT_NE(refuse([&](Solids& s) { s.drag.pop_back(); }).find("drag_coefficient has 143 values"),
            std::string::npos);
  EXPECT_NE(message_of([&] {
              solver.advance({7, 0, 0}, random_bed(c.mesh, 1).view(), {});
            }).find("0 s long"),
            std::string::npos);
  EXPECT_EQ(refuse([](Solids&) {}), "no error");
}

TEST(Transaction, a_state_from_which_no_window_could_go_on_is_refused_and_leaves_no_trace) {
  const FluidCase c = small_bed();
  VansSolver solver(c.scene, c.mesh);
  solver.start(Solids(c.mesh).voidage);
  run_window(solver, random_bed(c.mesh, 1), 1, 1e-3);
  const FluidState before = solver.committed();
  Solids thrown = random_bed(c.mesh, 2);
  // Accelerates a cell of 1e-6 m3 to some 1e9 m/s: finite, and of no use.
  thrown.source[50].x() = 1e6;
  const std::string text = message_of([&] { solver.advance({2, 1e-3, 1e-3}, thrown.view(), {}); });
  for (const char* part : {"fluid, step 2", "coupling.window", "velocity is", "m/s in cell",
                           " at (", "courant_limit 5", "from 5e+03 at most"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " in: " << text;
  EXPECT_THROW(solver.commit(), NumericsError);
  EXPECT_EQ(solver.committed().velocity, before.velocity);
  EXPECT_EQ(solver.committed().face_flux, before.face_flux);
  solver.rollback();
  run_window(solver, random_bed(c.mesh, 2), 2, 1e-3);
}

TEST(Boundaries, unfit_conditions_are_config_errors_that_name_the_patch) {
  const auto build = [](const auto& spoil) {
    FluidCase c = small_bed();
    spoil(c.scene);
    return message_of([&] { VansSolver(c.scene, c.mesh); });
  };
  EXPECT_EQ(build([](Scene&) {}), "no error");
  EXPECT_NE(build([](Scene& s) {
              s.fluid.boundaries.erase("inlet");
            }).find("patch 'inlet' has no condition"),
            std::string::npos);
  EXPECT_NE(build([](Scene& s) {
              s.fluid.boundaries["inlte"] = wall(Slip::none);
            }).find("has no such patch"),
            std::string::npos);
  EXPECT_NE(build([](Scene& s) {
              s.fluid.boundaries["inlet"].interstitial = Vector3(0, 0, 1);
            }).find("both are"),
            std::string::npos);
  EXPECT_NE(
      build([](Scene& s) { s.fluid.boundaries["inlet"].superficial.reset(); }).find("neither is"),
      std::string::npos);
  EXPECT_NE(build([](Scene& s) {
              s.fluid.boundaries["inlet"].type = BoundaryType::mass_flow;
            }).find("'rate'"),
            std::string::npos);
  EXPECT_NE(build([](Scene& s) { s.fluid.density = 0; }).find("fluid.density"), std::string::npos);
  EXPECT_NE(build([](Scene& s) {
              s.coupling.continuity = Continuity::legacy;
              s.fluid.boundaries["outlet"] = superficial_inlet({0, 0, 1});
            }).find("continuity: legacy"),
            std::string::npos);
}

TEST(Legacy, runs_on_a_rough_bed_and_does_not_balance) {
  FluidCase c = small_bed();
  c.scene.coupling.continuity = Continuity::legacy;
  VansSolver solver(c.scene, c.mesh);
  solver.start(random_bed(c.mesh, 0).voidage);
  double imbalance = 0;
  Solids solids = random_bed(c.mesh, 1);
  for (int step = 1; step <= 200; ++step) {
    run_window(solver, solids, step, 1e-3);
    imbalance =
        balance_of(c.mesh, 1.2, solids.voidage, solver.committed(), 1e-3).relative_imbalance;
  }
  EXPECT_GT(std::abs(imbalance), 1e-3);
  for (const Vector3& u : solver.committed().velocity) EXPECT_LT(u.norm(), 50);
}

TEST(Start, from_rest_a_moving_lid_alone_sets_the_fluid_going) {
  // Nothing but the lid's drag acts in the first window: no old velocity, no source, no inflow.
  FluidCase c({6, 1, 6}, {0.1, 0.01, 0.1});
  c.scene.fluid.viscosity = 1e-3;
  c.scene.fluid.mesh.periodic = {Axis::y};
  c.side("lid", Side::z_max, superficial_inlet({1, 0, 0}));
  c.make_mesh();
  for (const auto choice :
       {LinearSolverChoice::automatic, LinearSolverChoice::conjugate_gradient}) {
    c.scene.fluid.numerics.solver = choice;
    const Solids solids(c.mesh);
    VansSolver solver(c.scene, c.mesh);
    solver.start(solids.voidage);
    run_window(solver, solids, 1, 0.02);
    EXPECT_LT(solver.report().predictor_iterations, 30);
    EXPECT_GT(solver.committed().velocity.back().x(), 0);
  }
}

struct Extreme {
  const char* name;
  std::array<int, 3> cells;
  Vector3 size;
  double viscosity;
  double window;
  double drag;  // x = B Δt/(ρ ε V)
};

void PrintTo(const Extreme& extreme, std::ostream* out) { *out << extreme.name; }

class Extremes : public ::testing::TestWithParam<Extreme> {};

TEST_P(Extremes, stay_finite_and_balanced) {
  const Extreme& extreme = GetParam();
  FluidCase c(extreme.cells, extreme.size);
  c.scene.fluid.viscosity = extreme.viscosity;
  c.scene.fluid.numerics.pressure_tolerance = 1e-6;
  c.side("inlet", Side::z_min, superficial_inlet({0, 0, 1}));
  c.side("outlet", Side::z_max, pressure_outlet());
  c.scene.fluid.initial.superficial = Vector3(0, 0, 1);
  c.make_mesh();
  Solids solids = random_bed(c.mesh, 3);
  for (int cell = 0; cell < c.mesh.cells(); ++cell) {
    solids.drag[cell] =
        extreme.drag * 1.2 * solids.voidage[cell] * c.mesh.cell_volumes[cell] / extreme.window;
    solids.source[cell].setZero();
  }
  VansSolver solver(c.scene, c.mesh);
  solver.start(solids.voidage);
  for (int step = 1; step <= 30; ++step) {
    run_window(solver, solids, step, extreme.window);
    const Balance balance =
        balance_of(c.mesh, 1.2, solids.voidage, solver.committed(), extreme.window);
    EXPECT_LE(std::abs(balance.relative_imbalance), 1e-13);
    double fastest = 0;
    for (const Vector3& u : solver.committed().velocity) fastest = std::max(fastest, u.norm());
    EXPECT_LT(fastest, 100) << extreme.name << " step " << step;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Of, Extremes,
    ::testing::Values(
        Extreme{"one cell", {1, 1, 1}, {0.01, 0.01, 0.01}, 1.8e-5, 1e-3, 1},
        Extreme{"flat cells", {4, 1, 6}, {4, 1, 0.006}, 1.8e-5, 1e-4, 1},
        Extreme{"tall cells", {6, 2, 3}, {0.006, 0.002, 3}, 1.8e-5, 1e-3, 1},
        Extreme{"syrup", {6, 3, 8}, {0.06, 0.03, 0.08}, 1e3, 1e-3, 1},
        Extreme{"inviscid, Courant number 50", {6, 3, 8}, {0.06, 0.03, 0.08}, 1e-7, 0.5, 0},
        Extreme{"Courant number 0.001", {6, 3, 8}, {0.06, 0.03, 0.08}, 1.8e-5, 1e-5, 0.1},
        Extreme{"stiff drag", {6, 3, 8}, {0.06, 0.03, 0.08}, 1.8e-5, 1e-3, 1e6}));

TEST(NativeFluid, hands_on_the_impulse_that_its_velocity_implies) {
  const FluidCase c = small_bed();
  NativeFluid fluid;
  fluid.configure(c.scene, c.mesh);
  const Solids solids = random_bed(c.mesh, 2);
  Fields in;
  in.add(field::voidage, std::span<const double>(solids.voidage));
  in.add(field::drag_coefficient, std::span<const double>(solids.drag));
  in.add(field::drag_source, std::span<const Vector3>(solids.source));
  Fields first;
  fluid.start(in, first);
  for (const Vector3& u : first.vectors(field::velocity, c.mesh.cells())) EXPECT_GT(u.z(), 0);
  EXPECT_EQ(first.scalars(field::face_flux, c.mesh.faces()).size(), c.mesh.owner.size());
  Fields out;
  int beats = 0;
  fluid.advance({1, 0, 1e-3}, in, out, [&] { ++beats; });
  EXPECT_GT(beats, 0);
  const auto velocity = out.vectors(field::velocity, c.mesh.cells());
  const auto impulse = out.vectors(field::impulse_taken, c.mesh.cells());
  for (int cell = 0; cell < c.mesh.cells(); ++cell) {
    const Vector3 expected = 1e-3 * (solids.source[cell] - solids.drag[cell] * velocity[cell]);
    EXPECT_LE((impulse[cell] - expected).norm(), 1e-15 * solids.drag[cell]);
  }
  EXPECT_GT(out.number(field::solver_iterations), 0);
  EXPECT_GE(out.number(field::wall_seconds), 0);
  EXPECT_LT(out.number(field::closure_correction), 1e-6);
  fluid.commit();
}

TEST(NativeFluid, needs_a_scene_before_anything_else) {
  NativeFluid fluid;
  Fields none;
  Fields out;
  EXPECT_THROW(fluid.start(none, out), ProtocolError);
}

}  // namespace
}  // namespace fluxpact
