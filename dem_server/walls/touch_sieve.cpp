#include "dem_server/walls/touch_sieve.hpp"

#include <algorithm>

namespace fluxpact {

void TouchSieve::add(const Meeting& meeting) {
  if (count_ == capacity) sift(first_);  // those of one frame: normals of others cannot be compared
  if (count_ == capacity) {
    full_ = true;
    return;
  }
  Meeting& added = meetings_[static_cast<std::size_t>(count_++)];
  added = meeting;
  added.surface = surface_;
}

void TouchSieve::end(const Pose& pose) {
  if (!pose.turns) return;
  for (int k = first_; k < count_; ++k) {
    Meeting& meeting = meetings_[static_cast<std::size_t>(k)];
    meeting.normal = pose.direction(meeting.normal);
  }
}

bool TouchSieve::hidden_by(const Meeting& kept, const Meeting& meeting) const {
  if (kept.normal.dot(meeting.normal) > least_angle_cosine) return true;
  if (!kept.face || meeting.joint == nullptr) return false;
  const auto first = facets_.faces.begin() + meeting.joint->first_face;
  const auto last = first + meeting.joint->face_count;
  return std::find(first, last, kept.feature) != last;
}

/// Of the meetings from `first` on keep, nearest first, each that none of those kept hides.
void TouchSieve::sift(int first) {
  const auto begin = meetings_.begin() + first;
  const auto last = meetings_.begin() + count_;
  std::sort(begin, last, [](const Meeting& a, const Meeting& b) {
    return a.distance < b.distance || (a.distance == b.distance && a.feature < b.feature);
  });
  auto end = begin;
  for (auto at = begin; at != last; ++at) {
    const bool hidden =
        std::any_of(begin, end, [&](const Meeting& kept) { return hidden_by(kept, *at); });
    if (!hidden) *end++ = *at;
  }
  count_ = static_cast<int>(end - meetings_.begin());
}

int TouchSieve::write(std::span<WallTouch> out) {
  if (full_) return -1;
  if (count_ > 1) sift(0);
  if (count_ > static_cast<int>(out.size())) return -1;
  for (int k = 0; k < count_; ++k) {
    const Meeting& meeting = meetings_[static_cast<std::size_t>(k)];
    WallTouch& touch = out[static_cast<std::size_t>(k)];
    touch.normal = meeting.normal;
    touch.distance = meeting.distance;
    touch.surface = meeting.surface;
    touch.feature = meeting.feature;
  }
  return count_;
}

}  // namespace fluxpact
