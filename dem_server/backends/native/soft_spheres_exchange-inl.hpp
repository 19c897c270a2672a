// Particles that leave and enter between two windows.
#pragma once

#include "dem_server/backends/native/soft_spheres.hpp"
#include "dem_server/backends/native/soft_spheres_lists-inl.hpp"
#include "dem_server/backends/native/soft_spheres_setup-inl.hpp"

namespace fluxpact {

template <class Real, bool turning>
void SoftSpheres<Real, turning>::exchange(std::span<const int> leaving,
                                          const ParticleState& entering) {
  if (leaving.empty() && entering.size() == 0) return;
  if (!before_exchange_) {
    before_exchange_ = BeforeExchange{presented_, sizes_};
    if (swapped_) give_committed(before_exchange_->presented);
    take_back_motion();
  }
  const ParticleState checked = as_held<Real>(checked_rows(entering, laws_.walls()));
  Places places = take_out(leaving);
  exchange_rows(leaving, checked, presented_);
  put_in(checked, places);
  size_up();
  // Who stays keeps its load; who enters touches nothing.
  sort_and_list(&places, true);
  sort_in_place(levels_.order(), moved_, loads_);
  check(0, 0, 0);
  present();
}

/// Bodies and loads without some rows, with the rows that the others have then.
template <class Real, bool turning>
Places SoftSpheres<Real, turning>::take_out(std::span<const int> leaving) {
  std::vector<int> row_now(presented_.size(), 0);
  for (const int row : leaving) row_now[row] = -1;
  int kept = 0;
  for (int& row : row_now) row = row < 0 ? -1 : kept++;
  Places places;
  const std::vector<int>& row_of = lists_[list_].row;
  for (int place = 0; place < static_cast<int>(row_of.size()); ++place) {
    const int row = row_now[row_of[place]];
    if (row < 0) continue;
    bodies_[places.row.size()] = bodies_[place];
    loads_[places.row.size()] = loads_[place];
    places.row.push_back(row);
    places.previous.push_back(place);
  }
  bodies_.resize(places.row.size());
  loads_.resize(places.row.size());
  return places;
}

/// Appends those that enter, which are the last rows already.
template <class Real, bool turning>
void SoftSpheres<Real, turning>::put_in(const ParticleState& entering, Places& places) {
  for (int row = presented_.size() - entering.size(); row < presented_.size(); ++row) {
    bodies_.push_back(body_of(row));
    loads_.push_back({});
    places.row.push_back(row);
    places.previous.push_back(-1);
  }
}

}  // namespace fluxpact
