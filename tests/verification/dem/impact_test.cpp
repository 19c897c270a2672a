// Low-speed impacts with friction on a wall and on an equal sphere, beside closed forms and beside
// what LAMMPS (29 Sep 2021, gran/hooke/history, the same law) gives at the same sub-step; a sphere
// that slips on a wall until it rolls.
#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "tests/unit/dem_server/native/spheres_in_a_box.hpp"

namespace fluxpact {
namespace {

constexpr double r = 1e-3;
constexpr double approach = 5e-3;  // m/s
constexpr double time_step = 1e-6;

Scene impact_scene() {
  Scene scene = box_scene({0.02, 0.02, 0.02});
  add_laws(scene, 1000, 0.9, 0.3);
  return scene;
}

/// Normal and tangential velocity [mm/s] and spin [rad/s] of the first sphere after the impact.
struct Impact {
  double normal, tangential, spin;
};

Impact hit_wall(double tangential) {
  ParticleState state;
  add_sphere(state, {0.01, 0.01, r + 1e-9}, {tangential, 0, -approach}, r);
  const auto engine = make_engine(impact_scene(), state);
  run(*engine, 1e-3, time_step);
  const ParticleState& after = engine->particles();
  return {1e3 * after.velocity[0].z(), 1e3 * after.velocity[0].x(), after.spin[0].y()};
}

Impact hit_sphere(double tangential) {
  ParticleState state;
  add_sphere(state, {0.01, 0.01, 0.01}, {approach, tangential, 0}, r);
  add_sphere(state, {0.01 + 2 * r + 1e-9, 0.01, 0.01}, Vector3::Zero(), r);
  const auto engine = make_engine(impact_scene(), state);
  run(*engine, 1e-3, time_step);
  const ParticleState& after = engine->particles();
  return {1e3 * after.velocity[0].x(), 1e3 * after.velocity[0].y(), after.spin[0].z()};
}

void print_row(const std::string& what, double speed, const Impact& ours, const Impact& exact,
               const Impact& lammps) {
  fmt::print(
      "{:<6} {:>4.1f} | {:>8.5f} {:>8.5f} {:>8.4f} | {:>8.5f} {:>8.5f} {:>8.4f} | {:>8.5f} "
      "{:>8.5f} {:>8.4f}\n",
      what, speed, ours.normal, ours.tangential, ours.spin, exact.normal, exact.tangential,
      exact.spin, lammps.normal, lammps.tangential, lammps.spin);
}

// The moment of touching is known to a sub-step only, which changes the impulse of the dashpot by
// up to γ dt / 2 = 3.5e-4 (wall), 4.9e-4 (pair) of itself; the dashpot's lag as much again.
constexpr double touching = 1e-3;

/// `turned` [rad]: what the line of centres turns by while they touch; it carries that share of the
/// tangential velocity (`speed` [mm/s]) into the normal one.
void expect_impact(const Impact& ours, const Impact& other, double speed, double turned) {
  EXPECT_NEAR(ours.normal, other.normal, touching * 5 + turned * speed) << speed;
  EXPECT_NEAR(ours.tangential, other.tangential, (touching + turned) * speed) << speed;
  EXPECT_NEAR(ours.spin, other.spin, 2.5 * (touching + turned) * speed) << speed;
}

struct Row {
  double speed;  // [mm/s] tangential, before
  Impact exact, lammps;
};

// The closed forms stick or slip throughout. At 5 mm/s the contact slips for a moment at its end.
TEST(Impact, on_a_wall_is_that_of_the_closed_form_and_of_lammps) {
  const Row rows[] = {
      {0.5, {4.5, 0.23832, 0.6542}, {4.49717, 0.23834, 0.6542}},
      {5, {4.5, 2.3832, 6.5421}, {4.49717, 2.3842, 6.5395}},
      {15, {4.5, 12.15, 7.125}, {4.49717, 12.1440, 7.1400}},
  };
  fmt::print("mm/s, rad/s | normal, tangential, spin: ours | closed form | LAMMPS\n");
  for (const Row& row : rows) {
    const Impact ours = hit_wall(1e-3 * row.speed);
    print_row("wall", row.speed, ours, row.exact, row.lammps);
    expect_impact(ours, row.exact, row.speed, 0);
    expect_impact(ours, row.lammps, row.speed, 0);
  }
}

TEST(Impact, of_two_spheres_is_that_of_the_closed_form_and_of_lammps) {
  const Row rows[] = {
      {0.5, {0.25, 0.36916, -0.3271}, {0.24842, 0.36907, -0.3276}},
      {5, {0.25, 3.6916, -3.2711}, {0.24842, 3.6922, -3.2722}},
      {15, {0.25, 13.5750, -3.5625}, {0.24842, 13.5784, -3.5628}},
  };
  for (const Row& row : rows) {
    const Impact ours = hit_sphere(1e-3 * row.speed);
    print_row("pair", row.speed, ours, row.exact, row.lammps);
    const double turned = 1e-3 * row.speed * 2.16e-4 / (2 * r);
    expect_impact(ours, row.exact, row.speed, turned);
    expect_impact(ours, row.lammps, row.speed, turned);
  }
}

TEST(Slip, follows_the_closed_form_until_it_rolls) {
  constexpr double g = 9.81;
  constexpr double small = 0.5e-3;
  constexpr double u0 = 0.1;
  constexpr double k = 1e4;
  const double mass = 4.0 / 3.0 * std::numbers::pi * small * small * small * 1e4;
  fmt::print("  mu | slip ends, mu g t / u0 (0.285714) | u / u0, r w / u0 (0.714286)\n");
  for (const double mu : {0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0}) {
    Scene scene = box_scene({0.01, 0.01, 0.01});
    scene.scene.gravity = {0, 0, -g};
    scene.particles.materials["glass"].density = 1e4;
    add_pair(scene, "glass", "walls", k, 1.0, mu);
    scene.particles.contact.pairs.back().tangential_stiffness = k;
    ParticleState state;
    add_sphere(state, {1e-3, 5e-3, small - mass * g / k}, {u0, 0, 0}, small, 1e4);
    const auto engine = make_engine(scene, state);
    const double end = 2 * u0 / (7 * mu * g);
    double slip_end = 0;
    double worst = 0;
    double speed = 0;
    double surface = 0;
    for (int window = 1; window <= 2000; ++window) {
      run(*engine, 1e-5, 1e-6);
      const double time = 1e-5 * window;
      const double u = engine->particles().velocity[0].x();
      const double rw = small * engine->particles().spin[0].y();
      if (slip_end == 0 && u <= rw) slip_end = time;
      if (time < 0.98 * end) {
        worst =
            std::max({worst, std::abs(u - u0 + mu * g * time), std::abs(rw - 2.5 * mu * g * time)});
      }
      // The undamped tangential spring goes on swinging by μ g / w_t = 1e-4 m/s: mean of the end.
      if (window > 1600) {
        speed += u / 400;
        surface += rw / 400;
      }
    }
    fmt::print("{:>4.1f} | {:.6f} | {:.6f} {:.6f}; worst while slipping {:.1e} m/s\n", mu,
               mu * g * slip_end / u0, speed / u0, surface / u0, worst);
    // Until the spring reaches its limit the friction grows from 0: a time of u / w_t² μ g, less
    // than one sub-step here, and a delay of μ g dt in both.
    EXPECT_LT(worst, 2.5 * 2 * mu * g * 1e-6) << mu;
    EXPECT_NEAR(mu * g * slip_end / u0, 2.0 / 7, 1e-2 * 2 / 7) << mu;
    EXPECT_NEAR(speed / u0, 5.0 / 7, 1e-3) << mu;
    EXPECT_NEAR(surface / u0, 5.0 / 7, 1e-3) << mu;
  }
}

}  // namespace
}  // namespace fluxpact
