// Cells given by the points of their sides -> faces that two cells share, once each.
//
// Used where a file or a generator lists cells rather than faces; the next step is with_geometry.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "proto/mesh/mesh.hpp"

namespace fluxpact {

/// The sides of all cells: a ring of points each, right-handed about the direction out of its cell.
struct CellSides {
  std::vector<int> offsets{0};  ///< CSR: sides + 1 entries into points
  std::vector<int> points;
  std::vector<int> cell;  ///< one for each side

  void add(int of_cell, std::span<const int> ring);
  int size() const { return static_cast<int>(cell.size()); }
  std::span<const int> ring(int side) const;
};

struct MatchedSides {
  std::vector<std::array<int, 2>> pairs;  ///< sides with the same points: the lower cell's first
  std::vector<int> single;                ///< sides that one cell has alone, ascending
};

/// Which sides are the same face: those with the same points, whatever their order. `points` give
/// the place in messages. Throws ConfigError if three sides share their points, or if two cells lie
/// on the same side of their face (one of them is inside out, or they overlap).
MatchedSides match_sides(const CellSides& sides, std::span<const Vector3> points);

/// The faces of matched cells: pairs by owner, then the single ones patch by patch.
/// `patch_of_single` names for each of `matched.single` its entry in `names`; patches without a
/// face are left out.
MeshTopology mesh_of_sides(std::vector<Vector3> points, const CellSides& sides,
                           const MatchedSides& matched, std::span<const int> patch_of_single,
                           std::span<const std::string> names);

}  // namespace fluxpact
