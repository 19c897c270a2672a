#include "dem_server/backends/hard_sphere/collision.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dem_server/backends/native/contact_law.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

/// Of the mass that counts along the normal, what counts across it: 1 / (1 + 5/2) for solid
/// spheres.
constexpr double tangential_share = 2.0 / 7.0;

void require(const PairSettings& pair, const char* key, double value, bool fits,
             const char* allowed) {
  if (fits) return;
  throw ConfigError("particles.contact.pairs: [{}, {}] has {} = {}; it must be {}", pair.between[0],
                    pair.between[1], key, value, allowed);
}

CollisionLaw law_of(const PairSettings& pair) {
  const double e = pair.restitution;
  require(pair, "restitution", e, e >= 0 && e <= 1, "between 0 and 1");
  require(pair, "friction", pair.friction, pair.friction >= 0, "zero or positive");
  double ratio = 2.0 / 7.0;
  if (pair.tangential_stiffness && pair.normal_stiffness) {
    ratio = *pair.tangential_stiffness / *pair.normal_stiffness;
  }
  const double beta =
      pair.tangential_restitution.value_or(tangential_restitution_of_springs(e, ratio));
  require(pair, "tangential_restitution", beta, beta >= -1 && beta <= 1, "between -1 and 1");
  return {e, beta, pair.friction, true};
}

struct Rebound {
  double speed;    ///< normal, after [m/s]
  double impulse;  ///< tangential, over the effective mass [m/s]
};

/// By the law.
Rebound lossy(const CollisionLaw& law, double approach, double slip, double least) {
  const double speed = std::max(law.restitution * approach, least);
  const double sticking = tangential_share * (1 + law.tangential_restitution) * slip;
  return {speed, std::min(sticking, law.friction * (approach + speed))};
}

/// The energy that friction takes from the tangential velocity goes into the normal one.
Rebound conserving(const CollisionLaw& law, double approach, double slip, double least) {
  const double beta = law.tangential_restitution;
  const double sticking = tangential_share * (1 + beta) * slip;
  const double speed =
      std::sqrt(approach * approach + tangential_share * (1 - beta * beta) * slip * slip);
  const double mu = law.friction;
  if (sticking <= mu * (approach + speed)) return {std::max(speed, least), sticking};
  // Sliding: w² - v² = 2 P s - P² / share with P = μ (v + w), divided by v + w.
  const double bend = 0.5 * mu * mu / tangential_share;
  const double sliding = (approach * (0.5 - bend) + mu * slip) / (0.5 + bend);
  return {std::max(sliding, least), mu * (approach + sliding)};
}

}  // namespace

double tangential_restitution_of_springs(double restitution, double stiffness_ratio) {
  // In units of the normal oscillator without damping; the dashpot across has half the coefficient.
  const double ratio = damping_ratio(restitution);
  if (ratio >= 1) return 0;  // the contact never ends, and the spring comes to rest
  const double duration = std::numbers::pi / std::sqrt(1 - ratio * ratio);
  const double decay = 1.75 * ratio;
  const double square = 3.5 * stiffness_ratio - decay * decay;
  const double root = std::sqrt(std::abs(square));
  const double angle = root * duration;
  // sin(w t) / w and cos(w t), or their like for a spring that creeps back.
  const double swing = root == 0    ? duration
                       : square > 0 ? std::sin(angle) / root
                                    : std::sinh(angle) / root;
  const double phase = square > 0 ? std::cos(angle) : std::cosh(angle);
  return -std::exp(-decay * duration) * (phase - decay * swing);
}

CollisionLaws::CollisionLaws(const ParticleSettings& settings)
    : materials_(static_cast<int>(settings.materials.size())) {
  laws_.resize((settings.materials.size() + 1) * (settings.materials.size() + 1));
  const auto find = [&](const std::string& name) {
    const auto found = settings.materials.find(name);
    if (found == settings.materials.end() && name != "walls") {
      throw ConfigError(
          "particles.contact.pairs: `{}` is neither a material of particles.materials nor `walls`",
          name);
    }
    return static_cast<int>(std::distance(settings.materials.begin(), found));
  };
  for (const PairSettings& pair : settings.contact.pairs) {
    const int a = find(pair.between[0]);
    const int b = find(pair.between[1]);
    if (of(a, b).given) {
      throw ConfigError("particles.contact.pairs: [{}, {}] stands twice; keep one of them",
                        pair.between[0], pair.between[1]);
    }
    laws_[a * (materials_ + 1) + b] = laws_[b * (materials_ + 1) + a] = law_of(pair);
  }
}

void collide(const CollisionLaw& law, const Rest& rest, const Vector3& normal, Collider& a,
             Collider& b) {
  const Vector3 at_contact =
      a.velocity - b.velocity + (a.radius * a.spin + b.radius * b.spin).cross(normal);
  const double along = at_contact.dot(normal);
  const double approach = std::max(along, 0.0);
  const double mass = 1 / (a.inverse_mass + b.inverse_mass);
  Vector3 across = Vector3::Zero();
  double slip = 0;
  if (law.friction > 0) {
    across = at_contact - along * normal;
    slip = across.norm();
  }
  const Rebound rebound = rest.conserves ? conserving(law, approach, slip, rest.least_rebound)
                                         : lossy(law, approach, slip, rest.least_rebound);
  // On a. Two that part already by a rounding error are not pulled together.
  Vector3 impulse = -mass * std::max(along + rebound.speed, 0.0) * normal;
  if (slip > 0) {
    impulse -= mass * rebound.impulse / slip * across;
    const Vector3 turn = 2.5 * normal.cross(impulse);  // r n x P over 2/5 m r² is this over m r
    a.spin += a.inverse_mass / a.radius * turn;
    b.spin += b.inverse_mass / b.radius * turn;
  }
  a.velocity += a.inverse_mass * impulse;
  b.velocity -= b.inverse_mass * impulse;
}

}  // namespace fluxpact
