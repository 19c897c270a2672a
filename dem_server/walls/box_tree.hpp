// A tree of boxes over many small things, to find those near a place.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "proto/base/vector.hpp"

namespace fluxpact {

struct Extent {
  Vector3 lower = Vector3::Zero();  ///< [m]
  Vector3 upper = Vector3::Zero();  ///< [m]

  /// Square of the distance of a place from the box [m²]; 0 inside.
  double square_distance(const Vector3& x) const {
    return (lower - x).cwiseMax(x - upper).cwiseMax(0.0).squaredNorm();
  }
};

class BoxTree {
 public:
  BoxTree() = default;
  /// Over the boxes 0 ... size - 1.
  explicit BoxTree(std::span<const Extent> boxes);

  /// Calls visit(index) for each box whose distance from `x` squared is at most `reach_square`
  /// [m²], in an order that depends on the tree alone. The visit may lower `reach_square` on the
  /// way, as a search for the nearest does.
  template <class Visit>
  void visit(const Vector3& x, double& reach_square, const Visit& visit) const;

 private:
  struct Node {
    Extent bounds;
    int first = 0;  ///< leaf: into items_; else: its left child (the right one follows it)
    int count = 0;  ///< of a leaf; 0: not a leaf
  };
  static constexpr int leaf_size = 4;
  /// Halving to leaves of 4 never makes a tree of ints deeper.
  static constexpr std::size_t most_depth = 64;

  std::vector<Node> nodes_;
  std::vector<int> items_;
};

template <class Visit>
void BoxTree::visit(const Vector3& x, double& reach_square, const Visit& visit) const {
  if (nodes_.empty()) return;
  std::array<int, most_depth> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = nodes_[stack[--depth]];
    if (node.bounds.square_distance(x) > reach_square) continue;
    if (node.count > 0) {
      for (int k = node.first; k < node.first + node.count; ++k) visit(items_[k]);
      continue;
    }
    const bool right_first = nodes_[node.first + 1].bounds.square_distance(x) <
                             nodes_[node.first].bounds.square_distance(x);
    stack[depth++] = node.first + (right_first ? 0 : 1);
    stack[depth++] = node.first + (right_first ? 1 : 0);
  }
}

}  // namespace fluxpact
