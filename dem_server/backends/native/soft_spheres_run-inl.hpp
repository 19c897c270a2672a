// One window: sub-steps and checks.
#pragma once

#include "dem_server/backends/native/soft_spheres.hpp"

namespace fluxpact {

/// What close pairs have beyond their flight: few more pairs against going through lists more
/// often.
inline constexpr double usual_room_per_slack = 0.04;

/// Drives in place of the forces of contacts.
template <class Real, bool turning>
void SoftSpheres<Real, turning>::set_drive(std::span<const Vector3> force) {
  const int count = presented_.size();
  int bad = count;
#pragma omp parallel for num_threads(threads_) schedule(static) reduction(min : bad)
  for (int i = 0; i < count; ++i) {
    const int row = lists_[list_].row[i];
    const double inverse_mass = static_cast<double>(bodies_[i].inverse_mass);
    const Vector3 fall = inverse_mass > 0 ? gravity_ : Vector3(Vector3::Zero());
    const Vector3 drive = fall + force[row] * inverse_mass;
    for (int axis = 0; axis < 3; ++axis) {
      loads_[i].force[axis] = static_cast<Real>(drive[axis]);
    }
    if (!drive.allFinite()) bad = std::min(bad, row);
  }
  if (bad == count) return;
  rollback();
  refuse_force(presented_.id[bad], force[bad]);
}

/// One phase of all blocks. True if the list must be made anew.
template <class Real, bool turning>
bool SoftSpheres<Real, turning>::sweep(Phase phase, double time_step, double spring_step) {
  List& list = lists_[list_];
  const Blocks& blocks = list.blocks;
  const int threads = turns_.threads();
  const auto of_thread = static_cast<std::ptrdiff_t>(turns_.rooms()) * blocks.block_size;
  sums_.resize(std::max(sums_.size(), static_cast<std::size_t>(threads * of_thread)));
  BlockPass<Real, turning> all;
  all.phase = phase;
  all.time_step = time_step;
  all.spring_step = spring_step;
  all.bodies = bodies_.data();
  all.kept_loads = kept_loads_.data();
  all.loads = loads_.data();
  all.listed_at = list.listed_at.data();
  all.origin = list.origin.data();
  all.reach = list.reach;
  all.shifts = shifts_.data();
  all.planes = planes_.data();
  all.laws = &law_table_;
  all.beyond_contact = sizes_.beyond_contact;
  all.root_masses = sizes_.root_masses;
  all.usual_room = usual_room_per_slack * sizes_.slack.least;
  const auto pass_of = [&](int thread, int b) {
    BlockPass<Real, turning> pass = all;
    pass.first = blocks.first(b);
    pass.own = pass.bodies + pass.first;
    pass.last = blocks.last(b);
    pass.sum = sums_.data() + thread * of_thread +
               static_cast<std::ptrdiff_t>(turns_.room(b)) * blocks.block_size;
    pass.contacts = &list.block[b];
    pass.search = &searches_[thread];
    return pass;
  };
  const auto move = [&](int thread, int b) {
    const Moved moved = move_block(pass_of(thread, b));
    // Blocks do not meet between two windows, where a kick has two halves.
    kicks_[b] = phase == Phase::start ? kicks_[b] + moved.kick : moved.kick;
    return moved.beyond;
  };
  bool beyond = false;
#pragma omp parallel num_threads(threads) reduction(|| : beyond)
  {
#pragma omp for schedule(static, 1)
    for (int thread = 0; thread < threads; ++thread) {
      const int first = turns_.first(thread);
      for (int b = first; b < turns_.first(thread + 1); ++b) {
        if (phase != Phase::start) {
          BlockPass<Real, turning> pass = pass_of(thread, b);
          pass.kick = kick(b);
          meet(pass);
        }
        for (int read = first; read <= b; ++read) {
          if (turns_.last_reader(read) != b) continue;
          const bool one = move(thread, read);
          beyond = beyond || one;
        }
      }
    }
#pragma omp for schedule(static, 1)
    for (int thread = 0; thread < threads; ++thread) {
      for (int b = turns_.first(thread); b < turns_.first(thread + 1); ++b) {
        if (turns_.last_reader(b) != blocks.count()) continue;
        const bool one = move(thread, b);
        beyond = beyond || one;
      }
    }
  }
  return beyond;
}

/// The largest kick since blocks met, of a particle of a block and a partner together [m/s].
template <class Real, bool turning>
double SoftSpheres<Real, turning>::kick(int block) const {
  double theirs = kicks_[block];
  for (const int read : lists_[list_].block[block].partners) {
    theirs = std::max(theirs, kicks_[read]);
  }
  return kicks_[block] + theirs;
}

/// The forces of the contacts of one block.
template <class Real, bool turning>
void SoftSpheres<Real, turning>::meet(const BlockPass<Real, turning>& pass) const {
  if (!walls_.empty()) {
    find_touches<Real, turning>(walls_, laws_, surface_materials_,
                                {pass.own, pass.bodies + pass.last}, sizes_.beyond_contact,
                                spring_rows(laws_.model()), pass.contacts->surfaces);
  }
  sum_contacts(pass);
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
  if (static_cast<int>(force.size()) != presented_.size()) {
    throw NumericsError("force on the particles: {} rows for {} particles", force.size(),
                        presented_.size());
  }
  take_back_motion();
  save_springs();
  std::swap(loads_, kept_loads_);
  loads_.resize(bodies_.size());
  kept_beyond_ = beyond_;
  has_candidate_ = true;
  set_drive(force);
  plan_turns();
  bool beyond = sweep(Phase::start, time_step, 0);
  for (int step = 1; step <= sub_steps; ++step) {
    place_walls(time_ + step * time_step);
    if (beyond || walls_moved_far()) {
      check(time_step, step, sub_steps);
      check_surfaces();  // what this list has noted would go with it
      sort_and_list(nullptr, true);
      set_drive(force);
    }
    const Phase phase = step < sub_steps ? Phase::drift : Phase::settle;
    beyond = sweep(phase, time_step, time_step);
    if (progress) progress();
  }
  window_ = window;
  sub_steps_ += sub_steps;
  check(time_step, sub_steps, sub_steps);
  check_surfaces();
  present_candidate();
}

template <class Real, bool turning>
void SoftSpheres<Real, turning>::check(double time_step, int sub_step, int sub_steps) const {
  const std::vector<int>& row_of = lists_[list_].row;
  const int none = presented_.size();
  const bool may_touch = std::isfinite(sizes_.limit.longest);
  int bad = none;
  const auto motion = [&](int i) {
    const Real* v = bodies_[i].velocity;
    return Motion{
        Eigen::Map<const Vector3>(bodies_[i].position),
        Vector3(static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])),
        bodies_[i].radius};
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
EngineCounters SoftSpheres<Real, turning>::counters() const {
  EngineCounters counters{sub_steps_, rebuilds_, 0};
  for (const ContactBlock<Real>& block : lists_[list_].block) {
    // What two blocks hold is one pair.
    counters.list_pairs += block.inner.size() + (block.outer.size() + block.image.size()) / 2;
  }
  return counters;
}

}  // namespace fluxpact
