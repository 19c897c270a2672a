// The scene in LIGGGHTS' own commands. Text only.
//
// Its dashpots are numbers of a pair of types (γ of γ m* v), and ours depend on the masses, too: a
// type for each kind of sphere of one material and mass, and one for the walls. LIGGGHTS wants the
// first type to be there always: that of the walls, which stay.
#pragma once

#include <string>
#include <vector>

#include "dem_server/backends/domain.hpp"
#include "dem_server/backends/native/contact_law.hpp"
#include "dem_server/backends/particle_engine.hpp"

namespace fluxpact {

/// Spheres that have one law with every other kind.
struct SphereKind {
  int material = 0;
  double mass = 0;  ///< [kg]
  bool fixed = false;

  bool operator==(const SphereKind&) const = default;
};

/// As many as LIGGGHTS can be told of in one line of its commands.
inline constexpr int most_kinds = 8;

SphereKind kind_of(const ParticleState& spheres, int row);

/// One sphere of each kind that particles.inflow brings.
ParticleState spheres_to_come(const Scene& scene);

/// Adds the kinds of these spheres that are not there yet. Throws ConfigError for more than
/// most_kinds, and for more than one where there are no walls.
void add_kinds(const ParticleState& spheres, bool walls, std::vector<SphereKind>& kinds);

/// The type of the first kind; the others follow it.
inline int first_type(bool walls) { return walls ? 2 : 1; }

/// All that LIGGGHTS is told before the first spheres come.
std::vector<std::string> liggghts_script(const Domain& domain, const ContactLaws& laws,
                                         const Vector3& gravity, const ParticleState& spheres,
                                         const std::vector<SphereKind>& kinds);

}  // namespace fluxpact
