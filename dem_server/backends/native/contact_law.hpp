// The contact parameters of each pair of materials, and the longest sub-step they allow.
// Set up once when the engine is made; the force itself is in contact_force.hpp.
#pragma once

#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "dem_server/backends/particle_engine.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// Linear spring-dashpot of one pair of materials (Cundall & Strack, Géotechnique 29, 1979, 47-65).
struct PairLaw {
  double normal_stiffness = 0;      ///< [N/m]
  double tangential_stiffness = 0;  ///< [N/m]
  double damping_ratio = 0;         ///< share of critical damping that gives the restitution [-]
  double friction = 0;              ///< [-]
  bool given = false;
};

/// |ln e| / sqrt(π² + ln² e): the share of critical damping with which a linear contact rebounds at
/// e times the speed of approach (separation at zero overlap, attraction at its end kept). 1 for e
/// = 0.
double damping_ratio(double restitution);

/// Coefficient [kg/s] of the normal dashpot: 2 ζ sqrt(k m_eff), which is γ_n m_eff of other codes.
double damping_coefficient(const PairLaw& law, double effective_mass);

/// The laws as the kernel reads them, in its own precision.
template <class Real>
struct LawTable {
  struct Row {
    Real normal_stiffness, tangential_stiffness, inverse_tangential_stiffness, damping, friction;
  };
  std::vector<Row> rows;
};

/// Laws by two materials, or a material and the walls.
class ContactLaws {
 public:
  /// Throws ConfigError for a pair that names an unknown material, stands twice, or has a value
  /// outside its range.
  explicit ContactLaws(const ParticleSettings& settings);

  int walls() const { return static_cast<int>(names_.size()) - 1; }  ///< the walls' material index
  int index(int a, int b) const { return a * static_cast<int>(names_.size()) + b; }
  /// All laws, in the order of `index`.
  template <class Real>
  LawTable<Real> table() const {
    LawTable<Real> table;
    for (const PairLaw& law : laws_) {
      table.rows.push_back({static_cast<Real>(law.normal_stiffness),
                            static_cast<Real>(law.tangential_stiffness),
                            static_cast<Real>(1 / law.tangential_stiffness),
                            static_cast<Real>(2 * law.damping_ratio *
                                              std::sqrt(law.normal_stiffness)),
                            static_cast<Real>(law.friction)});
    }
    return table;
  }
  const PairLaw& operator[](int index) const { return laws_[index]; }
  const std::string& name(int material) const { return names_[material]; }
  /// True if any contact has friction: only then are tangential springs and spins followed.
  bool any_friction() const;

 private:
  int find(const std::string& name) const;
  std::vector<std::string> names_;  // the materials in the order of the scene's map, then the walls
  std::vector<PairLaw> laws_;
};

/// Longest sub-step [s] for these particles, and the contact that sets it.
struct StepLimit {
  double longest = 0;  ///< a tenth of the shortest contact time; infinite without contacts
  std::string pair;
};

/// A tenth of the shortest contact time π sqrt(m_eff / k) over the pairs that can meet: undamped,
/// hence never longer than the damped time; with friction also that of the tangential spring of two
/// rolling spheres, k = 7/2 k_t. Throws ConfigError that names a pair that can meet but has no law.
StepLimit step_limit(const ContactLaws& laws, const ParticleState& particles, bool walls);

/// Mass of a sphere [kg] from its radius [m] and density [kg/m³].
double sphere_mass(double radius, double density);

}  // namespace fluxpact
