// Contacts with the walls that are no sides of the box: which elements of them are near a particle,
// found with the contact list, and where it touches them, found anew in every sub-step before the
// forces. A contact keeps its springs while the particle rolls from one facet to the next.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dem_server/backends/native/contact_law.hpp"
#include "dem_server/backends/native/spheres.hpp"
#include "dem_server/backends/native/springs.hpp"
#include "dem_server/walls/walls.hpp"

namespace fluxpact {

/// One place where a particle touches a surface, laid out for the kernel.
struct alignas(32) SurfaceTouch {
  double normal[4];    ///< unit vector from the wall; then the distance of the centre [m]
  double velocity[4];  ///< [m/s] of the wall there; then 0
  std::int32_t surface;
  std::int32_t feature;
  std::uint16_t mine;  ///< place of the particle in its block
  std::uint8_t law;    ///< row of the table of laws
};

/// Of the particles of one block.
template <class Real>
struct SurfaceContacts {
  std::vector<std::uint16_t> near;     ///< places in the block, ascending
  std::vector<std::uint8_t> material;  ///< of each
  std::vector<int> first_element;      ///< CSR into elements
  std::vector<int> elements;
  std::vector<SurfaceTouch> touches;  ///< of the newest positions, ascending by place
  Springs<Real> springs;
  std::vector<SurfaceTouch> former;  ///< of the sub-step before
  Springs<Real> former_springs;
  int lost = -1;  ///< place in the block of one that no surface holds any more
};

/// Where the touches of a particle stand: [first, last).
struct TouchRange {
  int first, last;
};
TouchRange touches_of(std::span<const SurfaceTouch> touches, int mine);

/// Fill the touches of a block whose particles, near the surfaces, are at `spheres` (of the block).
/// `materials`: of each surface. `beyond_contact` [m]: the reach of the law. Springs follow
/// (`rows_each` of each).
template <class Real, bool turning>
void find_touches(const Walls& walls, const ContactLaws& laws, std::span<const int> materials,
                  std::span<const Body<Real, turning>> spheres, double beyond_contact,
                  int rows_each, SurfaceContacts<Real>& contacts);

}  // namespace fluxpact
