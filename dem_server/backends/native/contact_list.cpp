#include "dem_server/backends/native/contact_list.hpp"

#include <algorithm>

namespace fluxpact {
namespace {

/// Everything that the making of one list reads.
struct Sources {
  const ContactScope& scope;
  const Spheres& spheres;
  const Blocks& blocks;
  const CellGrid& grid;
  const Resorting& resorting;
  const ContactList* before;
  const Blocks& blocks_before;
  std::array<Vector3, 27> shifts;

  int material(int place) const { return scope.material_of_row[spheres.row[place]]; }
};

bool near(const Sources& from, int i, int j, int shift) {
  const Body& a = from.spheres.body[i];
  const Body& b = from.spheres.body[j];
  const Vector3& image = from.shifts[shift];
  double square = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double apart = a.position[axis] - (b.position[axis] + image[axis]);
    square += apart * apart;
  }
  const double reach = a.radius + b.radius + from.scope.skin;
  return square < reach * reach;
}

PairSlot make_pair(const Sources& from, int i, int j, int shift) {
  const int law = from.scope.laws.index(from.material(i), from.material(j));
  const double mass = 1.0 / (from.spheres.body[i].inverse_mass + from.spheres.body[j].inverse_mass);
  return {j, static_cast<std::uint16_t>(shift), static_cast<std::uint16_t>(law),
          damping_coefficient(from.scope.laws[law], mass)};
}

/// The spring of the pair (i, j, shift) if the block held it in row i, in places of the old order.
const Spring* find_spring(const ContactList& list, const Blocks& blocks, int i, int j, int shift) {
  const ContactBlock& block = list.blocks[blocks.holding(i)];
  const int row = i - blocks.first(blocks.holding(i));
  for (int slot = block.row_first[row]; slot < block.row_first[row + 1]; ++slot) {
    if (block.pairs[slot].other == j && block.pairs[slot].shift == shift) {
      return &block.pair_springs[slot];
    }
  }
  return nullptr;
}

/// The spring that a pair had in the list before, in its direction now; zero for a new pair.
Spring carried_spring(const Sources& from, int i, const PairSlot& slot) {
  if (from.before == nullptr) return {};
  const int j = slot.other;
  // Wrapping moved each particle by whole periods; the vector between the two stayed the same.
  std::array<int, 3> periods = Shift::periods(slot.shift);
  for (int axis = 0; axis < 3; ++axis) {
    periods[axis] += from.resorting.periods[i][axis] - from.resorting.periods[j][axis];
    if (periods[axis] < -1 || periods[axis] > 1) return {};  // no neighbours before
  }
  const int old_i = from.resorting.previous[i];
  const int old_j = from.resorting.previous[j];
  if (old_i < 0 || old_j < 0) return {};
  const int shift = Shift::code(periods[0], periods[1], periods[2]);
  const int reverse = Shift::code(-periods[0], -periods[1], -periods[2]);
  if (const Spring* held = find_spring(*from.before, from.blocks_before, old_i, old_j, shift)) {
    return *held;
  }
  if (const Spring* held = find_spring(*from.before, from.blocks_before, old_j, old_i, reverse)) {
    return {{-held->x[0], -held->x[1], -held->x[2]}};
  }
  return {};
}

void fill_pairs(const Sources& from, int index, ContactBlock& block) {
  const int first = from.blocks.first(index);
  const int last = from.blocks.last(index);
  block.row_first.clear();
  block.remote_first.clear();
  block.pairs.clear();
  block.remote_pairs = 0;
  block.row_first.push_back(0);
  for (int i = first; i < last; ++i) {
    const auto begin = static_cast<std::ptrdiff_t>(block.pairs.size());
    from.grid.visit_partners(i, [&](int j, int shift) {
      if (near(from, i, j, shift)) block.pairs.push_back(make_pair(from, i, j, shift));
    });
    const auto remote = std::stable_partition(
        block.pairs.begin() + begin, block.pairs.end(),
        [&](const PairSlot& slot) { return slot.other >= first && slot.other < last; });
    block.remote_first.push_back(static_cast<int>(remote - block.pairs.begin()));
    block.remote_pairs += static_cast<int>(block.pairs.end() - remote);
    block.row_first.push_back(static_cast<int>(block.pairs.size()));
  }
  block.pair_springs.clear();
  if (!from.scope.friction) return;
  for (int i = first; i < last; ++i) {
    for (int slot = block.row_first[i - first]; slot < block.row_first[i - first + 1]; ++slot) {
      block.pair_springs.push_back(carried_spring(from, i, block.pairs[slot]));
    }
  }
}

Spring carried_wall_spring(const Sources& from, const WallSlot& slot) {
  if (from.before == nullptr) return {};
  const int old = from.resorting.previous[slot.particle];
  if (old < 0) return {};
  const ContactBlock& block = from.before->blocks[from.blocks_before.holding(old)];
  auto held =
      std::lower_bound(block.walls.begin(), block.walls.end(), old,
                       [](const WallSlot& w, int particle) { return w.particle < particle; });
  for (; held != block.walls.end() && held->particle == old; ++held) {
    if (held->side == slot.side) return block.wall_springs[held - block.walls.begin()];
  }
  return {};
}

void fill_walls(const Sources& from, int index, ContactBlock& block) {
  block.walls.clear();
  block.wall_springs.clear();
  const Domain& domain = from.scope.domain;
  for (int i = from.blocks.first(index); i < from.blocks.last(index); ++i) {
    const Body& body = from.spheres.body[i];
    for (int side = 0; side < 6; ++side) {
      if (domain.sides[side] != SideKind::wall) continue;
      const double inward = side % 2 == 0 ? 1.0 : -1.0;
      const double distance = inward * (body.position[side / 2] - domain.plane(side));
      // The wall stands still, so half a skin is enough.
      if (!(distance < body.radius + 0.5 * from.scope.skin)) continue;
      const int law = from.scope.laws.index(from.material(i), from.scope.laws.walls());
      block.walls.push_back({i, static_cast<std::uint16_t>(side), static_cast<std::uint16_t>(law),
                             damping_coefficient(from.scope.laws[law], 1.0 / body.inverse_mass)});
      if (from.scope.friction) {
        block.wall_springs.push_back(carried_wall_spring(from, block.walls.back()));
      }
    }
  }
}

/// Give each pair that joins two blocks a place in the outbox, and each particle the list of the
/// places where reactions on it stand.
void connect_blocks(const Blocks& blocks, ContactList& list) {
  list.outbox_size = 0;
  list.inbox_first.assign(blocks.particles + 1, 0);
  const auto for_each_remote = [&](const auto& visit) {
    for (int b = 0; b < blocks.count(); ++b) {
      const ContactBlock& block = list.blocks[b];
      int place = block.outbox_first;
      for (std::size_t row = 0; row < block.remote_first.size(); ++row) {
        for (int s = block.remote_first[row]; s < block.row_first[row + 1]; ++s) {
          visit(block.pairs[s].other, place++);
        }
      }
    }
  };
  for (ContactBlock& block : list.blocks) {
    block.outbox_first = list.outbox_size;
    list.outbox_size += block.remote_pairs;
  }
  // Counting sort by partner; the second pass runs the starts up to the ends, which shifts them
  // back.
  for_each_remote([&](int other, int) { ++list.inbox_first[other + 1]; });
  for (int i = 0; i < blocks.particles; ++i) list.inbox_first[i + 1] += list.inbox_first[i];
  list.inbox.resize(list.outbox_size);
  for_each_remote([&](int other, int place) { list.inbox[list.inbox_first[other]++] = place; });
  for (int i = blocks.particles; i > 0; --i) list.inbox_first[i] = list.inbox_first[i - 1];
  list.inbox_first[0] = 0;
}

}  // namespace

void make_contact_list(const ContactScope& scope, const Spheres& spheres, const Blocks& blocks,
                       const CellGrid& grid, const Resorting& resorting, const ContactList* before,
                       const Blocks& blocks_before, ContactList& list) {
  const Sources from{scope,     spheres, blocks,        grid,
                     resorting, before,  blocks_before, shift_vectors(scope.domain)};
  list.blocks.resize(blocks.count());
#pragma omp parallel for num_threads(scope.threads) schedule(dynamic, 1)
  for (int b = 0; b < blocks.count(); ++b) {
    fill_pairs(from, b, list.blocks[b]);
    fill_walls(from, b, list.blocks[b]);
  }
  connect_blocks(blocks, list);
}

}  // namespace fluxpact
