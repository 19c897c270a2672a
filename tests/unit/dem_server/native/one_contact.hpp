// One contact for the tests of its force: numbers in, numbers out, and a sphere that flies against
// another or a wall. Every lane of the vector gets the same contact, and must give the same.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "dem_server/backends/native/contact_force-inl.hpp"
#include "proto/base/vector.hpp"

HWY_BEFORE_NAMESPACE();
namespace fluxpact::HWY_NAMESPACE {

/// A material `a` with one pair [a, a] and one [a, walls] to be filled in.
inline ParticleSettings two_pairs(ContactLaw law = ContactLaw::linear) {
  ParticleSettings settings;
  settings.materials["a"].density = 2500;
  settings.contact.law = law;
  PairSettings pair;
  if (law == ContactLaw::linear) pair.normal_stiffness = 1000;
  pair.between = {"a", "a"};
  settings.contact.pairs.push_back(pair);
  pair.between = {"a", "walls"};
  settings.contact.pairs.push_back(pair);
  return settings;
}

/// Two pairs of Hertz' law; the walls are of the same solid.
inline ParticleSettings elastic(double modulus, double nu) {
  ParticleSettings settings = two_pairs(ContactLaw::hertz);
  settings.materials["a"].youngs_modulus = modulus;
  settings.materials["a"].poisson_ratio = nu;
  settings.contact.walls = WallMaterialSettings{modulus, nu};
  return settings;
}

/// Applies `change` to both pairs.
inline ParticleSettings with(ParticleSettings settings,
                             const std::function<void(PairSettings&)>& change) {
  for (PairSettings& pair : settings.contact.pairs) change(pair);
  return settings;
}

/// TouchLanes of one contact.
struct Touch {
  Vector3 normal{0, 0, 1};
  double overlap = 0;
  Vector3 velocity{0, 0, 0};
  Vector3 radius_spin{0, 0, 0};
  Vector3 spin{0, 0, 0};
  double inverse_mass = 1;
  double inverse_radius = 1;
  double inverse_inertia = 1;
};

struct Springs {
  Vector3 tangential{0, 0, 0};
  Vector3 rolling{0, 0, 0};
  double bridge = 0;
};

struct Pushed {
  Vector3 force, lever, torque;
  Springs springs;
};

template <class D>
Lanes3<hn::Vec<D>> all_lanes(D d, const Vector3& v) {
  using T = hn::TFromD<D>;
  return {hn::Set(d, static_cast<T>(v.x())), hn::Set(d, static_cast<T>(v.y())),
          hn::Set(d, static_cast<T>(v.z()))};
}

template <class D>
double one_lane(D d, hn::Vec<D> v) {
  std::vector<hn::TFromD<D>> values(hn::Lanes(d));
  hn::StoreU(v, d, values.data());
  for (const auto value : values) EXPECT_EQ(value, values[0]);
  return static_cast<double>(values[0]);
}

template <class D>
Vector3 one_lane(D d, const Lanes3<hn::Vec<D>>& v) {
  return {one_lane(d, v.x), one_lane(d, v.y), one_lane(d, v.z)};
}

/// The force of one contact in numbers of type T.
template <class T>
Pushed push(const LawTable<T>& table, int pair, const Touch& touch, const Springs& springs,
            double time_step, bool near = true) {
  const hn::ScalableTag<T> d;
  using V = hn::Vec<decltype(d)>;
  const auto set = [&](double value) HWY_ATTR { return hn::Set(d, static_cast<T>(value)); };
  const TouchLanes<V> lanes{all_lanes(d, touch.normal),   set(touch.overlap),
                            all_lanes(d, touch.velocity), all_lanes(d, touch.radius_spin),
                            all_lanes(d, touch.spin),     set(std::sqrt(1 / touch.inverse_mass)),
                            set(touch.inverse_radius),    set(touch.inverse_inertia)};
  SpringLanes<V> spring{all_lanes(d, springs.tangential), all_lanes(d, springs.rolling),
                        set(springs.bridge)};
  const Lanes3<V> zero = all_lanes(d, Vector3::Zero());
  ForceLanes<V> out{zero, zero, zero};
  const LawLanes<V> law = load_law(d, table, pair);
  const auto mask = near ? hn::Eq(zero.x, zero.x) : hn::Ne(zero.x, zero.x);
  if (table.model.friction) {
    contact_force<true>(d, table.model, law, lanes, set(time_step), spring, mask, out);
  } else {
    contact_force<false>(d, table.model, law, lanes, set(time_step), spring, mask, out);
  }
  return {
      one_lane(d, out.force),
      one_lane(d, out.lever),
      one_lane(d, out.torque),
      {one_lane(d, spring.tangential), one_lane(d, spring.rolling), one_lane(d, spring.bridge)}};
}

struct Ball {
  Vector3 x{0, 0, 0};
  Vector3 v{0, 0, 0};
  Vector3 w{0, 0, 0};
  double radius = 1e-3;
  double mass = 1e-5;
  double inertia() const { return 0.4 * mass * radius * radius; }
  double energy() const { return 0.5 * (mass * v.squaredNorm() + inertia() * w.squaredNorm()); }
};

/// Two balls, or one above the wall z = 0, moved by velocity-Verlet: half a kick, drift, force with
/// the velocity half a step behind, half a kick.
class Flight {
 public:
  Flight(const ParticleSettings& settings, std::vector<Ball> at_start)
      : balls(std::move(at_start)), laws_(settings), table_(law_table<double>(laws_)) {
    push_now(0);
  }

