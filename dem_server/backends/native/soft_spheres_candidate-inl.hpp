// The candidate and the committed state: who holds what of the two, commit and rollback.
#pragma once

#include "dem_server/backends/native/soft_spheres.hpp"

namespace fluxpact {

/// Position and velocity of a body in its presented row.
template <class Real, bool turning>
void SoftSpheres<Real, turning>::present_motion(int place) {
  const BodyRow& body = bodies_[place];
  const int row = lists_[list_].row[place];
  const Vector3 position(body.position);
  presented_.position[row] = position;
  if (any_periodic_) {
    const Vector3 inside = wrapped(domain_, position);
    presented_.position[row] = inside;
    if (inside != position) {  // few
#pragma omp critical(beyond_periodic_sides)
      beyond_.push_back({place, position});
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    presented_.velocity[row][axis] = static_cast<double>(body.velocity[axis]);
  }
}

/// Positions and velocities of the bodies, whose spins come from the presented state.
template <class Real, bool turning>
void SoftSpheres<Real, turning>::present() {
  beyond_.clear();
#pragma omp parallel for num_threads(threads_) schedule(static)
  for (int i = 0; i < presented_.size(); ++i) present_motion(i);
}

// While the motion of the committed state waits in the bodies, a spin of doubles stands there in
// rad/s, since the division would not give it back to the last bit. One of floats is presented as
// radius times spin over the radius, which comes back as it was.
template <class Real>
Real spin_that_waits(double spin, double radius) {
  return static_cast<Real>(sizeof(Real) == sizeof(double) ? spin : radius * spin);
}
template <class Real>
double spin_that_waited(Real number, double radius) {
  const auto spin = static_cast<double>(number);
  return sizeof(Real) == sizeof(double) ? spin : spin / radius;
}

/// Presents the candidate. The motion of the committed state, which was presented, waits in the
/// bodies, whose own is presented now: so nothing is held three times.
template <class Real, bool turning>
void SoftSpheres<Real, turning>::present_candidate() {
  beyond_.clear();
#pragma omp parallel for num_threads(threads_) schedule(static)
  for (int i = 0; i < presented_.size(); ++i) {
    const int row = lists_[list_].row[i];
    BodyRow& body = bodies_[i];
    const Vector3 position = presented_.position[row];
    const Vector3 velocity = presented_.velocity[row];
    present_motion(i);
    for (int axis = 0; axis < 3; ++axis) {
      body.position[axis] = position[axis];
      body.velocity[axis] = static_cast<Real>(velocity[axis]);
      if constexpr (turning) {
        double& spin = presented_.spin[row][axis];
        const Real waits = spin_that_waits<Real>(spin, body.radius);
        spin = static_cast<double>(body.radius_spin[axis]) / body.radius;
        body.radius_spin[axis] = waits;
      }
    }
  }
  swapped_ = true;
}

/// The presented motion to the bodies: of a candidate, or once the next window begins. (What is
/// presented is the state: a radius times spin of doubles may differ in its last bit from what it
/// was.)
template <class Real, bool turning>
void SoftSpheres<Real, turning>::take_back_motion() {
  if (!swapped_) return;
  swapped_ = false;
#pragma omp parallel for num_threads(threads_) schedule(static)
  for (int i = 0; i < presented_.size(); ++i) set_motion(lists_[list_].row[i], bodies_[i]);
  put_beyond(beyond_);
}

/// The motion of the committed state, which waits in the bodies.
template <class Real, bool turning>
void SoftSpheres<Real, turning>::give_committed(ParticleState& to) const {
#pragma omp parallel for num_threads(threads_) schedule(static)
  for (int i = 0; i < to.size(); ++i) {
    const BodyRow& body = bodies_[i];
    const int row = lists_[list_].row[i];
    for (int axis = 0; axis < 3; ++axis) {
      to.position[row][axis] = body.position[axis];
      to.velocity[row][axis] = static_cast<double>(body.velocity[axis]);
      if constexpr (turning) {
        to.spin[row][axis] = spin_that_waited(body.radius_spin[axis], body.radius);
      }
    }
  }
}

template <class Real, bool turning>
void SoftSpheres<Real, turning>::put_beyond(const std::vector<Beyond>& bodies) {
  for (const Beyond& body : bodies) {
    Eigen::Map<Vector3>(bodies_[body.place].position) = body.position;
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
    saved.pairs.take(block);
    saved.plane.keep(block.plane_springs);
    saved.surface.keep(block.surfaces.springs);
    saved.touches = block.surfaces.touches;
  }
}

template <class Real, bool turning>
void SoftSpheres<Real, turning>::bring_back_springs() {
  for (ContactBlock<Real>& block : lists_[list_].block) block.budget.forget();
  for (std::size_t b = 0; b < saved_springs_.size(); ++b) {
    ContactBlock<Real>& block = lists_[list_].block[b];
    const SavedSprings<Real>& saved = saved_springs_[b];
    saved.pairs.bring_back(block);
    block.plane_springs.keep(saved.plane);
    block.surfaces.springs.keep(saved.surface);
    block.surfaces.touches = saved.touches;
    block.surfaces.lost = -1;
  }
}

template <class Real, bool turning>
void SoftSpheres<Real, turning>::commit() {
  if (!has_candidate_) return;
  has_candidate_ = false;
  committed_list_ = list_;
  time_ += window_;
  before_exchange_.reset();
}

template <class Real, bool turning>
void SoftSpheres<Real, turning>::rollback() {
  if (!has_candidate_) return;
  has_candidate_ = false;
  if (swapped_) give_committed(presented_);
  swapped_ = false;
  if (list_ != committed_list_) swap_close_pairs(lists_[list_], lists_[committed_list_]);
  list_ = committed_list_;
  if (before_exchange_) {
    presented_ = std::move(before_exchange_->presented);
    sizes_ = before_exchange_->sizes;
    before_exchange_.reset();
  }
  bring_back_springs();
  const std::vector<int>& row_of = lists_[list_].row;
  std::swap(loads_, kept_loads_);
  bodies_.resize(loads_.size());
#pragma omp parallel for num_threads(threads_) schedule(static)
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    bodies_[i] = body_of(row_of[i]);  // a new list may have put others here
  }
  beyond_ = kept_beyond_;
  put_beyond(beyond_);
}

}  // namespace fluxpact
