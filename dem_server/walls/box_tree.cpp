#include "dem_server/walls/box_tree.hpp"

#include <algorithm>
#include <numeric>

namespace fluxpact {

BoxTree::BoxTree(std::span<const Extent> boxes) {
  const int count = static_cast<int>(boxes.size());
  if (count == 0) return;
  items_.resize(boxes.size());
  std::iota(items_.begin(), items_.end(), 0);
  nodes_.push_back({{}, 0, count});
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const int first = nodes_[n].first;
    const int size = nodes_[n].count;
    Extent around = boxes[items_[first]];
    Extent centres{around.lower + around.upper, around.lower + around.upper};  // twice the centre
    for (int k = first + 1; k < first + size; ++k) {
      const Extent& box = boxes[items_[k]];
      around = {around.lower.cwiseMin(box.lower), around.upper.cwiseMax(box.upper)};
      const Vector3 centre = box.lower + box.upper;
      centres = {centres.lower.cwiseMin(centre), centres.upper.cwiseMax(centre)};
    }
    nodes_[n].bounds = around;
    if (size <= leaf_size) continue;
    int axis = 0;
    (centres.upper - centres.lower).maxCoeff(&axis);
    const auto begin = items_.begin() + first;
    const int half = size / 2;
    std::nth_element(begin, begin + half, begin + size, [&](int a, int b) {
      const double at_a = boxes[a].lower[axis] + boxes[a].upper[axis];
      const double at_b = boxes[b].lower[axis] + boxes[b].upper[axis];
      return at_a < at_b || (at_a == at_b && a < b);
    });
    const int children = static_cast<int>(nodes_.size());
    nodes_[n].first = children;
    nodes_[n].count = 0;
    nodes_.push_back({{}, first, half});
    nodes_.push_back({{}, first + half, size - half});
  }
}

}  // namespace fluxpact
