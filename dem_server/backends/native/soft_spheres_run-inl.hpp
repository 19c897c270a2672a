// One window: sub-steps, checks, committed and candidate state.
#pragma once

#include "dem_server/backends/native/soft_spheres.hpp"

namespace fluxpact {

template <class Real, bool turning>
void SoftSpheres<Real, turning>::set_drive(std::span<const Vector3> force) {
  const int count = presented_.size();
  if (static_cast<int>(force.size()) != count) {
    throw NumericsError("force on the particles: {} rows for {} particles", force.size(), count);
  }
  drive_.resize(count);
  int bad = count;
#pragma omp parallel for num_threads(threads_) schedule(static) reduction(min : bad)
  for (int i = 0; i < count; ++i) {
    const int row = lists_[list_].row[i];
    const double inverse_mass = static_cast<double>(bodies_[committed_][i].inverse_mass);
    const Vector3 fall = inverse_mass > 0 ? gravity_ : Vector3(Vector3::Zero());
    const Vector3 drive = fall + force[row] * inverse_mass;
    for (int axis = 0; axis < 3; ++axis) {
      drive_[i].acceleration[axis] = static_cast<Real>(drive[axis]);
    }
    if (!drive.allFinite()) bad = std::min(bad, row);
  }
  if (bad < count) refuse_force(presented_.id[bad], force[bad]);
}

/// One phase of all blocks. True if the list must be made anew.
template <class Real, bool turning>
bool SoftSpheres<Real, turning>::sweep(Phase phase, double time_step, double spring_step, int from,
                                       int to, HugeVector<LoadRow>& loads) {
  List& list = lists_[list_];
  const Blocks& blocks = list.blocks;
  const int threads = threads_for(blocks);
  sums_.resize(static_cast<std::size_t>(threads) * blocks.block_size);
  BlockPass<Real, turning> all;
  all.phase = phase;
  all.time_step = time_step;
  all.spring_step = spring_step;
  all.now = bodies_[from].data();
  all.next = bodies_[to].data();
  all.load = loads.data();
  all.drive = drive_.data();
  all.listed_at = list.listed_at.data();
  all.origin = list.origin.data();
  all.reach = list.reach;
  all.shifts = shifts_.data();
  all.planes = planes_.data();
  all.laws = &law_table_;
  all.beyond_contact = sizes_.beyond_contact;
  all.root_masses = sizes_.root_masses;
  bool beyond = false;
#pragma omp parallel for num_threads(threads) schedule(static) reduction(|| : beyond)
  for (int b = 0; b < blocks.count(); ++b) {
    BlockPass<Real, turning> pass = all;
    pass.first = blocks.first(b);
    pass.last = blocks.last(b);
    pass.sum = sums_.data() + static_cast<std::ptrdiff_t>(omp_get_thread_num()) * blocks.block_size;
    pass.contacts = &list.block[b];
    if (!walls_.empty() && phase != Phase::start) {
      find_touches<Real, turning>(
          walls_, laws_, surface_materials_, {pass.now + pass.first, pass.now + pass.last},
          sizes_.beyond_contact, spring_rows(laws_.model()), pass.contacts->surfaces);
    }
    const bool one = pass_block(pass);
    beyond = beyond || one;
  }
  return beyond;
}

template <class Real, bool turning>
void SoftSpheres<Real, turning>::advance(double window, int sub_steps,
                                         std::span<const Vector3> force, const Progress& progress) {
  if (has_candidate_) rollback();
  const double time_step = window / sub_steps;
  // Contacts by Hertz' law are the shorter the faster they are.
  if (laws_.model().law == ContactLaw::hertz) {
    sizes_.limit = step_limit(laws_, presented_, walls_present_);
  }
  check_time_step(sizes_.limit, time_step);
  set_drive(force);
  save_springs();
  has_candidate_ = true;
  int now = (committed_ + 1) % 3;
  int next = (committed_ + 2) % 3;
  bodies_[now].resize(bodies_[committed_].size());
  bodies_[next].resize(bodies_[committed_].size());
  candidate_loads_.resize(loads_.size());
  bool beyond = sweep(Phase::start, time_step, 0, committed_, now, loads_);
  for (int step = 1; step <= sub_steps; ++step) {
    place_walls(time_ + step * time_step);
    if (beyond || walls_moved_far()) {
      check(now, time_step, step, sub_steps);
      check_surfaces();  // what this list has noted would go with it
      sort_and_list(now, next, kept_places(), true);
      std::swap(now, next);
    }
    const Phase phase = step < sub_steps ? Phase::drift : Phase::settle;
    beyond = sweep(phase, time_step, time_step, now, next, candidate_loads_);
    std::swap(now, next);
    if (progress) progress();
  }
  candidate_ = now;
  window_ = window;
  sub_steps_ += sub_steps;
  check(candidate_, time_step, sub_steps, sub_steps);
  check_surfaces();
  present(candidate_);
}

template <class Real, bool turning>
void SoftSpheres<Real, turning>::commit() {
  if (!has_candidate_) return;
  has_candidate_ = false;
  committed_ = candidate_;
  committed_list_ = list_;
  time_ += window_;
  std::swap(loads_, candidate_loads_);
  before_exchange_.reset();
}

template <class Real, bool turning>
void SoftSpheres<Real, turning>::check(int bodies, double time_step, int sub_step,
                                       int sub_steps) const {
  const HugeVector<BodyRow>& rows = bodies_[bodies];
  const std::vector<int>& row_of = lists_[list_].row;
  const int none = presented_.size();
  const bool may_touch = std::isfinite(sizes_.limit.longest);
  int bad = none;
  const auto motion = [&](int i) {
    const Real* v = rows[i].velocity;
    return Motion{
        Eigen::Map<const Vector3>(rows[i].position),
        Vector3(static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])),
        rows[i].radius};
  };
