// Observed order of accuracy of the full equations in space and time, on cells of every kind.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <numeric>

#include "tests/unit/cfd_server/test_meshes.hpp"
#include "tests/verification/cfd/manufactured.hpp"

namespace fluxpact {
namespace {

struct Errors {
  double velocity = 0;
  double pressure = 0;
  double flux = 0;
};

/// The solids that go with the exact solution. In a closed domain their volume is constant;
/// sampling the voidage at the cells' centres is so to O(h²) only, and the difference is spread
/// over all.
class ManufacturedSolids {
 public:
  ManufacturedSolids(const Manufactured& exact, const Mesh& mesh)
      : exact_(exact),
        mesh_(mesh),
        total_(std::accumulate(mesh.cell_volumes.begin(), mesh.cell_volumes.end(), 0.0)),
        mean_at_start_(mean_voidage(0)) {}

  Solids at(double t) const {
    Solids solids(mesh_);
    const double shift = mean_at_start_ - mean_voidage(t);
    for (int cell = 0; cell < mesh_.cells(); ++cell) {
      const Vector3& x = mesh_.cell_centres[cell];
      const double volume = mesh_.cell_volumes[cell];
      solids.voidage[cell] = exact_.voidage(x, t) + shift;
      solids.drag[cell] = volume * exact_.drag_at(x);
      solids.source[cell] = volume * exact_.force(x, t);
    }
    return solids;
  }

 private:
  double mean_voidage(double t) const {
    double mean = 0;
    for (int cell = 0; cell < mesh_.cells(); ++cell)
      mean += mesh_.cell_volumes[cell] / total_ * exact_.voidage(mesh_.cell_centres[cell], t);
    return mean;
  }

