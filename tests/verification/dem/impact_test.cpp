// Low-speed impacts with friction on a wall and on an equal sphere, beside closed forms and beside
// what LAMMPS (29 Sep 2021, gran/hooke/history, the same law) gives at the same sub-step; a sphere
// that slips on a wall until it rolls.
#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "tests/unit/dem_server/native/oblique_impact.hpp"

namespace fluxpact {
namespace {

using oblique::hit_sphere;
using oblique::hit_wall;
using oblique::Impact;
using oblique::r;
using oblique::tolerance;

void print_row(const std::string& what, double speed, const Impact& ours, const Impact& exact,
               const Impact& lammps) {
  fmt::print(
      "{:<6} {:>4.1f} | {:>8.5f} {:>8.5f} {:>8.4f} | {:>8.5f} {:>8.5f} {:>8.4f} | {:>8.5f} "
      "{:>8.5f} {:>8.4f}\n",
      what, speed, ours.normal, ours.tangential, ours.spin, exact.normal, exact.tangential,
      exact.spin, lammps.normal, lammps.tangential, lammps.spin);
}

/// `turned` [rad]: what the line of centres turns by while they touch; it carries that share of the
/// tangential velocity (`speed` [mm/s]) into the normal one.
void expect_impact(const Impact& ours, const Impact& other, double speed, double turned) {
  EXPECT_NEAR(ours.normal, other.normal, tolerance * 5 + turned * speed) << speed;
  EXPECT_NEAR(ours.tangential, other.tangential, (tolerance + turned) * speed) << speed;
  EXPECT_NEAR(ours.spin, other.spin, 2.5 * (tolerance + turned) * speed) << speed;
}

struct Row {
  double speed;  // [mm/s] tangential, before
  Impact exact, lammps;
};

// The closed forms stick or slip throughout. At 5 mm/s the contact slips for a moment at its end.
TEST(Impact, on_a_wall_is_that_of_the_closed_form_and_of_lammps) {
  const Row rows[] = {
      {0.5, oblique::wall_sticks, {4.49717, 0.23834, 0.6542}},
      {5, {4.5, 2.3832, 6.5421}, {4.49717, 2.3842, 6.5395}},
      {15, oblique::wall_slips(15e-3), {4.49717, 12.1440, 7.1400}},
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
      {0.5, oblique::pair_sticks, {0.24842, 0.36907, -0.3276}},
      {5, {0.25, 3.6916, -3.2711}, {0.24842, 3.6922, -3.2722}},
      {15, oblique::pair_slips(15e-3), {0.24842, 13.5784, -3.5628}},
  };
  for (const Row& row : rows) {
    const Impact ours = hit_sphere(1e-3 * row.speed);
    print_row("pair", row.speed, ours, row.exact, row.lammps);
    const double turned = 1e-3 * row.speed * 2.16e-4 / (2 * r);
    expect_impact(ours, row.exact, row.speed, turned);
    expect_impact(ours, row.lammps, row.speed, turned);
  }
}

/// The same law on a wall, on its own: the normal motion is the closed form of a damped oscillator,
/// the tangential one is taken in steps so short (1e-9 s) that their error, some 1e-6, is of no
/// account. At its end a contact that stuck slips, where the normal force passes zero.
Impact law_on_a_wall(double tangential) {
  constexpr double step = 1e-9;  // [s]
  constexpr double e = 0.9;
  constexpr double mu = 0.3;
  const double mass = 4.0 / 3.0 * std::numbers::pi * r * r * r * 2250;
  const double w0 = std::sqrt(1000 / mass);
  const double rate = w0 * -std::log(e) / std::hypot(std::numbers::pi, std::log(e));  // γ_n / 2
  const double w = std::sqrt(w0 * w0 - rate * rate);
  const double k_t = 2.0 / 7.0 * 1000;
  const double c_t = mass * rate;  // half of the normal dashpot's
  double v = tangential;
  double spin = 0;
  double spring = 0;
  for (double time = 0.5 * step; time < std::numbers::pi / w; time += step) {
    const double decay = std::exp(-rate * time) * oblique::approach;
    const double overlap = decay * std::sin(w * time) / w;
    const double closing = decay * (std::cos(w * time) - rate / w * std::sin(w * time));
    const double most = mu * std::abs(1000 * overlap + 2 * mass * rate * closing);
    const double surface = v - r * spin;
    spring += step * surface;
    double force = -k_t * spring - c_t * surface;
    if (std::abs(force) > most) {
      force = std::copysign(most, force);
      spring = -(force + c_t * surface) / k_t;
    }
    v += step * force / mass;
    spin -= step * 2.5 * force / (mass * r);
  }
  return {1e3 * e * oblique::approach, 1e3 * v, spin};
}

// The dashpot is of first order: a fiftieth of the sub-step leaves a fiftieth of its error, some
// 1e-5.
TEST(Impact, comes_within_1e_4_of_the_law_with_shorter_sub_steps) {
  constexpr double close = 1e-4;
  for (const double speed : {0.5, 5.0, 15.0}) {
    const Impact ours = hit_wall(1e-3 * speed, Precision::full, oblique::time_step / 50);
    const Impact law = law_on_a_wall(1e-3 * speed);
    fmt::print("wall {:>4.1f} at {:g} s | {:.5f} {:.5f} {:.4f} | law {:.5f} {:.5f} {:.4f}\n", speed,
               oblique::time_step / 50, ours.normal, ours.tangential, ours.spin, law.normal,
               law.tangential, law.spin);
    EXPECT_NEAR(ours.normal, law.normal, close * law.normal) << speed;
    EXPECT_NEAR(ours.tangential, law.tangential, close * speed) << speed;
    EXPECT_NEAR(ours.spin, law.spin, 2.5 * close * speed) << speed;
  }
}

TEST(Slip, follows_the_closed_form_until_it_rolls) {
  constexpr double g = 9.81;
  fmt::print("  mu | slip ends, mu g t / u0 (0.285714) | u / u0, r w / u0 (0.714286)\n");
  for (const double mu : {0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0}) {
    const oblique::Slip slip = oblique::slip_on_a_wall(mu);
    fmt::print("{:>4.1f} | {:.6f} | {:.6f} {:.6f}; worst while slipping {:.1e} m/s\n", mu, slip.end,
               slip.speed, slip.surface, slip.worst_so_far);
    // Until the spring reaches its limit the friction grows from 0: a time of u / w_t² μ g, less
    // than one sub-step here, and a delay of μ g dt in both.
    EXPECT_LT(slip.worst_so_far, 2.5 * 2 * mu * g * 1e-6) << mu;
    EXPECT_NEAR(slip.end, 2.0 / 7, 1e-2 * 2 / 7) << mu;
    EXPECT_NEAR(slip.speed, 5.0 / 7, 1e-3) << mu;
    EXPECT_NEAR(slip.surface, 5.0 / 7, 1e-3) << mu;
  }
}

}  // namespace
}  // namespace fluxpact
