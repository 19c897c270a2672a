// Who may touch whom until a particle has moved by half a skin, with the springs of each contact in
// place. Remade between two sub-steps when that has happened; springs of lasting contacts are
// carried over.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dem_server/backends/native/contact_law.hpp"
#include "dem_server/backends/native/spheres.hpp"
#include "dem_server/backends/native/springs.hpp"
#include "dem_server/backends/native/surface_contacts.hpp"
#include "dem_server/backends/size_levels.hpp"

namespace fluxpact {

/// A pair of neighbours, held by one of the two.
struct Pair {
  std::int32_t other = 0;   ///< the partner's place; in its block for an inner pair
  std::uint16_t mine = 0;   ///< place of the holder in its block
  std::uint8_t shift = 13;  ///< periods to add to the partner's position (Shift)
  std::uint8_t law = 0;     ///< row of the table of laws
};

/// A particle near one of the plane sides of the domain.
struct NearPlane {
  std::uint16_t mine = 0;
  std::uint8_t side = 0;
  std::uint8_t law = 0;
};

/// The contacts of the particles of one block, each list ascending by the holder.
///
/// An inner pair joins two particles of the block and is held once. A pair of two blocks, or across
/// a periodic side, is held by both: each computes the force on its own, and since the arithmetic
/// is that of a mirror image the two forces are opposite to the last bit. So a block needs nothing
/// of another but positions and velocities.
template <class Real>
struct ContactBlock {
  std::vector<Pair> inner;
  std::vector<Pair> outer;  ///< partner in another block
  std::vector<Pair> image;  ///< across a periodic side
  std::vector<NearPlane> planes;
  PairSprings<Real> inner_springs, outer_springs, image_springs;
  Springs<Real> plane_springs;
  std::vector<int> partners;  ///< other blocks, and itself across a side, whose particles it reads
  SurfaceContacts<Real> surfaces;
};

/// Where a particle was when the list was made: [m] from an origin. Float is enough, since the
/// reach that is left to a particle allows for its rounding.
struct alignas(16) ListedAt {
  float offset[4];
};

/// The contact list and the order of the particles for which it holds.
template <class Real>
struct ContactList {
  Blocks blocks;
  std::vector<ContactBlock<Real>> block;
  std::vector<int> row;     ///< of each place: row of the presented state, which is ascending by id
  double time = 0;          ///< [s] when it was made
  Vector3 origin{0, 0, 0};  ///< [m] of listed_at
  double reach = 0;         ///< [m] that a particle may move before the list is remade
  HugeVector<ListedAt> listed_at;
};

/// What stays the same for all lists of an engine.
struct ContactScope {
  const Domain& domain;
  const Walls& walls;
  std::span<const int> surface_materials;
  const ContactLaws& laws;
  double skin = 0;            ///< [m]
  double beyond_contact = 0;  ///< [m] that a law reaches beyond touching surfaces
  int threads = 1;
};

/// Where each particle came from when it was sorted anew.
struct Resorting {
  std::span<const int> previous;  ///< its place before; -1: it was not there
  /// Subtracted from its position to wrap it; none in a domain that is not periodic.
  std::span<const std::array<std::int8_t, 3>> periods;
};

/// The pairs that a thread has just found, before they take no more room than they need.
struct FoundPairs {
  std::vector<Pair> inner, outer, image;
};

/// Make `list` for spheres that `levels` has sorted: its blocks and rows are set already.
/// `material` of each presented row. Springs of pairs that `before` (the list in the previous
/// order, or nullptr) holds are carried over. `found`: room for each thread.
template <class Real, bool turning>
void make_contact_list(const ContactScope& scope, std::span<const Body<Real, turning>> spheres,
                       const std::vector<int>& material, const SizeLevels& levels,
                       const Resorting& resorting, ContactList<Real>* before,
                       std::vector<FoundPairs>& found, ContactList<Real>& list);

/// Fill in whose particles a block reads.
template <class Real>
void find_partners(const Blocks& blocks, ContactBlock<Real>& block);

}  // namespace fluxpact
