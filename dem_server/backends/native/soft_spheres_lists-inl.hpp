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

/// Move what has left through periodic sides by whole periods.
template <class Real, bool turning>
void SoftSpheres<Real, turning>::wrap(HugeVector<BodyRow>& bodies) {
  const int count = static_cast<int>(bodies.size());
  resorting_.periods.assign(count, {});
  if (!any_periodic_) return;
  for (int i = 0; i < count; ++i) {
    Eigen::Map<Vector3> position(bodies[i].position);
    const Vector3 moved = wrapped(domain_, position);
    for (int axis = 0; axis < 3; ++axis) {
      const double apart = (position[axis] - moved[axis]) / domain_.length(axis);
      resorting_.periods[i][axis] = static_cast<std::int8_t>(std::lround(apart));
    }
    position = moved;
  }
}

/// The places of the list in use.
template <class Real, bool turning>
const Places& SoftSpheres<Real, turning>::kept_places() {
  kept_places_.row = lists_[list_].row;
  kept_places_.previous.resize(kept_places_.row.size());
  std::iota(kept_places_.previous.begin(), kept_places_.previous.end(), 0);
  return kept_places_;
}

/// Sort the rows of `from`, which are at `places`, into those of `to` and list anew.
template <class Real, bool turning>
void SoftSpheres<Real, turning>::sort_and_list(int from, int to, const Places& places,
                                               bool carry_springs) {
  HugeVector<BodyRow>& unsorted = bodies_[from];
  HugeVector<BodyRow>& sorted = bodies_[to];
  const int count = static_cast<int>(unsorted.size());
  wrap(unsorted);
  constexpr int stride = sizeof(BodyRow) / sizeof(double);
  const double* data = count > 0 ? unsorted.front().position : nullptr;
  levels_.sort(domain_, sizes_.skin + sizes_.beyond_contact, {data, stride, count},
               {data + 3, stride});

  int made = 0;
  while (made == list_ || (has_candidate_ && made == committed_list_)) ++made;
  const List& before = lists_[list_];
  List& list = lists_[made];
  list.blocks = blocks_of(count);
  list.row.resize(count);
  sorted.resize(count);
  drive_.resize(count);
  sorted_drive_.resize(count);
  resorting_.previous.resize(count);
  const std::vector<int>& order = levels_.order();
  sorted_periods_.resize(count);
#pragma omp parallel for num_threads(threads_) schedule(static)
  for (int place = 0; place < count; ++place) {
    sorted[place] = unsorted[order[place]];
    sorted_drive_[place] = drive_[order[place]];
    list.row[place] = places.row[order[place]];
    resorting_.previous[place] = places.previous[order[place]];
    sorted_periods_[place] = resorting_.periods[order[place]];
  }
  std::swap(drive_, sorted_drive_);
  resorting_.periods.swap(sorted_periods_);
  const ContactScope scope{
      domain_, walls_, surface_materials_, laws_, sizes_.skin, sizes_.beyond_contact, threads_};
  make_contact_list<Real, turning>(scope, sorted, presented_.material, levels_, resorting_,
                                   carry_springs ? &before : nullptr, list);
  list.time = placed_at_;
  list_ = made;
  check_surfaces();
  ++rebuilds_;
}

}  // namespace fluxpact