  const Manufactured& exact_;
  const Mesh& mesh_;
  double total_;
  double mean_at_start_;
};

FluidState run(const Manufactured& exact, const Mesh& mesh, const FluidNumerics& numerics,
               int steps, double end) {
  Scene scene;
  scene.fluid.density = exact.density;
  scene.fluid.viscosity = exact.viscosity;
  scene.scene.gravity = Vector3::Zero();
  scene.fluid.numerics = numerics;
  scene.fluid.initial.superficial = exact.initial_superficial();
  scene.interphase.model = exact.model;
  const ManufacturedSolids solids(exact, mesh);
  VansSolver solver(scene, mesh);
  solver.start(solids.at(0).voidage);
  const double window = end / steps;
  for (int step = 1; step <= steps; ++step)
    run_window(solver, solids.at(step * window), step, window);
  return solver.committed();
}

/// Root-mean-square errors over cells and faces.
Errors errors_of(const Manufactured& exact, const Mesh& mesh, const FluidState& state,
                 double time) {
  double volume = 0;
  double mean = 0;
  for (int cell = 0; cell < mesh.cells(); ++cell) {
    volume += mesh.cell_volumes[cell];
    mean += mesh.cell_volumes[cell] *
            (state.pressure[cell] - exact.pressure(mesh.cell_centres[cell], time));
  }
  Errors sum;
  for (int cell = 0; cell < mesh.cells(); ++cell) {
    const Vector3& x = mesh.cell_centres[cell];
    const double pressure = exact.pressure(x, time) + mean / volume;
    sum.velocity +=
        mesh.cell_volumes[cell] * (state.velocity[cell] - exact.velocity(x, time)).squaredNorm();
    sum.pressure += mesh.cell_volumes[cell] * std::pow(state.pressure[cell] - pressure, 2);
  }
  double area = 0;
  for (int f = 0; f < mesh.faces(); ++f) {
    const Vector3& x = mesh.face_centres[f];
    const double size = mesh.face_areas[f].norm();
    const double expected = exact.density * exact.voidage(x, time) *
                            exact.velocity(x, time).dot(mesh.face_areas[f]) / size;
    sum.flux += size * std::pow(state.face_flux[f] / size - expected, 2);
    area += size;
  }
  return {std::sqrt(sum.velocity / volume), std::sqrt(sum.pressure / volume),
          std::sqrt(sum.flux / area)};
}

double order(double coarse, double fine, double ratio) {
  return std::log(coarse / fine) / std::log(ratio);
}

FluidNumerics second_order(int correctors) {
  FluidNumerics numerics;
  numerics.time = TimeScheme::bdf2;
  numerics.convection = Convection::linear_upwind;
  numerics.pressure_tolerance = 1e-8;
  numerics.correctors = correctors;
  return numerics;
}

struct SpaceCase {
  const char* name;
  Mesh (*make)(const TestBox&);
  double share;  ///< by which points are moved
  double drag;   ///< [kg/(m³ s)]
  PressureModel model;
  int correctors;
  int coarse, fine;  ///< cells an edge
  double least;      ///< order of u and p
};

class Space : public ::testing::TestWithParam<SpaceCase> {};

/// Space and time refined together: Δt = h/5.
TEST_P(Space, and_time_have_the_order_of_the_schemes) {
  const SpaceCase& p = GetParam();
  Manufactured exact;
  exact.drag = p.drag;
  exact.model = p.model;
  constexpr double end = 0.25;
  Errors errors[2];
  int level = 0;
  for (const int n : {p.coarse, p.fine}) {
    const Mesh mesh = p.make({{n, n, n}, {0, 0, 0}, {1, 1, 1}, {true, true, true}, p.share, 1});
    const int steps = static_cast<int>(std::ceil(5 * n * end));
    errors[level++] =
        errors_of(exact, mesh, run(exact, mesh, second_order(p.correctors), steps, end), end);
  }
  const double ratio = static_cast<double>(p.fine) / p.coarse;
  const double of_velocity = order(errors[0].velocity, errors[1].velocity, ratio);
  const double of_pressure = order(errors[0].pressure, errors[1].pressure, ratio);
  fmt::print(
      "{}, {} and {} cells an edge: u {:.2e} {:.2e} order {:.2f}, p {:.2e} {:.2e} order "
      "{:.2f}, flux {:.2e} {:.2e} order {:.2f}\n",
      p.name, p.coarse, p.fine, errors[0].velocity, errors[1].velocity, of_velocity,
      errors[0].pressure, errors[1].pressure, of_pressure, errors[0].flux, errors[1].flux,
      order(errors[0].flux, errors[1].flux, ratio));
  EXPECT_GE(of_velocity, p.least);
  EXPECT_GE(of_pressure, p.least);
}

std::string name_of_case(const ::testing::TestParamInfo<SpaceCase>& tested) {
  return tested.param.name;
}

constexpr auto a = PressureModel::a;
constexpr auto b = PressureModel::b;

INSTANTIATE_TEST_SUITE_P(
    Of, Space,
    ::testing::Values(SpaceCase{"hexahedra", hexahedra, 0, 0, a, 2, 8, 16, 1.9},
                      SpaceCase{"hexahedra_with_drag", hexahedra, 0, 50, a, 2, 8, 16, 1.9},
                      SpaceCase{"hexahedra_model_b", hexahedra, 0, 50, b, 2, 8, 16, 1.9},
                      SpaceCase{"moved_hexahedra", hexahedra, 0.15, 0, a, 2, 8, 16, 1.9}),
    name_of_case);

// Few cells an edge: these are still on the way to their final order.
INSTANTIATE_TEST_SUITE_P(
    Long, Space,
    ::testing::Values(SpaceCase{"tetrahedra", tetrahedra, 0, 0, a, 3, 8, 16, 1.7},
                      SpaceCase{"tetrahedra_with_drag", tetrahedra, 0, 50, a, 3, 8, 16, 1.7},
                      SpaceCase{"moved_tetrahedra", tetrahedra, 0.15, 0, a, 3, 8, 16, 1.7},
                      SpaceCase{"prisms", prisms, 0, 0, a, 3, 8, 16, 1.7},
                      SpaceCase{"polyhedra", polyhedra, 0, 0, a, 2, 12, 20, 1.7}),
    name_of_case);

/// On one mesh, against the same mesh at steps halved twice: the error in space drops out.
double order_in_time(TimeScheme scheme) {
  Manufactured exact;
  const Mesh mesh = hexahedra({{8, 8, 8}, {0, 0, 0}, {1, 1, 1}, {true, true, true}, 0, 1});
  FluidNumerics numerics = second_order(2);
  numerics.time = scheme;
  numerics.pressure_tolerance = 1e-10;
  std::vector<FluidState> states;
  for (const int steps : {20, 40, 80}) states.push_back(run(exact, mesh, numerics, steps, 0.5));
  const auto difference = [&](const FluidState& one, const FluidState& other) {
    double sum = 0;
    for (std::size_t cell = 0; cell < one.velocity.size(); ++cell)
      sum += (one.velocity[cell] - other.velocity[cell]).squaredNorm();
    return std::sqrt(sum / static_cast<double>(one.velocity.size()));
  };
  const double coarse = difference(states[0], states[1]);
  const double fine = difference(states[1], states[2]);
  fmt::print("{}: u changes by {:.2e}, {:.2e} as the step is halved, order {:.2f}\n",
             scheme == TimeScheme::bdf2 ? "BDF2" : "Euler", coarse, fine, order(coarse, fine, 2));
  return order(coarse, fine, 2);
}

TEST(Time, has_the_order_of_its_scheme) {
  EXPECT_GE(order_in_time(TimeScheme::euler), 0.9);
  EXPECT_GE(order_in_time(TimeScheme::bdf2), 1.9);
}

}  // namespace
}  // namespace fluxpact
