// The stability envelope of the fluid: finite and mass-exact in every window, or a refusal that
// names the limit.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include "proto/base/errors.hpp"
#include "tests/unit/cfd_server/fluid_case.hpp"
#include "tests/unit/cfd_server/test_meshes.hpp"

namespace fluxpact {
namespace {

/// Flow upwards through a box with a bed of sharp edges in its lower half, from which clusters
/// rise.
struct Extreme {
  const char* name;
  double density = 1.2;
  double viscosity = 1.8e-5;
  double superficial = 1;
  double window = 1e-3;
  double drag_number = 1;  ///< x = B Δt/(ρ ε V) in the bed
  double bed = 0.4;        ///< ε
  double front = 0.3;      ///< cells that the bed's edge moves in a window
  double tolerance = 1e-6;
  double courant_limit = 5;
  Vector3 size{0.06, 0.03, 0.08};
  std::array<int, 3> cells{6, 3, 8};
  double gravity = -9.81;
  bool may_be_refused = false;  ///< on tetrahedra
};

void PrintTo(const Extreme& extreme, std::ostream* out) { *out << extreme.name; }

struct Discretisation {
  const char* name;
  Mesh (*make)(const TestBox&);
  double share;
  TimeScheme time;
  PressureModel model;
};

void PrintTo(const Discretisation& discretisation, std::ostream* out) {
  *out << discretisation.name;
}

class Extremes : public ::testing::TestWithParam<std::tuple<Extreme, Discretisation>> {};

Solids moving_bed(const Extreme& extreme, const Mesh& mesh, int step) {
  Solids solids(mesh);
  const double layer = extreme.size.z() / extreme.cells[2];
  // The edge goes up and down by two layers, so that the bed has cells of its own at all times.
  const double phase = std::fmod(extreme.front * step, 4.0);
  const double edge = (extreme.cells[2] / 2.0 - 1 + (phase < 2 ? phase : 4 - phase)) * layer;
  for (int cell = 0; cell < mesh.cells(); ++cell) {
    const double z = mesh.cell_centres[cell].z();
    const double inside = std::clamp((edge - z) / layer + 0.5, 0.0, 1.0);
    solids.voidage[cell] = 1 - (1 - extreme.bed) * inside;
    solids.drag[cell] = inside * extreme.drag_number * extreme.density * solids.voidage[cell] *
                        mesh.cell_volumes[cell] / extreme.window;
  }
  return solids;
}

Scene scene_of(const Extreme& extreme, const Discretisation& how) {
  Scene scene;
  scene.scene.gravity = Vector3(0, 0, extreme.gravity);
  scene.fluid.density = extreme.density;
  scene.fluid.viscosity = extreme.viscosity;
  scene.fluid.initial.superficial = Vector3(0, 0, extreme.superficial);
  scene.fluid.numerics.pressure_tolerance = extreme.tolerance;
  scene.fluid.numerics.courant_limit = extreme.courant_limit;
  scene.fluid.numerics.time = how.time;
  scene.fluid.numerics.correctors = 3;
  scene.interphase.model = how.model;
  scene.fluid.boundaries["z_min"] = superficial_inlet({0, 0, extreme.superficial});
  scene.fluid.boundaries["z_max"] = pressure_outlet();
  for (const char* side : {"x_min", "x_max"}) scene.fluid.boundaries[side] = wall(Slip::none);
  for (const char* side : {"y_min", "y_max"}) scene.fluid.boundaries[side] = wall(Slip::free);
  return scene;
}

TEST_P(Extremes, are_finite_and_mass_exact_or_refused_by_name) {
  const auto& [extreme, how] = GetParam();
  // Moved points would make faces of cells with an aspect ratio of 1000 all but parallel to the
  // lines between their centres.
  const bool stretched = extreme.size.z() > 1 || extreme.size.x() > 1;
  const Mesh mesh =
      how.make({extreme.cells, {0, 0, 0}, extreme.size, {}, stretched ? 0.0 : how.share, 1});
  const Scene scene = scene_of(extreme, how);
  VansSolver solver(scene, mesh);
  std::vector<double> before = moving_bed(extreme, mesh, 0).voidage;
  solver.start(before);
  double fastest = 0;
  try {
    for (int step = 1; step <= 20; ++step) {
      const Solids solids = moving_bed(extreme, mesh, step);
      run_window(solver, solids, step, extreme.window);
      const Balance balance =
          balance_of(mesh, extreme.density, before, solver.committed(), extreme.window);
      // Each flux is rounded once, to some 1e-16 of itself; a cell has up to six.
      double largest = 0;
      for (const double flux : window_flux(solver.committed()))
        largest = std::max(largest, std::abs(flux));
      const double smallest = *std::ranges::min_element(mesh.cell_volumes);
      const double courant = 1 + largest * extreme.window / (extreme.density * smallest);
      EXPECT_LE(balance.largest_residual, 2e-15 * courant) << "window " << step;
      EXPECT_LE(std::abs(balance.relative_imbalance), 1e-12) << "window " << step;
      for (const Vector3& u : solver.committed().velocity) fastest = std::max(fastest, u.norm());
      before = solids.voidage;
    }
    fmt::print("{}, {}: fastest {:.3g} m/s\n", extreme.name, how.name, fastest);
    // Finite is not enough: what enters and what the moving bed displaces passes through its voids,
    // and round its edges and along walls a few times as fast.
    const double displaced = extreme.front * extreme.size.z() / extreme.cells[2] / extreme.window;
    EXPECT_LT(fastest, 4 * (extreme.superficial + displaced) / extreme.bed);
  } catch (const NumericsError& error) {
    const std::string text = error.what();
    fmt::print("{}, {}: refused: {}\n", extreme.name, how.name, text);
    EXPECT_NE(text.find("step"), std::string::npos) << text;
    EXPECT_NE(text.find("coupling.window"), std::string::npos) << text;
    // What is committed can be gone on from: the window that diverged is the one that is refused.
    EXPECT_EQ(text.find("it would need more than"), std::string::npos) << text;
    // Hexahedra bear all of it; cells with few faces have limits of their own.
    EXPECT_TRUE(how.make == tetrahedra && extreme.may_be_refused) << text;
  }
}

const auto extremes = ::testing::Values(
    Extreme{.name = "no drag", .drag_number = 0}, Extreme{.name = "x 1e-3", .drag_number = 1e-3},
    Extreme{.name = "x 100", .drag_number = 100},
    Extreme{.name = "x 1e3, bed at rest", .drag_number = 1e3, .front = 0},
    Extreme{.name = "x 1e4", .drag_number = 1e4, .may_be_refused = true},
    Extreme{.name = "x 1e6", .drag_number = 1e6, .may_be_refused = true},
    Extreme{.name = "x 1e6, bed at rest", .drag_number = 1e6, .front = 0, .may_be_refused = true},
    Extreme{.name = "x 1e4, front of two cells",
            .drag_number = 1e4,
            .front = 2,
            .may_be_refused = true},
    Extreme{.name = "density 1e-2", .density = 1e-2},
    Extreme{.name = "density 1e3", .density = 1e3},
    Extreme{.name = "viscosity 1e-7", .viscosity = 1e-7},
    Extreme{.name = "viscosity 1e3", .viscosity = 1e3, .may_be_refused = true},
    Extreme{.name = "voidage 0.2", .bed = 0.2},
    Extreme{.name = "Courant number 0.01", .window = 1e-5, .front = 0.003},
    Extreme{.name = "Courant number 50, inner steps", .superficial = 20, .window = 0.01},
    Extreme{.name = "Courant number 50, one step",
            .superficial = 20,
            .window = 0.01,
            .courant_limit = 200,
            .may_be_refused = true},
    Extreme{.name = "no flow", .superficial = 0}, Extreme{.name = "no gravity", .gravity = 0},
    Extreme{.name = "tolerance 0.1", .tolerance = 0.1},
    Extreme{.name = "tall cells", .size = {0.006, 0.003, 8}, .may_be_refused = true},
    Extreme{.name = "flat cells", .size = {6, 3, 0.008}, .may_be_refused = true});

class BedAtOutlet : public ::testing::TestWithParam<double> {};

TEST_P(BedAtOutlet, is_borne_by_tetrahedra) {
  const Extreme extreme{.name = "bed at the outlet", .drag_number = GetParam()};
  const Mesh mesh = tetrahedra({extreme.cells, {0, 0, 0}, extreme.size, {}, 0.15, 1});
  VansSolver solver(scene_of(extreme, {"", tetrahedra, 0.15, TimeScheme::euler, PressureModel::a}),
                    mesh);
  Solids solids(mesh, extreme.bed);
  for (int cell = 0; cell < mesh.cells(); ++cell) {
    solids.drag[cell] = extreme.drag_number * extreme.density * extreme.bed *
                        mesh.cell_volumes[cell] / extreme.window;
  }
  solver.start(solids.voidage);
  for (int step = 1; step <= 60; ++step) run_window(solver, solids, step, extreme.window);
  double fastest = 0;
  for (const Vector3& u : solver.committed().velocity) fastest = std::max(fastest, u.norm());
  // Uniform flow but for layers at the walls without slip, which can only add a part of it.
  EXPECT_LT(fastest, 2 * extreme.superficial / extreme.bed);
}

INSTANTIATE_TEST_SUITE_P(Drag, BedAtOutlet, ::testing::Values(0.5, 5.0));

INSTANTIATE_TEST_SUITE_P(
    Of, Extremes,
    ::testing::Combine(extremes,
                       ::testing::Values(Discretisation{"hexahedra", hexahedra, 0,
                                                        TimeScheme::euler, PressureModel::a},
                                         Discretisation{"hexahedra, BDF2", hexahedra, 0,
                                                        TimeScheme::bdf2, PressureModel::a},
                                         Discretisation{"moved hexahedra, model B", hexahedra, 0.15,
                                                        TimeScheme::euler, PressureModel::b},
                                         Discretisation{"tetrahedra", tetrahedra, 0,
                                                        TimeScheme::euler, PressureModel::a})));

}  // namespace
}  // namespace fluxpact
