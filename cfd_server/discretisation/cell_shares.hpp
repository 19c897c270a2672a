// How threads share a loop over faces that adds to both cells of each face.
//
// Each thread has a range of cells and visits every face that touches it, in ascending order; a
// face between two ranges is visited by both. So no two threads write to the same cell, and what a
// cell sums up has the same bits for any number of threads.
#pragma once

#include <span>
#include <vector>

namespace fluxpact {

struct CellShare {
  int first = 0;  ///< cells [first, last)
  int last = 0;
  bool all = false;        ///< the only thread: all faces
  std::vector<int> faces;  ///< else those that touch these cells, ascending

  bool has(int cell) const { return cell >= first && cell < last; }
};

/// owner: one a face; neighbour: one an internal face.
std::vector<CellShare> share_cells(int cells, int threads, std::span<const int> owner,
                                   std::span<const int> neighbour);

/// visit(f) for the faces of the share in [first, last).
template <class Visit>
void for_faces(const CellShare& share, int first, int last, const Visit& visit) {
  if (share.all) {
    for (int f = first; f < last; ++f) visit(f);
    return;
  }
  for (const int f : share.faces) {
    if (f >= first && f < last) visit(f);
  }
}

}  // namespace fluxpact
