// Impacts with friction at low speed, and slip that turns to rolling: the motions, and their closed
// forms. Of all spheres: radius 1 mm, 2250 kg/m³, k 1000 N/m, k_t 2/7 of it, e 0.9, friction 0.3.
#pragma once

#include <cmath>
#include <numbers>

#include "tests/unit/dem_server/native/spheres_in_a_box.hpp"

namespace fluxpact::oblique {

inline constexpr double r = 1e-3;
inline constexpr double approach = 5e-3;  // [m/s] along the normal
inline constexpr double time_step = 1e-6;

/// The moment of touching is known to a sub-step only, which changes the impulse of the dashpot by
/// up to γ dt / 2 = 3.5e-4 (wall), 4.9e-4 (pair) of itself; the dashpot's lag as much again.
inline constexpr double tolerance = 1e-3;

/// Normal and tangential velocity [mm/s] and spin [rad/s] of the first sphere after the impact.
struct Impact {
  double normal, tangential, spin;
};

inline Scene scene_of(double stiffness, Precision precision) {
  Scene scene = box_scene({0.02, 0.02, 0.02});
  scene.particles.numerics.precision = precision;
  add_laws(scene, stiffness, 0.9, 0.3);
  return scene;
}

inline Impact hit_wall(double tangential, Precision precision = Precision::full,
                       double dt = time_step) {
  ParticleState state;
  add_sphere(state, {0.01, 0.01, r + 1e-9}, {tangential, 0, -approach}, r);
  const auto engine = make_engine(scene_of(1000, precision), state);
  run(*engine, 1e-3, dt);
  const ParticleState& after = engine->particles();
  return {1e3 * after.velocity[0].z(), 1e3 * after.velocity[0].x(), after.spin[0].y()};
}

inline Impact hit_sphere(double tangential, Precision precision = Precision::full,
                         double stiffness = 1000, double dt = time_step) {
  ParticleState state;
  add_sphere(state, {0.01, 0.01, 0.01}, {approach, tangential, 0}, r);
  add_sphere(state, {0.01 + 2 * r + 1e-9, 0.01, 0.01}, Vector3::Zero(), r);
  const auto engine = make_engine(scene_of(stiffness, precision), state);
  run(*engine, 1000 * dt, dt);
  const ParticleState& after = engine->particles();
  EXPECT_NEAR(after.spin[0].z(), after.spin[1].z(), 1e-12 + 1e-6 * (precision != Precision::full));
  return {1e3 * after.velocity[0].x(), 1e3 * after.velocity[0].y(), after.spin[0].z()};
}

/// Where the tangential velocity is small the contact sticks throughout: its point is a damped
/// oscillator of frequency² 7 k_t / 2 m_eff and rate 7 γ_t / 4. At 0.5 mm/s:
inline constexpr Impact wall_sticks{4.5, 0.23832, 0.6542};
inline constexpr Impact pair_sticks{0.25, 0.36916, -0.3271};

/// Where it is large the contact slips throughout: dv_t = μ (1 + e) v_n, w = 5 dv_t / 2 r on a
/// wall, half of it for each of two spheres; `factor` of it, see below.
inline Impact wall_slips(double tangential, double factor = 1) {
  const double loss = 0.3 * 1.9 * 1e3 * approach * factor;
  return {4.5, 1e3 * tangential - loss, 2.5 * loss};
}
inline Impact pair_slips(double tangential, double factor = 1) {
  const double loss = 0.5 * 0.3 * 1.9 * 1e3 * approach * factor;
  return {0.25, 1e3 * tangential - loss, -2.5 * loss};
}

/// Friction follows |F_n| and so acts in the attractive end of the contact, too: ∫|F_n| dt over m
/// (1 + e) v_n.
inline double impulse_factor(double e) {
  const double l = std::log(e);
  const double z = -l / std::sqrt(std::numbers::pi * std::numbers::pi + l * l);
  const double d = std::sqrt(1 - z * z);
  // v(τ) of the damped oscillator from v = -1, and its largest value, where the force changes sign.
  const auto v = [&](double tau) {
    return -std::exp(-z * tau) * (std::cos(d * tau) - z / d * std::sin(d * tau));
  };
  const double most = v((std::numbers::pi - std::atan2(2 * z * d, d * d - z * z)) / d);
  return ((1 + most) + (most - e)) / (1 + e);
}

/// A sphere of radius 0.5 mm that slips on a wall at first, at 0.1 m/s, and then rolls: slip ends
/// at t = 2 u0 / (7 μ g), with u = r w = 5/7 u0.
struct Slip {
  double end = 0;           ///< μ g t / u0 when it rolls; 2/7
  double speed = 0;         ///< u / u0 in the end; 5/7
  double surface = 0;       ///< r w / u0 in the end; 5/7
  double worst_so_far = 0;  ///< [m/s] off the closed form while it slips
};

inline Slip slip_on_a_wall(double mu) {
  constexpr double g = 9.81;
  constexpr double small = 0.5e-3;
  constexpr double u0 = 0.1;
  constexpr double k = 1e4;
  const double mass = 4.0 / 3.0 * std::numbers::pi * small * small * small * 1e4;
  Scene scene = box_scene({0.01, 0.01, 0.01});
  scene.scene.gravity = {0, 0, -g};
  scene.particles.materials["glass"].density = 1e4;
  add_pair(scene, "glass", "walls", k, 1.0, mu);
  scene.particles.contact.pairs.back().tangential_stiffness = k;
  ParticleState state;
  add_sphere(state, {1e-3, 5e-3, small - mass * g / k}, {u0, 0, 0}, small, 1e4);
  const auto engine = make_engine(scene, state);
  const double end = 2 * u0 / (7 * mu * g);
  Slip slip;
  for (int window = 1; window <= 2000; ++window) {
    run(*engine, 1e-5, 1e-6);
    const double time = 1e-5 * window;
    const double u = engine->particles().velocity[0].x();
    const double rw = small * engine->particles().spin[0].y();
    if (slip.end == 0 && u <= rw) slip.end = mu * g * time / u0;
    if (time < 0.98 * end) {
      slip.worst_so_far = std::max({slip.worst_so_far, std::abs(u - u0 + mu * g * time),
                                    std::abs(rw - 2.5 * mu * g * time)});
    }
    // The undamped tangential spring goes on swinging by μ g / w_t = 1e-4 m/s: mean of the end.
    if (window > 1600) {
      slip.speed += u / u0 / 400;
      slip.surface += rw / u0 / 400;
    }
  }
  return slip;
}

}  // namespace fluxpact::oblique
