// A gas of spheres in a periodic box, for soft and hard ones: where it starts, how often it should
// collide, how it should cool.
#pragma once

#include <cmath>
#include <numbers>

#include "dem_server/insertion/packing.hpp"
#include "dem_server/insertion/random.hpp"
#include "tests/unit/dem_server/native/spheres_in_a_box.hpp"

namespace fluxpact::granular_gas {

inline constexpr int count = 2000;
inline constexpr double fraction = 0.1;
inline constexpr double diameter = 2e-3;
inline constexpr double thermal_speed = 0.1;  // m/s, sqrt(T / m)

/// Of the cube that holds them [m].
inline double side_of(double solids) {
  return diameter * std::cbrt(count * std::numbers::pi / 6 / solids);
}

/// Enskog's collisions of one sphere in a second, 24 φ g0 sqrt(T / π m) / d, with g0 of Carnahan &
/// Starling (J. Chem. Phys. 51, 1969, 635-636).
inline double enskog_rate(double solids) {
  const double g0 = (1 - 0.5 * solids) / std::pow(1 - solids, 3);
  return 24 * solids * g0 * thermal_speed / (std::sqrt(std::numbers::pi) * diameter);
}

/// τ of T(t) = T0 / (1 + t / τ)² (Haff, J. Fluid Mech. 134, 1983, 401-430). A collision takes
/// (1 − e²) m v_n² / 4 of the pair's energy, and v_n² is 4 T / m on average over the collisions of
/// Gaussian velocities: (1 − e²) T. With ω N / 2 collisions a second of the energy 3/2 N T,
/// dT/dt = −(1 − e²) ω T / 3, so τ = 6 / ((1 − e²) ω0).
inline double haff_time(double restitution) {
  return 6 / ((1 - restitution * restitution) * enskog_rate(fraction));
}

/// At random places, with Gaussian velocities of the thermal speed and no momentum.
inline ParticleState gas(double side) {
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

/// T / m [m²/s²].
inline double temperature(const ParticleState& state) {
  double square = 0;
  for (const Vector3& v : state.velocity) square += v.squaredNorm() / (3 * state.size());
  return square;
}

/// The straight line through sqrt(T0 / T) over time, which Haff's law says is 1 + t / τ.
class CoolingLine {
 public:
  void add(double time, const ParticleState& state) {
    const double y = thermal_speed / std::sqrt(temperature(state));
    n_ += 1, t_ += time, y_ += y, tt_ += time * time, ty_ += time * y;
  }
  double start() const { return (y_ - slope() * t_) / n_; }  ///< 1
  double time() const { return start() / slope(); }          ///< τ [s]

 private:
  double slope() const { return (n_ * ty_ - t_ * y_) / (n_ * tt_ - t_ * t_); }
  double n_ = 0, t_ = 0, y_ = 0, tt_ = 0, ty_ = 0;
};

}  // namespace fluxpact::granular_gas
