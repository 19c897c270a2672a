// Gases of hard spheres: the rate of collisions, and how inelastic ones cool.
#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "dem_server/insertion/packing.hpp"
#include "dem_server/insertion/random.hpp"
#include "tests/unit/dem_server/hard_sphere/hard_spheres_in_a_box.hpp"

namespace fluxpact {
namespace {

constexpr int count = 2000;
constexpr double fraction = 0.1;
constexpr double diameter = 2e-3;
constexpr double thermal_speed = 0.1;  // m/s, sqrt(T / m)

/// Of Carnahan & Starling (J. Chem. Phys. 51, 1969, 635-636).
double g0(double solids) { return (1 - 0.5 * solids) / std::pow(1 - solids, 3); }

/// Enskog's collisions of one sphere in a second: 24 φ g0 sqrt(T / π m) / d.
double enskog_rate(double solids) {
  return 24 * solids * g0(solids) * thermal_speed / (std::sqrt(std::numbers::pi) * diameter);
}

double side_of(double solids) {
  return diameter * std::cbrt(count * std::numbers::pi / 6 / solids);
}

ParticleState gas(double side) {
  const PackingBox box{Vector3::Zero(), Vector3::Constant(side), {true, true, true}};
  const auto centres = random_packing(box, count, diameter, 1);
  UniformRandom random(2);
  const auto normal = [&random] {  // Box & Muller
    return std::sqrt(-2 * std::log(1 - random.next())) *
           std::cos(2 * std::numbers::pi * random.next());
  };
  ParticleState state;
  Vector3 mean = Vector3::Zero();
  for (const Vector3& centre : centres.value()) {
    const double u = normal();
    const double v = normal();
    add_sphere(state, centre, {u, v, normal()}, 0.5 * diameter);
    mean += state.velocity.back() / count;
  }
  double square = 0;
  for (Vector3& v : state.velocity) square += (v -= mean).squaredNorm() / (3 * count);
  for (Vector3& v : state.velocity) v *= thermal_speed / std::sqrt(square);
  return state;
}

double temperature(const ParticleState& state) {  // T / m [m²/s²]
  double square = 0;
  for (const Vector3& v : state.velocity) square += v.squaredNorm() / (3 * state.size());
  return square;
}

TEST(HardGas, collides_as_often_as_enskog_says) {
  for (const double solids : {0.1, 0.45}) {
    const double side = side_of(solids);
    Scene scene = box_scene(Vector3::Constant(side), {Axis::x, Axis::y, Axis::z});
    add_collision(scene, "glass", 1.0, 0.0);
    const auto engine = make_hard(scene, gas(side));
    const double window = 10 / enskog_rate(solids);
    // The order of the packing is forgotten after some tens of collisions.
    for (int k = 0; k < 6; ++k) run(*engine, window, window / 1000);
    const std::int64_t before = engine->counters().collisions;
    for (int k = 0; k < 10; ++k) run(*engine, window, window / 1000);
    const double rate =
        2.0 * static_cast<double>(engine->counters().collisions - before) / (count * 10 * window);
    fmt::print("solids {}: {:.4f} of Enskog's rate\n", solids, rate / enskog_rate(solids));
    // 100,000 collisions: 0.3 %, three times; Carnahan & Starling's g0 is good to 0.5 %.
    EXPECT_NEAR(rate / enskog_rate(solids), 1, 0.015) << solids;
  }
}

TEST(HardGas, cools_by_the_law_of_haff) {
  // T(t) = T0 / (1 + t / τ)², τ = 6 / ((1 − e²) ω0): see the same test of the soft spheres
  // (tests/verification/dem/cooling_test.cpp).
  const double side = side_of(fraction);
  for (const double e : {0.95, 0.9}) {
    const double haff = 6 / ((1 - e * e) * enskog_rate(fraction));
    Scene scene = box_scene(Vector3::Constant(side), {Axis::x, Axis::y, Axis::z});
    add_collision(scene, "glass", e, 0);
    const double window = 0.02 * haff;
    const auto engine = make_hard(scene, gas(side));
    double n = 0, st = 0, sy = 0, stt = 0, sty = 0;
    for (int w = 1; w <= 100; ++w) {
      run(*engine, window, window / 1000);
      const double t = w * window;
      const double y = thermal_speed / std::sqrt(temperature(engine->particles()));
      n += 1, st += t, sy += y, stt += t * t, sty += t * y;
    }
    const double slope = (n * sty - st * sy) / (n * stt - st * st);
    const double start = (sy - slope * st) / n;
    const double found = start / slope;
    fmt::print("e {}: tau {:.5f} s, Haff's {:.5f} s ({:+.2f} %)\n", e, found, haff,
               100 * (found / haff - 1));
    // Statistics of 35,000 collisions and more 0.5 %, three times; velocities not quite Gaussian
    // 0.3 %; and those of neighbours that go along with each other (as for the soft spheres).
    EXPECT_NEAR(found / haff, 1, 0.025) << e;
    EXPECT_NEAR(start, 1, 0.02) << e;
  }
}

}  // namespace
}  // namespace fluxpact
