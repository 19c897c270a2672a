// How much of its slip a single sphere hides from itself: it has slowed down the fluid that it sees
// (docs/theory.md, section 3). Known before anything runs, from the scene's numbers.
#pragma once

#include <string>
#include <vector>

#include "proto/mesh/mesh.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// Share of the slip [-] that a sphere at the centre of a cube does not see with one of the maps
/// `exact`, `centroid`, `satellite`: ζ/(ζ + C), ζ = 3π μ d f the drag of Schiller and Naumann
/// (1933) at `reynolds` = ρ u d/μ, C = 3/2 (ρ u Δx² + 6 μ Δx) what the cell's fluid and its
/// neighbours carry away. Within a fifth of what was measured for cells of 5 diameters and more;
/// near a face it is up to three times less. `cells` = Δx/d.
double self_disturbance(double cells, double reynolds);

/// Width of a `kernel` or `diffusion` in diameters [-] that leaves half a per cent of the slip
/// unseen, if it is 4 cells or more and far from walls. C = 4.5 ρ u W² + 14 μ W: `kernel` was
/// measured to leave as much within a tenth where flow rules; less in narrow channels, and with
/// `diffusion`.
double wide_enough(double reynolds);

/// Particle Reynolds number [-] of a sphere that falls (or rises) through fluid at rest.
double terminal_reynolds(const FluidSettings& fluid, double gravity, double diameter,
                         double density);

/// One text if particles that are few (less than 1 % of their region and four cells around it)
/// would see more than 1 % too little of their slip, for the entry of particles.insertion with the
/// most. None without gravity, and for entries of type file or settled to a height, whose numbers
/// are not known yet. With self_disturbance: corrected one if there are entries whose particles are
/// not few.
std::vector<std::string> self_disturbance_warnings(const Scene& scene, const Mesh& mesh);

}  // namespace fluxpact
