// One sub-step of one block of particles, in vector registers: the forces of all its contacts, then
// its velocities and positions. The hot loop of the whole program; the instruction set is chosen
// when it runs.
//
//   start   half a kick with the loads of the window before, then a drift
//   drift   contacts at the new positions, a whole kick, a drift
//   settle  contacts, half a kick: positions and velocities are at the same time; loads are kept
//
// Blocks move in place. The contacts of a block read the positions and velocities of its
// neighbours, so a block moves once all who read it have their forces (block_turns.hpp).
#pragma once

#include "dem_server/backends/native/contact_list.hpp"

// The steps of a batch of contacts are inlined for speed (5 %). Under sanitizers the one large
// function that this makes takes a quarter of an hour to compile.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define FLUXPACT_CONTACT_STEP HWY_NOINLINE
#else
#define FLUXPACT_CONTACT_STEP HWY_INLINE
#endif

namespace fluxpact {

enum class Phase { start, drift, settle };

/// Roots of effective masses [kg^0.5] where they are the same for all contacts; 0 where they are
/// not.
struct RootMasses {
  double pair = 0;
  double wall = 0;
};

template <class Real, bool turning>
struct BlockPass {
  Phase phase = Phase::start;
  double time_step = 0;    ///< [s]
  double spring_step = 0;  ///< [s] by which the springs grow
  int first = 0;           ///< particles of the block
  int last = 0;
  Body<Real, turning>* bodies = nullptr;                ///< all particles
  Body<Real, turning>* own = nullptr;                   ///< those of the block, which move
  const KeptLoad<Real, turning>* kept_loads = nullptr;  ///< start: of the window before
  KeptLoad<Real, turning>* loads = nullptr;  ///< drives in place of forces; settle: rows of the
                                             ///< block become loads
  Load<Real, turning>* sum = nullptr;        ///< the loads of the block: summed up, then moved by
  const ListedAt* listed_at = nullptr;
  const double* origin = nullptr;  ///< [m] of listed_at
  double reach = 0;                ///< [m] from listed_at, beyond which the list may miss a contact
  ContactBlock<Real>* contacts = nullptr;
  const double (*shifts)[4] = nullptr;  ///< [m] displacement of each Shift
  const double (*planes)[4] =
      nullptr;  ///< of each side: unit normal into the domain, n·x on it [m]
  const LawTable<Real>* laws = nullptr;
  double beyond_contact = 0;  ///< [m] that a law reaches beyond touching surfaces
  RootMasses root_masses;
  double kick = 0;        ///< [m/s] at most, of a particle and a partner together, since they met
  double usual_room = 0;  ///< [m] of CloseBudget
  CloseSearch<Real>* search = nullptr;  ///< of the thread
};

/// Sums up the forces of the contacts of the block (not at the start).
void sum_contacts(const BlockPass<double, false>& pass);
void sum_contacts(const BlockPass<double, true>& pass);
void sum_contacts(const BlockPass<float, false>& pass);
void sum_contacts(const BlockPass<float, true>& pass);

struct Moved {
  bool beyond = false;  ///< some particle is farther than `reach` from where the list was made, or
                        ///< not finite
  double kick = 0;      ///< [m/s] at most, of a particle of the block
};

/// Kick and drift by those sums.
Moved move_block(const BlockPass<double, false>& pass);
Moved move_block(const BlockPass<double, true>& pass);
Moved move_block(const BlockPass<float, false>& pass);
Moved move_block(const BlockPass<float, true>& pass);

}  // namespace fluxpact
