// Who may touch whom until a particle has moved by half a skin, with the tangential spring of each
// contact in place. Remade between two sub-steps when that has happened; springs of lasting
// contacts are carried over.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "dem_server/backends/cell_grid.hpp"
#include "dem_server/backends/native/contact_law.hpp"
#include "dem_server/backends/native/spheres.hpp"

namespace fluxpact {

/// A pair of neighbours, held by one of the two (the particle in whose row it stands).
struct PairSlot {
  int other = 0;             ///< the partner's place
  std::uint16_t shift = 13;  ///< periods to add to the partner's position (Shift)
  std::uint16_t law = 0;     ///< index into ContactLaws
  double damping = 0;        ///< [kg/s] normal dashpot
};

struct WallSlot {
  int particle = 0;
  std::uint16_t side = 0;
  std::uint16_t law = 0;
  double damping = 0;  ///< [kg/s]
};

/// Elongation of the tangential spring of a contact [m], seen from the particle that holds the
/// slot.
struct Spring {
  double x[3];
};

/// The contacts held by the particles of one block. The pairs of particle i are
/// [row_first[i - first], remote_first[i - first]) with partners in the same block, then up to
/// row_first[i - first + 1] with partners elsewhere.
struct ContactBlock {
  std::vector<int> row_first;
  std::vector<int> remote_first;
  std::vector<PairSlot> pairs;
  std::vector<Spring> pair_springs;  ///< empty without friction
  std::vector<WallSlot> walls;       ///< ascending by particle, then side
  std::vector<Spring> wall_springs;
  int remote_pairs = 0;
  int outbox_first = 0;  ///< its first place in the outbox
};

/// The contact list. A reaction on a particle of another block goes through the outbox: the holder
/// writes it there, and the partner adds its own from `inbox` in a fixed order.
struct ContactList {
  std::vector<ContactBlock> blocks;
  std::vector<int> inbox_first;  ///< CSR by particle, into inbox
  std::vector<int> inbox;        ///< places in the outbox, ascending
  int outbox_size = 0;
};

/// What stays the same for all lists of an engine.
struct ContactScope {
  const Domain& domain;
  const ContactLaws& laws;
  const std::vector<int>& material_of_row;  ///< of the presented rows
  double skin;                              ///< [m]
  bool friction;
  int threads;
};

/// Where each particle came from when it was sorted anew.
struct Resorting {
  std::vector<int> previous;                        ///< its place before; -1: it has just entered
  std::vector<std::array<std::int8_t, 3>> periods;  ///< subtracted from its position to wrap it
};

/// Make `list` for the spheres as they are, sorted by `grid`. Springs of pairs that `before` (the
/// list in the previous order, in blocks of that time, or nullptr) holds are carried over.
void make_contact_list(const ContactScope& scope, const Spheres& spheres, const Blocks& blocks,
                       const CellGrid& grid, const Resorting& resorting, const ContactList* before,
                       const Blocks& blocks_before, ContactList& list);

}  // namespace fluxpact
