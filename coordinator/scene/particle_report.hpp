// What the user is told about the particles of a scene before anything runs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "proto/mesh/mesh.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// One line for each entry of particles.insertion and particles.inflow: count, mass and sizes as
/// the scene gives them; what only packing, settling or reading can tell is said to be so. Empty
/// without particles.
std::string particle_report(const Scene& scene, const Mesh& mesh);

/// Solid fraction [-] of an insertion's region, grown by `margin` [m] on each side. Nothing for
/// type file, and if settled to a height: their numbers are not known yet.
std::optional<double> solid_fraction(const InsertionSettings& entry, const Mesh& mesh,
                                     double margin);

/// What the scene leaves out although its numbers ask for it, one text for each: added mass where
/// the particles are less than ten times as dense as the fluid. `check` prints them, a run logs
/// them.
std::vector<std::string> particle_warnings(const Scene& scene);

}  // namespace fluxpact
