// Particles that leave and enter between two windows.
#pragma once

#include "dem_server/backends/native/soft_spheres.hpp"

namespace fluxpact {

template <class Real, bool turning>
void SoftSpheres<Real, turning>::exchange(std::span<const int> leaving,
                                          const ParticleState& entering) {
  if (leaving.empty() && entering.size() == 0) return;
  if (!before_exchange_) before_exchange_ = BeforeExchange{presented_, sizes_};
  const ParticleState checked = checked_rows(entering, laws_.walls());
  Places places = take_out(leaving);
  exchange_rows(leaving, checked, presented_);
  put_in(checked, places);
  size_up();
  const int free = 3 - committed_ - candidate_;
  bodies_[free].resize(bodies_[candidate_].size());
  drive_.resize(bodies_[candidate_].size());
  // Who stays keeps its load; who enters touches nothing.
  sort_and_list(candidate_, free, places, true);
  HugeVector<LoadRow> sorted(candidate_loads_.size());
  for (std::size_t place = 0; place < sorted.size(); ++place) {
    sorted[place] = candidate_loads_[levels_.order()[place]];
  }
  candidate_loads_ = std::move(sorted);
  candidate_ = free;
  check(candidate_, 0, 0, 0);
  present(candidate_);
}

/// The candidate's bodies and loads without some rows, with the rows that the others have then.
template <class Real, bool turning>
Places SoftSpheres<Real, turning>::take_out(std::span<const int> leaving) {
  std::vector<int> row_now(presented_.size(), 0);
  for (const int row : leaving) row_now[row] = -1;
  int kept = 0;
  for (int& row : row_now) row = row < 0 ? -1 : kept++;
  Places places;
  HugeVector<BodyRow>& bodies = bodies_[candidate_];
  const std::vector<int>& row_of = lists_[list_].row;
  for (int place = 0; place < static_cast<int>(row_of.size()); ++place) {
    const int row = row_now[row_of[place]];
    if (row < 0) continue;
    bodies[places.row.size()] = bodies[place];
    candidate_loads_[places.row.size()] = candidate_loads_[place];
    places.row.push_back(row);
    places.previous.push_back(place);
  }
  bodies.resize(places.row.size());
  candidate_loads_.resize(places.row.size());
  return places;
}

/// Appends those that enter, which are the last rows already.
template <class Real, bool turning>
void SoftSpheres<Real, turning>::put_in(const ParticleState& entering, Places& places) {
  for (int row = presented_.size() - entering.size(); row < presented_.size(); ++row) {
    bodies_[candidate_].push_back(body_of(row));
    candidate_loads_.push_back({});
    places.row.push_back(row);
    places.previous.push_back(-1);
  }
}

}  // namespace fluxpact
