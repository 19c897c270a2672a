// The instant collision of two rough spheres, or of a sphere and a wall: restitution normal to the
// surfaces, sticking with a tangential restitution, or sliding with friction (Walton 1993; Foerster
// et al., Phys. Fluids 6, 1994, 1108-1115). What the event-driven engine does at each contact.
#pragma once

#include <vector>

#include "proto/base/vector.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// One pair of materials.
struct CollisionLaw {
  double restitution = 1;             ///< e: normal speed after over before
  double tangential_restitution = 0;  ///< β: - tangential speed after over before, if it sticks
  double friction = 0;                ///< μ
  bool given = false;
};

/// What the linear spring and dashpot of a pair (contact_law.hpp) do to the tangential velocity of
/// a contact that sticks, over the time in which the normal velocity turns: -1 ... 1. The
/// tangential one is an oscillator of w² = 7 k_t / (2 m*) and the damping rate 7 c_t / (4 m*).
/// `stiffness_ratio`: k_t / k_n.
double tangential_restitution_of_springs(double restitution, double stiffness_ratio);

/// Laws by two materials, or a material and the walls.
class CollisionLaws {
 public:
  /// Throws ConfigError for a pair that names an unknown material, stands twice, or has a value
  /// outside its range.
  explicit CollisionLaws(const ParticleSettings& settings);

  int walls() const { return materials_; }  ///< the walls' material index
  const CollisionLaw& of(int a, int b) const { return laws_[a * (materials_ + 1) + b]; }

 private:
  int materials_;
  std::vector<CollisionLaw> laws_;
};

/// One of the two that collide. A wall or a fixed sphere: without mass inverse and speed.
struct Collider {
  Vector3 velocity;     ///< [m/s]
  Vector3 spin;         ///< [rad/s]
  double radius;        ///< [m]
  double inverse_mass;  ///< [1/kg]; 0: nothing moves it
};

/// What stands in for the law where collisions follow each other too fast for it.
struct Rest {
  bool conserves = false;    ///< the energy that friction takes goes into the rebound, which loses
                             ///< none: the collision exchanges momentum only
  double least_rebound = 0;  ///< [m/s] normal speed after
};

/// Both after their collision; `normal` is the unit vector from `a` to `b`. Momentum, and angular
/// momentum for centres r_a + r_b apart, are conserved to round-off, energy is with e = 1 and no
/// friction (or β = ±1 and no sliding), and with `rest.conserves`.
void collide(const CollisionLaw& law, const Rest& rest, const Vector3& normal, Collider& a,
             Collider& b);

}  // namespace fluxpact