  std::vector<Ball> balls;
  Vector3 gravity{0, 0, 0};
  double overlap = 0;       ///< of the last step
  double largest_push = 0;  ///< largest normal force so far
  Springs springs;

  void step(double dt) {
    kick(0.5 * dt);
    for (Ball& ball : balls) ball.x += dt * ball.v;
    push_now(dt);
    kick(0.5 * dt);
  }
  void steps(int count, double dt) {
    for (int i = 0; i < count; ++i) step(dt);
  }
  double energy() const {
    double sum = 0;
    for (const Ball& ball : balls) sum += ball.energy();
    return sum;
  }

 private:
  void push_now(double dt) {
    const Ball& a = balls[0];
    const auto over_inertia = [](const Ball& ball) {
      return 1 / (ball.mass * ball.radius * ball.radius);
    };
    Touch touch;
    touch.velocity = a.v;
    touch.radius_spin = a.radius * a.w;
    touch.spin = a.w;
    touch.inverse_mass = 1 / a.mass;
    touch.inverse_radius = 1 / a.radius;
    touch.inverse_inertia = over_inertia(a);
    if (balls.size() == 1) {
      touch.overlap = a.radius - a.x.z();
    } else {
      const Ball& b = balls[1];
      const Vector3 apart = a.x - b.x;
      touch.normal = apart.normalized();
      touch.overlap = a.radius + b.radius - apart.norm();
      touch.velocity -= b.v;
      touch.radius_spin += b.radius * b.w;
      touch.spin -= b.w;
      touch.inverse_mass += 1 / b.mass;
      touch.inverse_radius += 1 / b.radius;
      touch.inverse_inertia += over_inertia(b);
    }
    overlap = touch.overlap;
    const int pair = balls.size() == 1 ? laws_.index(0, laws_.walls()) : laws_.index(0, 0);
    pushed_ = push(table_, pair, touch, springs, dt);
    springs = pushed_.springs;
    largest_push = std::max(largest_push, pushed_.force.dot(touch.normal));
  }
  void kick(double dt) {
    for (std::size_t i = 0; i < balls.size(); ++i) {
      const double sign = i == 0 ? 1 : -1;
      Ball& ball = balls[i];
      ball.v += dt * (sign / ball.mass * pushed_.force + gravity);
      ball.w += dt / ball.inertia() * (ball.radius * pushed_.lever + sign * pushed_.torque);
    }
  }

  ContactLaws laws_;
  LawTable<double> table_;
  Pushed pushed_;
};

}  // namespace fluxpact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

namespace fluxpact {
using namespace HWY_NAMESPACE;  // NOLINT(google-build-using-namespace): one target in these tests
}
