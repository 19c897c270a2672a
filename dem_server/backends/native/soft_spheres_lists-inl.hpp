// The contact list made anew.
#pragma once

#include "dem_server/backends/native/soft_spheres.hpp"

namespace fluxpact {

/// Rows and loads of a block stay in a core's own cache; pairs between blocks cost double, so the
/// blocks are as large as that allows, but enough for some threads in small scenes.
inline constexpr int largest_block = 8192;
inline constexpr int least_blocks = 4;
inline constexpr int smallest_block = 128;

inline Blocks blocks_of(int particles) {
  return {particles, std::clamp(particles / least_blocks, smallest_block, largest_block)};
}

/// rows[place] is what was rows[order[place]], without a second array.
template <class Rows>
void sort_in_place(const std::vector<int>& order, std::vector<bool>& moved, Rows& rows) {
  const int count = static_cast<int>(order.size());
  moved.assign(count, false);
  for (int start = 0; start < count; ++start) {
    if (moved[start]) continue;
    const auto first = rows[start];
    int place = start;
    for (int from = order[place]; from != start; from = order[place]) {
      rows[place] = rows[from];
      moved[place] = true;
      place = from;
    }
    rows[place] = first;
    moved[place] = true;
  }
}

/// Move what has left through periodic sides by whole periods.
template <class Real, bool turning>
void SoftSpheres<Real, turning>::wrap() {
  if (!any_periodic_) return;
  const int count = static_cast<int>(bodies_.size());
  periods_.assign(count, {});
  for (int i = 0; i < count; ++i) {
    Eigen::Map<Vector3> position(bodies_[i].position);
    const Vector3 moved = wrapped(domain_, position);
    for (int axis = 0; axis < 3; ++axis) {
      const double apart = (position[axis] - moved[axis]) / domain_.length(axis);
      periods_[i][axis] = static_cast<std::int8_t>(std::lround(apart));
    }
    position = moved;
  }
}

/// Sort the bodies, which are at `places` (nullptr: those of the list in use), and list anew.
template <class Real, bool turning>
void SoftSpheres<Real, turning>::sort_and_list(const Places* places, bool carry_springs) {
  const int count = static_cast<int>(bodies_.size());
  wrap();
  constexpr int stride = sizeof(BodyRow) / sizeof(double);
  const double* data = count > 0 ? bodies_.front().position : nullptr;
  levels_.sort(domain_, 2 * sizes_.slack.least + sizes_.beyond_contact, {data, stride, count},
               {data + 3, stride});
  const std::vector<int>& order = levels_.order();
  sort_in_place(order, moved_, bodies_);
  if (any_periodic_) sort_in_place(order, moved_, periods_);

  int made = 0;
  while (made == list_ || (has_candidate_ && made == committed_list_)) ++made;
  List& before = lists_[list_];
  List& list = lists_[made];
  list.blocks = blocks_of(count);
  list.row.resize(count);
  const std::vector<int>& row = places != nullptr ? places->row : before.row;
  for (int place = 0; place < count; ++place) list.row[place] = row[order[place]];
  std::vector<int> previous;
  if (places != nullptr) {
    for (const int place : order) previous.push_back(places->previous[place]);
  }
  const ContactScope scope{domain_,
                           walls_,
                           surface_materials_,
                           laws_,
                           law_table_.one_law,
                           sizes_.slack,
                           sizes_.beyond_contact,
                           threads_};
  make_contact_list<Real, turning>(scope, bodies_, presented_.material, levels_,
                                   {places != nullptr ? previous : order, periods_},
                                   carry_springs ? &before : nullptr, making_, list);
  list.time = placed_at_;
  list_ = made;
  plan_turns();
  check_surfaces();
  ++rebuilds_;
}

template <class Real, bool turning>
void SoftSpheres<Real, turning>::plan_turns() {
  const List& list = lists_[list_];
  kicks_.resize(list.blocks.count(), 0);
  searches_.resize(threads_);
  turns_.plan(list.blocks.count(), threads_for(list.blocks),
              [&](int block) -> const std::vector<int>& { return list.block[block].partners; });
}

}  // namespace fluxpact
