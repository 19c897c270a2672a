#include "cfd_server/vans/flux_closure.hpp"

#include <algorithm>
#include <cmath>

namespace fluxpact {

ClosureTree make_closure_tree(const Stencil& s, const BoundaryConditions& conditions,
                              const FluidRegions& regions) {
  const auto cells = static_cast<std::size_t>(s.cells);
  ClosureTree tree;
  tree.order.reserve(cells);
  tree.parent_face.assign(cells, -1);
  tree.parent_cell.assign(cells, -1);
  tree.sign.assign(cells, 0);
  tree.carry.assign(cells, 0.0L);
  std::vector<bool> reached(cells, false);
  const auto reach = [&](int cell, int face, int parent, std::int8_t sign) {
    if (reached[cell]) return;
    reached[cell] = true;
    tree.order.push_back(cell);
    tree.parent_face[cell] = face;
    tree.parent_cell[cell] = parent;
    tree.sign[cell] = sign;
  };
  for (int f = s.internal_faces; f < s.faces; ++f) {
    if (conditions.kind[f - s.internal_faces] == FaceKind::pressure) reach(s.owner[f], f, -1, 1);
  }
  for (const FluidRegion& region : regions.list) {
    if (!region.open) reach(region.first_cell, -1, -1, 0);
  }
  std::size_t next = 0;
  while (next < tree.order.size()) {  // `order` grows meanwhile
    const int cell = tree.order[next++];
    for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
      const int other = s.side_other[side];
      if (other >= 0)
        reach(other, s.side_face[side], cell, static_cast<std::int8_t>(-s.side_sign[side]));
    }
  }
  return tree;
}

double close_fluxes(ClosureTree& tree, const Stencil& s, std::span<const double> storage,
                    std::span<double> flux) {
  std::ranges::fill(tree.carry, 0.0L);
  double largest = 0;
  for (std::size_t left = tree.order.size(); left > 0; --left) {
    const int cell = tree.order[left - 1];
    const int parent_face = tree.parent_face[cell];
    if (parent_face < 0) continue;
    // The cell's sum is exact to its last digit, and what the rounding of the new flux leaves goes
    // to the parent: so neither the cell's nor the global balance grows with the number of cells.
    long double sum = tree.carry[cell] + storage[cell];
    for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
      const int f = s.side_face[side];
      if (f != parent_face) sum += static_cast<long double>(s.side_sign[side] * flux[f]);
    }
    const double outward = static_cast<double>(-sum);
    const double closed = tree.sign[cell] * outward;
    largest = std::max(largest, std::abs(closed - flux[parent_face]));
    flux[parent_face] = closed;
    if (tree.parent_cell[cell] >= 0) tree.carry[tree.parent_cell[cell]] += sum + outward;
  }
  return largest;
}

}  // namespace fluxpact
