// The fields that cross only because the scene's forces between the phases ask for them.
//
// Both sides and the coordinator read the same scene, so all three know what is on the wire: the
// coordinator refuses a participant that does not offer it in its hello, and passes it on. A scene
// that asks for none of these forces has none of these fields.
#pragma once

#include <string>
#include <vector>

#include "proto/scene/scene.hpp"

namespace fluxpact {

/// Names of fields with one row a cell.
struct AskedFields {
  std::vector<std::string> scalars;
  std::vector<std::string> vectors;
  bool empty() const { return scalars.empty() && vectors.empty(); }
};

/// What the fluid side gives beyond its usual fields: viscous_force, convective_acceleration,
/// vorticity, turbulent_energy, turbulent_dissipation.
AskedFields asked_of_fluid(const Scene& scene);

/// What the particle side gives beyond its usual fields: pressure_return.
AskedFields asked_of_particles(const Scene& scene);

/// All that can be asked for: for the hello of a participant that has them.
std::vector<std::string> all_asked_of_fluid();
std::vector<std::string> all_asked_of_particles();

}  // namespace fluxpact
