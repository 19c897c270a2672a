// A sphere that falls on a wall, against the closed form of the linear spring-dashpot under
// gravity.
#include <cmath>
#include <numbers>

#include "tests/unit/dem_server/native/spheres_in_a_box.hpp"

namespace fluxpact {
namespace {

constexpr double g = 9.81;
constexpr double radius = 0.1;
constexpr double density = 2600;
constexpr double start_height = 0.5;
const double mass = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius * density;

/// Free fall from rest, one contact, free flight (the contact from touching until the overlap is
/// zero again, its attractive end included).
struct Bounce {
  double k, e;
  double w0() const { return std::sqrt(k / mass); }
  double b() const {
    const double l = std::log(e);
    return -l / std::sqrt(std::numbers::pi * std::numbers::pi + l * l);
  }
  double touch_time() const { return std::sqrt(2 * (start_height - radius) / g); }
  double touch_speed() const { return g * touch_time(); }
  double height_in_contact(double s) const {
    const double wd = w0() * std::sqrt(1 - b() * b());
    const double sink = g / (w0() * w0());
    return radius - sink +
           std::exp(-b() * w0() * s) *
               (sink * std::cos(wd * s) + (b() * g / w0() - touch_speed()) / wd * std::sin(wd * s));
  }
  double contact_duration() const {
    const double wd = w0() * std::sqrt(1 - b() * b());
    double low = 0.6 * std::numbers::pi / wd;
    double high = 1.9 * std::numbers::pi / wd;
    for (int i = 0; i < 100; ++i) {
      const double middle = 0.5 * (low + high);
      (height_in_contact(middle) < radius ? low : high) = middle;
    }
    return low;
  }
  double rebound_speed() const {
    const double s = contact_duration();
    const double h = 1e-6 * s;  // central difference: error of order 1e-12, rounding 1e-9
    return (height_in_contact(s + h) - height_in_contact(s - h)) / (2 * h);
  }
  double height(double t) const {
    const double s = t - touch_time();
    if (s <= 0) return start_height - 0.5 * g * t * t;
    const double duration = contact_duration();
    if (s <= duration) return height_in_contact(s);
    const double flight = s - duration;
    return radius + rebound_speed() * flight - 0.5 * g * flight * flight;
  }
};

std::unique_ptr<ParticleEngine> dropped_sphere(const Bounce& bounce, double height,
                                               double speed = 0) {
  Scene scene = box_scene({1, 1, 1});
  scene.scene.gravity = {0, 0, -g};
  scene.particles.materials["glass"].density = density;
  add_pair(scene, "glass", "walls", bounce.k, bounce.e, 0);
  ParticleState state;
  add_sphere(state, {0.5, 0.5, height}, {0, 0, speed}, radius, density);
  return make_engine(scene, state);
}

// The published values of the same case (rebound time, speed, next apex), so that the closed form
// above is itself checked.
TEST(Bounce, closed_form_gives_the_published_rebound) {
  const Bounce soft{1e4, 0.9};
  EXPECT_NEAR(soft.touch_time() + soft.contact_duration(), 0.397388, 1e-6);
  EXPECT_NEAR(soft.rebound_speed(), 2.475857, 1e-6);
  const Bounce hard{1e5, 0.6};
  EXPECT_NEAR(hard.touch_time() + hard.contact_duration(), 0.319818, 1e-6);
  EXPECT_NEAR(hard.rebound_speed(), 1.626207, 1e-6);
}

TEST(Bounce, follows_the_closed_form) {
  for (const double k : {1e4, 2.5e4, 5e4, 1e5}) {
    for (const double e : {1.0, 0.9, 0.8, 0.7, 0.6}) {
      if (k == 1e4 && e == 1.0) continue;  // presses its centre through the wall
      const Bounce bounce{k, e};
      const auto engine = dropped_sphere(bounce, start_height);
      // First order in the dashpot and in the moment of touching: error of the speed up to
      // γ dt v = 31/s · 2e-6 s · 2.8 m/s = 2e-4 m/s, times 0.2 s of flight.
      double worst = 0;
      for (int sample = 1; sample <= 90; ++sample) {
        run(*engine, 5e-3, 2e-6);
        const double z = engine->particles().position[0].z();
        worst = std::max(worst, std::abs(z - bounce.height(sample * 5e-3)));
      }
      EXPECT_LT(worst, 1e-4 * start_height) << "k " << k << " e " << e;
    }
  }
}

TEST(Bounce, keeps_its_energy_without_damping) {
  for (const double k : {5e4, 5e5, 5e6}) {
    const double time_step = k > 1e6 ? 5e-6 : 2e-5;
    const auto engine = dropped_sphere({k, 1.0}, start_height);
    double worst = 0;
    for (int window = 0; window < 100; ++window) {
      run(*engine, 0.1, time_step);
      const Vector3& x = engine->particles().position[0];
      const Vector3& v = engine->particles().velocity[0];
      const double overlap = std::max(0.0, radius - x.z());
      const double energy =
          mass * g * x.z() + 0.5 * mass * v.squaredNorm() + 0.5 * k * overlap * overlap;
      worst = std::max(worst, std::abs(energy / (mass * g) - start_height));
    }
    // No drift over the 16 bounces and more of 10 s. Each contact may shift the energy by some
    // (w0 dt)² / 8 of it, 1.4e-6 to 2.3e-6, one way or the other by where in a step it begins.
    EXPECT_LT(worst, 1e-5) << k;
  }
}

/// Error after `time` of a sphere that oscillates on the wall and never leaves it.
double oscillation_error(double e, double time_step) {
  const Bounce law{1e5, e};
  const double w0 = law.w0();
  const double decay = law.b() * w0;
  const double wd = w0 * std::sqrt(1 - law.b() * law.b());
  const double rest = radius - g / (w0 * w0);
  const double amplitude = 0.5 * g / (w0 * w0);
  const auto engine = dropped_sphere(law, rest + amplitude);
  const double time = 0.1;
  run(*engine, time, time_step);
  const double exact = rest + amplitude * std::exp(-decay * time) *
                                  (std::cos(wd * time) + decay / wd * std::sin(wd * time));
  return std::abs(engine->particles().position[0].z() - exact) / amplitude;
}

TEST(Verlet, is_second_order_for_springs) {
  const double coarse = oscillation_error(1.0, 4e-4);
  const double middle = oscillation_error(1.0, 2e-4);
  const double fine = oscillation_error(1.0, 1e-4);
  EXPECT_NEAR(std::log2(coarse / middle), 2.0, 0.05);
  EXPECT_NEAR(std::log2(middle / fine), 2.0, 0.05);
}

TEST(Verlet, is_first_order_for_dashpots) {
  const double middle = oscillation_error(0.7, 2e-5);
  const double fine = oscillation_error(0.7, 1e-5);
  EXPECT_NEAR(std::log2(middle / fine), 1.0, 0.05);
}

TEST(Verlet, is_exact_for_a_constant_force) {
  Scene scene = box_scene({1, 1, 1});
  scene.scene.gravity = {0, 0, -g};
  add_pair(scene, "glass", "walls", 100, 0.9, 0.3);
  ParticleState state;
  add_sphere(state, {0.5, 0.5, 0.5}, {0.1, 0, 0}, 1e-3);
  const auto engine = make_engine(scene, state);
  const double m = 4.0 / 3.0 * std::numbers::pi * 1e-9 * 2250;
  Vector3 velocity = state.velocity[0];
  Vector3 position = state.position[0];
  for (int window = 1; window <= 10; ++window) {
    // Another force in each window: it must act from the first half kick on.
    const Vector3 force(1e-5 * window, -2e-5, 1e-6 * window * window);
    const double length = 1e-3;
    engine->advance(length, 50, std::vector<Vector3>{force}, {});
    engine->commit();
    const Vector3 a = force / m + scene.scene.gravity;
    position += length * velocity + 0.5 * length * length * a;
    velocity += length * a;
  }
  // 500 kicks and drifts, each rounded: a few hundred units in the last place.
  EXPECT_LT((engine->particles().velocity[0] - velocity).norm(), 500 * 2.2e-16 * velocity.norm());
  EXPECT_LT((engine->particles().position[0] - position).norm(), 500 * 2.2e-16 * position.norm());
}

}  // namespace
}  // namespace fluxpact
