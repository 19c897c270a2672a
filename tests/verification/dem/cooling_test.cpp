// A gas of inelastic spheres cools as Haff's law has it.
#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "dem_server/insertion/packing.hpp"
#include "dem_server/insertion/random.hpp"
#include "tests/unit/dem_server/native/spheres_in_a_box.hpp"

namespace fluxpact {
namespace {

constexpr int count = 2000;
constexpr double fraction = 0.1;
constexpr double diameter = 2e-3;
constexpr double thermal_speed = 0.1;  // m/s, sqrt(T / m)
constexpr double stiffness = 3e4;
const double mass = std::numbers::pi / 6 * diameter * diameter * diameter * 2250;

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

TEST(Gas, cools_by_the_law_of_haff) {
  // T(t) = T0 / (1 + t / τ)² (Haff, J. Fluid Mech. 134, 1983, 401-430). Enskog's collision rate
  // ω = 24 φ g0 sqrt(T / π m) / d with g0 of Carnahan & Starling (J. Chem. Phys. 51, 1969,
  // 635-636). A collision takes (1 − e²) m v_n² / 4 of the pair's energy, and v_n² is 4 T / m on
  // average over the collisions of Gaussian velocities: (1 − e²) T. With ω N / 2 collisions a
  // second of the energy 3/2 N T, dT/dt = −(1 − e²) ω T / 3, so τ = 6 / ((1 − e²) ω0).
  const double side = diameter * std::cbrt(count * std::numbers::pi / 6 / fraction);
  const double g0 = (1 - 0.5 * fraction) / std::pow(1 - fraction, 3);
  const double rate = 24 * fraction * g0 * thermal_speed / (std::sqrt(std::numbers::pi) * diameter);
  for (const double e : {0.95, 0.9}) {
    const double haff = 6 / ((1 - e * e) * rate);
    Scene scene = box_scene(Vector3::Constant(side), {Axis::x, Axis::y, Axis::z});
    add_pair(scene, "glass", "glass", stiffness, e, 0);
    const double contact_time = std::numbers::pi * std::sqrt(0.5 * mass / stiffness);
    const double window = 0.02 * haff;
    const double time_step = window / std::ceil(window / (0.05 * contact_time));
    scene.particles.time_step = time_step;
    const auto engine = make_engine(scene, gas(side));
    // Straight line through 1 / sqrt(T) over time, from 0.1 τ (contacts have formed by then) to 2
    // τ.
    double n = 0, st = 0, sy = 0, stt = 0, sty = 0;
    for (int w = 1; w <= 100; ++w) {
      run(*engine, window, time_step);
      if (w < 5) continue;
      const double t = w * window;
      const double y = thermal_speed / std::sqrt(temperature(engine->particles()));
      n += 1, st += t, sy += y, stt += t * t, sty += t * y;
    }
    const double slope = (n * sty - st * sy) / (n * stt - st * st);
    const double start = (sy - slope * st) / n;
    const double found = start / slope;
    fmt::print(
        "e {}: tau {:.5f} s, Haff's {:.5f} s ({:+.2f} %); T / T0 at 2 tau {:.4f} (0.1111); "
        "{:.0f} collisions a particle\n",
        e, found, haff, 100 * (found / haff - 1),
        temperature(engine->particles()) / (thermal_speed * thermal_speed),
        rate * haff * std::log(3.0));
    // Statistics of 35,000 collisions and more 0.5 %, three times; a rate of collisions lower by
    // the share of time in contact, ω t_c = 0.5 %; the dashpot stronger by γ dt / 2 < 0.5 %;
    // velocities not quite Gaussian 0.3 % (van Noije & Ernst, Granul. Matter 1, 1998, 57-64). The
    // rate that simulations of hard spheres find is somewhat lower still, for velocities of
    // neighbours that go along with each other (Nakanishi, Energy decay rate in free cooling
    // process of inelastic hard sphere system, Newton Institute, Cambridge 2003); no figure is
    // given there. Homogeneous cooling gives way to clusters after many more collisions (Brito &
    // Ernst, Europhys. Lett. 43, 1998, 497) than the few a particle has here.
    EXPECT_NEAR(found / haff, 1, 0.025) << e;
    EXPECT_NEAR(start, 1, 0.02) << e;
  }
}

}  // namespace
}  // namespace fluxpact
