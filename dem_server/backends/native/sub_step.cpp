#include "dem_server/backends/native/sub_step.hpp"

#include <cmath>

#include "dem_server/backends/native/contact_force.hpp"

namespace fluxpact {
namespace {

// ---- contact
// ------------------------------------------------------------------------------------------

template <bool friction>
void add(const Load& from, double sign, Load& to) {
  for (int a = 0; a < 3; ++a) to.force[a] += sign * from.force[a];
  // Equal, not opposite: the arm points the other way for the partner, and so does the force.
  if constexpr (friction) {
    for (int a = 0; a < 3; ++a) to.lever_force[a] += from.lever_force[a];
  }
}

/// One pair. False if the spheres do not touch; `load` is written only if they do.
template <bool friction>
bool pair_contact(const Spheres& spheres, int i, const PairSlot& slot, const ContactLaws& laws,
                  const Vector3* shifts, double time_step, Spring* spring, Load& load) {
  const Body& a = spheres.body[i];
  const Body& b = spheres.body[slot.other];
  Touch touch;
  double square = 0;
  for (int x = 0; x < 3; ++x) {
    touch.normal[x] = a.position[x] - b.position[x];
    if (shifts != nullptr) touch.normal[x] -= shifts[slot.shift][x];
    square += touch.normal[x] * touch.normal[x];
  }
  const double sum = a.radius + b.radius;
  if (square >= sum * sum) {
    if constexpr (friction) *spring = {};
    return false;
  }
  const double distance = std::sqrt(square);
  touch.overlap = sum - distance;
  const double inverse = 1.0 / distance;
  for (int x = 0; x < 3; ++x) {
    touch.normal[x] *= inverse;
    touch.velocity[x] = a.velocity[x] - b.velocity[x];
    if constexpr (friction) {
      touch.radius_spin[x] =
          a.radius * spheres.spin[i].rate[x] + b.radius * spheres.spin[slot.other].rate[x];
    }
  }
  add_contact<friction>(touch, laws[slot.law], slot.damping, time_step, spring, load);
  return true;
}

template <bool friction>
void wall_contacts(const StepContext& context, double time_step, ContactBlock& block,
                   Spheres& spheres) {
  for (std::size_t w = 0; w < block.walls.size(); ++w) {
    const WallSlot& slot = block.walls[w];
    const Body& body = spheres.body[slot.particle];
    const int axis = slot.side / 2;
    const double inward = slot.side % 2 == 0 ? 1.0 : -1.0;
    Touch touch{};
    touch.overlap = body.radius - inward * (body.position[axis] - context.domain.plane(slot.side));
    if (touch.overlap <= 0) {
      if constexpr (friction) block.wall_springs[w] = {};
      continue;
    }
    touch.normal[axis] = inward;
    for (int x = 0; x < 3; ++x) {
      touch.velocity[x] = body.velocity[x];
      if constexpr (friction) {
        touch.radius_spin[x] = body.radius * spheres.spin[slot.particle].rate[x];
      }
    }
    Load load{};
    add_contact<friction>(touch, context.laws[slot.law], slot.damping, time_step,
                          friction ? &block.wall_springs[w] : nullptr, load);
    add<friction>(load, 1.0, spheres.load[slot.particle]);
  }
}

template <bool friction>
void block_contacts(const StepContext& context, int index, const Vector3* shifts, double time_step,
                    ContactBlock& block, std::span<Load> outbox, Spheres& spheres) {
  const int first = context.blocks.first(index);
  const int last = context.blocks.last(index);
  for (int i = first; i < last; ++i) spheres.load[i] = {};
  int place = block.outbox_first;
  for (int i = first; i < last; ++i) {
    Load own{};
    Load load{};
    const int remote = block.remote_first[i - first];
    for (int s = block.row_first[i - first]; s < block.row_first[i - first + 1]; ++s) {
      Spring* spring = friction ? &block.pair_springs[s] : nullptr;
      const bool touching = pair_contact<friction>(spheres, i, block.pairs[s], context.laws, shifts,
                                                   time_step, spring, load);
      if (touching) add<friction>(load, 1.0, own);
      if (s < remote) {
        if (touching) add<friction>(load, -1.0, spheres.load[block.pairs[s].other]);
      } else {
        outbox[place] = {};
        if (touching) add<friction>(load, -1.0, outbox[place]);
        ++place;
      }
    }
    add<friction>(own, 1.0, spheres.load[i]);
  }
  wall_contacts<friction>(context, time_step, block, spheres);
}

// ---- motion
// -------------------------------------------------------------------------------------------

template <bool friction>
Load gathered(const Load& own, int i, const ContactList& list, std::span<const Load> outbox) {
  Load load = own;
  for (int k = list.inbox_first[i]; k < list.inbox_first[i + 1]; ++k) {
    add<friction>(outbox[list.inbox[k]], 1.0, load);
  }
  return load;
}

template <bool friction>
void kick(const Load& load, const Vector3& drive, double time_step, int i, Spheres& spheres) {
  Body& body = spheres.body[i];
  for (int a = 0; a < 3; ++a) {
    body.velocity[a] += time_step * (load.force[a] * body.inverse_mass + drive[a]);
  }
  if constexpr (friction) {
    Spin& spin = spheres.spin[i];
    const double factor = time_step * body.radius * spin.inverse_inertia;
    for (int a = 0; a < 3; ++a) spin.rate[a] += factor * load.lever_force[a];
  }
}

template <bool friction, Kick which>
bool move_block(const StepContext& context, int index, double time_step, double reach,
                const ContactList& list, std::span<const Load> outbox, Spheres& spheres) {
  bool beyond = false;
  for (int i = context.blocks.first(index); i < context.blocks.last(index); ++i) {
    if constexpr (which == Kick::full) {
      kick<friction>(gathered<friction>(spheres.load[i], i, list, outbox), context.drive[i],
                     time_step, i, spheres);
    } else {
      kick<friction>(spheres.load[i], context.drive[i], 0.5 * time_step, i, spheres);
    }
    Body& body = spheres.body[i];
    double square = 0;
    for (int a = 0; a < 3; ++a) {
      body.position[a] += time_step * body.velocity[a];
      const double moved = body.position[a] - spheres.listed_at[i][a];
      square += moved * moved;
    }
    beyond |= !(square <= reach * reach);  // this way round it is true for NaN
  }
  return beyond;
}

template <bool friction>
bool move_all(const StepContext& context, Kick which, double time_step, double reach,
              const ContactList& list, std::span<const Load> outbox, Spheres& spheres) {
  bool beyond = false;
#pragma omp parallel for num_threads(context.threads) schedule(static) reduction(|| : beyond)
  for (int b = 0; b < context.blocks.count(); ++b) {
    const bool one =
        which == Kick::full
            ? move_block<friction, Kick::full>(context, b, time_step, reach, list, outbox, spheres)
            : move_block<friction, Kick::half>(context, b, time_step, reach, list, outbox, spheres);
    beyond = beyond || one;
  }
  return beyond;
}

template <bool friction>
void contact_all(const StepContext& context, double time_step, ContactList& list,
                 std::span<Load> outbox, Spheres& spheres) {
#pragma omp parallel for num_threads(context.threads) schedule(static)
  for (int b = 0; b < context.blocks.count(); ++b) {
    block_contacts<friction>(context, b, context.shifts, time_step, list.blocks[b], outbox,
                             spheres);
  }
}

template <bool friction>
void settle_all(const StepContext& context, double time_step, const ContactList& list,
                std::span<const Load> outbox, Spheres& spheres) {
#pragma omp parallel for num_threads(context.threads) schedule(static)
  for (int b = 0; b < context.blocks.count(); ++b) {
    for (int i = context.blocks.first(b); i < context.blocks.last(b); ++i) {
      spheres.load[i] = gathered<friction>(spheres.load[i], i, list, outbox);
      kick<friction>(spheres.load[i], context.drive[i], 0.5 * time_step, i, spheres);
    }
  }
}

}  // namespace

bool move(const StepContext& context, Kick which, double time_step, double reach,
          const ContactList& list, std::span<const Load> outbox, Spheres& spheres) {
  return context.friction
             ? move_all<true>(context, which, time_step, reach, list, outbox, spheres)
             : move_all<false>(context, which, time_step, reach, list, outbox, spheres);
}

void add_contacts(const StepContext& context, double time_step, ContactList& list,
                  std::span<Load> outbox, Spheres& spheres) {
  if (context.friction) {
    contact_all<true>(context, time_step, list, outbox, spheres);
  } else {
    contact_all<false>(context, time_step, list, outbox, spheres);
  }
}

void settle(const StepContext& context, double time_step, const ContactList& list,
            std::span<const Load> outbox, Spheres& spheres) {
  if (context.friction) {
    settle_all<true>(context, time_step, list, outbox, spheres);
  } else {
    settle_all<false>(context, time_step, list, outbox, spheres);
  }
}

}  // namespace fluxpact
