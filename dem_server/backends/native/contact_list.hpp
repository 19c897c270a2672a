// Who may touch whom until a particle has moved farther than its slack, with the springs of each
// contact in place. Remade between two sub-steps when that has happened; springs of lasting
// contacts are carried over.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dem_server/backends/native/close_pairs.hpp"
#include "dem_server/backends/native/contact_law.hpp"
#include "dem_server/backends/native/spheres.hpp"
#include "dem_server/backends/native/springs.hpp"
#include "dem_server/backends/native/surface_contacts.hpp"
#include "dem_server/backends/size_levels.hpp"

namespace fluxpact {

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
  InnerList inner;
  OuterList outer;  ///< partner in another block
  OuterList image;  ///< across a periodic side
  std::vector<NearPlane> planes;
  ClosePairs<Real> inner_close, outer_close, image_close;
  CloseBudget budget;  ///< of those
  Springs<Real> plane_springs;
  std::vector<int> partners;  ///< other blocks, and itself across a side, whose particles it reads
  SurfaceContacts<Real> surfaces;
};

/// Where a particle was when the list was made: [m] from an origin. Float is enough, since the
/// reach that is left to a particle allows for its rounding. The last number stands in line with
/// the radius in a row of positions and is the larger the less the particle may move: the square of
/// the difference of the two rows is below that of the list's `reach` as long as it may. While the
/// list is made, that number is the slack of the particle [m].
struct alignas(16) ListedAt {
  float offset[4];
};

/// How far a particle may move before the list is made anew: as it would in `flight` [s], but not
/// less nor more than so much [m]. So a few fast ones make no new list for all.
struct Slack {
  double least = 0;
  double most = 0;
  double flight = 0;
};

/// The contact list and the order of the particles for which it holds.
template <class Real>
struct ContactList {
  Blocks blocks;
  std::vector<ContactBlock<Real>> block;
  std::vector<int> row;     ///< of each place: row of the presented state, which is ascending by id
  double time = 0;          ///< [s] when it was made
  Vector3 origin{0, 0, 0};  ///< [m] of listed_at
  double reach = 0;         ///< [m] that the fastest may move before the list is remade
  HugeVector<ListedAt> listed_at;
};

/// What stays the same for all lists of an engine.
struct ContactScope {
  const Domain& domain;
  const Walls& walls;
  std::span<const int> surface_materials;
  const ContactLaws& laws;
  bool one_law = false;  ///< all contacts have the same
  Slack slack;
  double beyond_contact = 0;  ///< [m] that a law reaches beyond touching surfaces
  int threads = 1;
};

/// Where each particle came from when it was sorted anew.
struct Resorting {
  std::span<const int> previous;  ///< its place before; -1: it was not there
  /// Subtracted from its position to wrap it; none in a domain that is not periodic.
  std::span<const std::array<std::int8_t, 3>> periods;
};

/// The springs of the pairs of a block.
template <class Real>
struct BlockSprings {
  PairSprings<Real> inner, outer, image;

  void take(const ContactBlock<Real>& block) {
    block.inner_close.take_springs(inner);
    block.outer_close.take_springs(outer);
    block.image_close.take_springs(image);
  }
  void bring_back(ContactBlock<Real>& block) const {
    std::vector<std::int32_t> room;
    block.inner_close.bring_back(block.inner, inner, room);
    block.outer_close.bring_back(block.outer, outer, room);
    block.image_close.bring_back(block.image, image, room);
  }
};

/// Pairs of one kind, as they are found.
struct FoundPairs {
  std::vector<Pair> listed;
  std::vector<std::int32_t> touching;  ///< places in `listed`: no others have springs

  void clear() {
    listed.clear();
    touching.clear();
  }
};

/// The springs of the list before, while one is made. Particles go from block to block, but few of
/// them, and into the next ones: so the springs of a block are taken when the first new block wants
/// them, and their room given on after the last.
template <class Real>
class FormerSprings {
 public:
  /// `previous` as in Resorting.
  void plan(const ContactList<Real>& before, const Blocks& blocks, std::span<const int> previous);
  /// Call before and after the pairs of block b are found, from any thread: its room of close pairs
  /// comes to it from the list before.
  void fetch(int b, ContactList<Real>& before, ContactList<Real>& list);
  void release(int b);
  /// Of a block of the list before, from which a particle of a block came that is being made.
  const BlockSprings<Real>& operator[](int former) const { return springs_[former]; }

 private:
  void take(int former, ContactList<Real>& before);

  std::vector<BlockSprings<Real>> springs_;  // by block of the list before
  std::vector<BlockSprings<Real>> free_;     // room that none of them has
  std::vector<char> taken_;                  // by block of the list before
  std::vector<int> readers_;                 // the same: new blocks that still want its springs
  std::vector<std::vector<int>> sources_;    // by new block: where its particles were
};

/// Room for the making of a list, kept so that it need not be found anew.
template <class Real>
struct ListMaking {
  struct Found {  // what a thread has just found, before it takes no more room than it needs
    FoundPairs inner, outer, image;
    PairSprings<Real> springs;
    std::vector<std::int32_t> places;
    std::vector<int> near;
  };
  std::vector<Found> found;  // by thread
  FormerSprings<Real> springs;
};

/// Make `list` for spheres that `levels` has sorted: its blocks and rows are set already.
/// `material` of each presented row. Springs of pairs that `before` (the list in the previous
/// order, or nullptr) holds are carried over, and so is the room of its close pairs.
template <class Real, bool turning>
void make_contact_list(const ContactScope& scope, std::span<const Body<Real, turning>> spheres,
                       const std::vector<int>& material, const SizeLevels& levels,
                       const Resorting& resorting, ContactList<Real>* before,
                       ListMaking<Real>& making, ContactList<Real>& list);

/// The room of the close pairs of one block, or list, to another.
template <class Real>
void swap_close_pairs(ContactBlock<Real>& a, ContactBlock<Real>& b) {
  std::swap(a.inner_close, b.inner_close);
  std::swap(a.outer_close, b.outer_close);
  std::swap(a.image_close, b.image_close);
}
template <class Real>
void swap_close_pairs(ContactList<Real>& a, ContactList<Real>& b) {
  for (std::size_t k = 0; k < std::min(a.block.size(), b.block.size()); ++k) {
    swap_close_pairs(a.block[k], b.block[k]);
  }
}

/// Fill in whose particles a block reads.
template <class Real>
void find_partners(const Blocks& blocks, ContactBlock<Real>& block);

}  // namespace fluxpact