#pragma omp parallel for num_threads(threads_) schedule(static) reduction(min : bad)
  for (int i = 0; i < none; ++i) {
    if (!is_sound(domain_, motion(i), may_touch ? time_step : 0)) bad = std::min(bad, row_of[i]);
  }
  if (bad == none) return;
  const auto at = std::find(row_of.begin(), row_of.end(), bad) - row_of.begin();
  refuse(domain_, presented_.id[bad], motion(static_cast<int>(at)),
         {time_step, sub_step, sub_steps});
}

template <class Real, bool turning>
void SoftSpheres<Real, turning>::present(int bodies) {
  const HugeVector<BodyRow>& rows = bodies_[bodies];
  const List& list = lists_[list_];
#pragma omp parallel for num_threads(threads_) schedule(static)
  for (int i = 0; i < presented_.size(); ++i) {
    const BodyRow& body = rows[i];
    const int row = list.row[i];
    const Eigen::Map<const Vector3> position(body.position);
    presented_.position[row] = any_periodic_ ? wrapped(domain_, position) : Vector3(position);
    for (int axis = 0; axis < 3; ++axis) {
      presented_.velocity[row][axis] = static_cast<double>(body.velocity[axis]);
      if constexpr (turning) {
        presented_.spin[row][axis] = static_cast<double>(body.radius_spin[axis]) / body.radius;
      }
    }
  }
}

template <class Real, bool turning>
void SoftSpheres<Real, turning>::save_springs() {
  if (spring_rows(laws_.model()) == 0 && walls_.empty()) return;
  const List& list = lists_[list_];
  saved_springs_.resize(list.block.size());
#pragma omp parallel for num_threads(threads_) schedule(static)
  for (int b = 0; b < list.blocks.count(); ++b) {
    const ContactBlock<Real>& block = list.block[b];
    SavedSprings<Real>& saved = saved_springs_[b];  // its memory is used again
    saved.inner.keep(block.inner_springs);
    saved.outer.keep(block.outer_springs);
    saved.image.keep(block.image_springs);
    saved.plane.keep(block.plane_springs);
    saved.surface.keep(block.surfaces.springs);
    saved.touches = block.surfaces.touches;
  }
}

template <class Real, bool turning>
void SoftSpheres<Real, turning>::rollback() {
  if (!has_candidate_) return;
  has_candidate_ = false;
  list_ = committed_list_;
  if (before_exchange_) {
    presented_ = std::move(before_exchange_->presented);
    sizes_ = before_exchange_->sizes;
    before_exchange_.reset();
  }
  for (std::size_t b = 0; b < saved_springs_.size(); ++b) {
    ContactBlock<Real>& block = lists_[list_].block[b];
    block.inner_springs = saved_springs_[b].inner;
    block.outer_springs = saved_springs_[b].outer;
    block.image_springs = saved_springs_[b].image;
    block.plane_springs = saved_springs_[b].plane;
    block.surfaces.springs = saved_springs_[b].surface;
    block.surfaces.touches = saved_springs_[b].touches;
    block.surfaces.lost = -1;
  }
  candidate_ = committed_;
  present(committed_);
}

template <class Real, bool turning>
EngineCounters SoftSpheres<Real, turning>::counters() const {
  EngineCounters counters{sub_steps_, rebuilds_, 0};
  for (const ContactBlock<Real>& block : lists_[list_].block) {
    // What two blocks hold is one pair.
    counters.list_pairs += static_cast<std::int64_t>(block.inner.size() +
                                                     (block.outer.size() + block.image.size()) / 2);
  }
  return counters;
}

}  // namespace fluxpact
