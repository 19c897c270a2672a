// What a long run must keep: the energy of elastic contacts, the momenta of a cloud that nothing
// touches.
#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "tests/unit/dem_server/native/random_cloud.hpp"

namespace fluxpact {
namespace {

double sphere_mass_of(const ParticleState& state, int i) {
  return 4.0 / 3.0 * std::numbers::pi * std::pow(state.radius[i], 3) * state.density[i];
}

/// Mean and largest deviation of the energy over a stretch of the run, as shares of it.
struct Drift {
  double first_mean, last_mean, worst;
};

/// Energy over a million sub-steps, against its start.
template <class Energy>
Drift energy_drift(ParticleEngine& engine, double time_step, const Energy& energy) {
  constexpr int windows = 1000;
  const double start = energy(engine.particles());
  Drift drift{};
  for (int window = 0; window < windows; ++window) {
    run(engine, 1000 * time_step, time_step);
    const double apart = energy(engine.particles()) / start - 1;
    drift.worst = std::max(drift.worst, std::abs(apart));
    if (window < windows / 10) drift.first_mean += apart / (windows / 10);
    if (window >= windows - windows / 10) drift.last_mean += apart / (windows / 10);
  }
  return drift;
}

TEST(Energy, of_an_oscillating_contact_has_no_trend_in_a_million_steps) {
  // A sphere that swings on the wall and never leaves it. Velocity-Verlet keeps an energy exactly
  // that differs from the true one by (w dt)² / 4 of the potential part at most.
  constexpr double r = 1e-3;
  constexpr double g = 9.81;
  constexpr double k = 1000;
  Scene scene = box_scene({0.01, 0.01, 0.01});
  scene.scene.gravity = {0, 0, -g};
  add_pair(scene, "glass", "walls", k, 1.0, 0);
  const double mass = 4.0 / 3.0 * std::numbers::pi * r * r * r * 2250;
  const double rest = r - mass * g / k;
  const double amplitude = 0.9 * mass * g / k;
  ParticleState state;
  add_sphere(state, {5e-3, 5e-3, rest + amplitude}, Vector3::Zero(), r);
  const auto engine = make_engine(scene, state);
  const double time_step = 1.03e-5;  // no simple part of the period
  const double w_dt = std::sqrt(k / mass) * time_step;
  const Drift drift = energy_drift(*engine, time_step, [&](const ParticleState& now) {
    const double off = now.position[0].z() - rest;
    return 0.5 * mass * now.velocity[0].squaredNorm() + 0.5 * k * off * off;
  });
  fmt::print(
      "oscillator, w dt {:.3f}: energy off by {:.2e} at most; mean {:.3e} at first, {:.3e} "
      "at last\n",
      w_dt, drift.worst, drift.first_mean, drift.last_mean);
  EXPECT_LT(drift.worst, 0.25 * w_dt * w_dt * 1.01);
  EXPECT_GT(drift.worst, 0.1 * w_dt * w_dt);  // it is the scheme's own error that is seen
  // The means are of 100 samples each of what swings by w_dt² / 8 about its middle: a tenth of
  // that. A drift of 1e-9 of the energy a step would show as 1e-3.
  EXPECT_LT(std::abs(drift.last_mean - drift.first_mean), 0.1 * w_dt * w_dt / 8);
}

TEST(Energy, of_bouncing_spheres_has_no_trend_in_a_million_steps) {
  // Two elastic spheres between two walls, head on: three contacts to and fro, at all parts of a
  // step.
  constexpr double r = 1e-3;
  Scene scene = box_scene({0.01, 0.01, 0.01});
  add_laws(scene, 1000, 1.0, 0.3);
  ParticleState state;
  add_sphere(state, {2e-3, 5e-3, 5e-3}, {0.1, 0, 0}, r);
  add_sphere(state, {7e-3, 5e-3, 5e-3}, {-0.073, 0, 0}, r);
  const auto engine = make_engine(scene, state);
  const double mass = sphere_mass_of(state, 0);
  const double time_step = 1.03e-5;
  const double w_dt = std::sqrt(2000 / mass) * time_step;
  const auto potential = [](double gap) { return gap < 0 ? 500 * gap * gap : 0; };
  const Drift drift = energy_drift(*engine, time_step, [&](const ParticleState& now) {
    const double a = now.position[0].x();
    const double b = now.position[1].x();
    return 0.5 * mass * (now.velocity[0].squaredNorm() + now.velocity[1].squaredNorm()) +
           potential(a - r) + potential(b - a - 2 * r) + potential(0.01 - r - b);
  });
  fmt::print(
      "bouncing, w dt {:.3f}: energy off by {:.2e} at most; mean {:.2e} at first, {:.2e} at "
      "last\n",
      w_dt, drift.worst, drift.first_mean, drift.last_mean);
  // Each contact shifts the energy by up to (w dt)² / 8 of it, one way or the other by where in a
  // step it begins (deviation 0.6 of that). In 10 s there are about 500: three deviations of the
  // walk are 3 · 0.6 · sqrt(500) = 40 of them, where a bias of one sign would give up to 500.
  EXPECT_LT(drift.worst, 40 * w_dt * w_dt / 8);
}

/// Momentum and angular momentum about the middle of the box, and the sums of the sizes of their
/// parts.
struct Momenta {
  Vector3 linear = Vector3::Zero();
  Vector3 angular = Vector3::Zero();
  double linear_scale = 0;
  double angular_scale = 0;
};

Momenta momenta(const ParticleState& state) {
  const Vector3 middle = Vector3::Constant(5 * cloud_box);
  Momenta sum;
  for (int i = 0; i < state.size(); ++i) {
    const double mass = sphere_mass_of(state, i);
    const Vector3 orbital = mass * (state.position[i] - middle).cross(state.velocity[i]);
    const Vector3 spin = 0.4 * mass * state.radius[i] * state.radius[i] * state.spin[i];
    sum.linear += mass * state.velocity[i];
    sum.angular += orbital + spin;
    sum.linear_scale += mass * state.velocity[i].norm();
    sum.angular_scale += orbital.norm() + spin.norm();
  }
  return sum;
}

/// A ball of spheres that fly towards each other in an empty box ten times as wide.
std::unique_ptr<ParticleEngine> isolated_cloud(double mu) {
  Scene scene = box_scene(Vector3::Constant(10 * cloud_box));
  scene.particles.walls = WallSource::none;
  add_pair(scene, "glass", "glass", 1000, 0.9, mu);
  ParticleState state = random_cloud(2000, 0.5);
  for (int i = 0; i < state.size(); ++i) {
    const Vector3 from_centre = state.position[i] - Vector3::Constant(0.5 * cloud_box);
    state.velocity[i] -= 30 * from_centre;
    state.position[i] += Vector3::Constant(4.5 * cloud_box);
    state.spin[i] = {100.0 * (i % 3), -50, 70.0 * (i % 2)};
  }
  return make_engine(scene, state);
}

TEST(Momentum, of_an_isolated_cloud_is_kept_to_rounding) {
  for (const double mu : {0.0, 0.5}) {
    const auto engine = isolated_cloud(mu);
    const Momenta before = momenta(engine->particles());
    run(*engine, 5e-3, 2e-6);
    const Momenta after = momenta(engine->particles());
    const double linear = (after.linear - before.linear).norm() / before.linear_scale;
    const double angular = (after.angular - before.angular).norm() / before.angular_scale;
    const double spent = 1 - after.linear_scale / before.linear_scale;
    fmt::print(
        "isolated cloud, mu {}: momentum off by {:.1e}, angular momentum {:.1e}; mean speed "
        "less by {:.0f} %\n",
        mu, linear, angular, 100 * spent);
    EXPECT_GT(spent, 0.2);  // it did collide
    // 2500 sub-steps round each velocity a few times, at random: sqrt(2500) · 1e-16 and some.
    EXPECT_LT(linear, 1e-13);
    // Without friction the forces are central. With it the lever arms are the radii, though the
    // centres are closer by the overlap: a torque of F_t δ is left over, a share δ / 2 r = 1e-2.
    EXPECT_LT(angular, mu == 0 ? 1e-12 : 1e-2);
  }
}

}  // namespace
}  // namespace fluxpact
