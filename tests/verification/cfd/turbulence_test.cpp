// The standard k-epsilon model with wall functions in a plane channel, against the log law.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>

#include "cfd_server/turbulence/turbulence.hpp"
#include "tests/unit/cfd_server/fluid_case.hpp"

namespace fluxpact {
namespace {

/// Half a channel of height 1 at Re_τ = u_τ h/ν, driven so that u_τ = 1: wall below, symmetry
/// above.
struct Channel {
  FluidCase c;
  double viscosity;

  Channel(int cells, double friction_reynolds, const char* initial)
      : c({1, 1, cells}, {0.1, 0.1, 1}), viscosity(1 / friction_reynolds) {
    c.scene.fluid.density = 1;
    c.scene.fluid.viscosity = viscosity;
    c.scene.fluid.mesh.periodic = {Axis::x, Axis::y};
    c.side("floor", Side::z_min, wall(Slip::none));
    c.side("middle", Side::z_max, wall(Slip::free));
    c.scene.fluid.initial.superficial.components[0].text = initial;
    TurbulenceSettings& turbulence = c.scene.fluid.turbulence;
    turbulence.model = TurbulenceModel::k_epsilon;
    turbulence.kinetic_energy = 2;
    turbulence.dissipation = 10;
    c.make_mesh();
  }

  std::vector<double> steady_velocity(int steps, double window) {
    VansSolver solver(c.scene, c.mesh);
    Solids solids(c.mesh);
    for (int cell = 0; cell < c.mesh.cells(); ++cell)
      solids.source[cell] = Vector3(c.mesh.cell_volumes[cell], 0, 0);  // u_τ²/h
    solver.start(solids.voidage);
    for (int step = 1; step <= steps; ++step) run_window(solver, solids, step, window);
    std::vector<double> result;
    for (const Vector3& u : solver.committed().velocity) result.push_back(u.x());
    return result;
  }
};

TEST(Channel, follows_the_log_law) {
  // From the bottom cell's centre at y+ = 25 to the middle of the half channel.
  for (const double reynolds : {1000.0, 5000.0}) {
    Channel channel(20, reynolds, "2.44 * log(z * 1000 + 1)");
    const std::vector<double> velocity = channel.steady_velocity(2000, 0.02);
    for (int cell = 0; cell < 12; ++cell) {
      const double height = channel.c.mesh.cell_centres[cell].z() / channel.viscosity;
      const double law = std::log(9.8 * height) / 0.41;
      fmt::print("Re_tau {:5.0f}: y+ {:6.1f}  U+ {:6.2f}  log law {:6.2f}\n", reynolds, height,
                 velocity[cell], law);
      // The model's own accuracy: its diffusion of k bends the profile by per cents.
      EXPECT_NEAR(velocity[cell], law, 0.05 * law) << height;
    }
  }
}

}  // namespace
}  // namespace fluxpact
