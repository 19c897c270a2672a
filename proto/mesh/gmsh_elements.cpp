#include "proto/mesh/gmsh_elements.hpp"

#include <algorithm>
#include <utility>

namespace fluxpact {

const GmshCell* find_gmsh_cell(int type) {
  static const std::array<GmshCell, 4> cells{{
      {4, 4, {{0, 2, 1, -1}, {0, 1, 3, -1}, {1, 2, 3, -1}, {0, 3, 2, -1}}},
      {5, 8, {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}},
      {6, 6, {{0, 2, 1, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}},
      {7, 5, {{0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}}},
  }};
  const auto found = std::ranges::find(cells, type, &GmshCell::type);
  return found == cells.end() ? nullptr : &*found;
}

const char* gmsh_type_name(int type) {
  constexpr std::array<std::pair<int, const char*>, 12> names{{
      {8, "line of the second order"},
      {9, "triangle of the second order, 6 nodes"},
      {10, "quadrangle of the second order, 9 nodes"},
      {11, "tetrahedron of the second order, 10 nodes"},
      {12, "hexahedron of the second order, 27 nodes"},
      {13, "prism of the second order, 18 nodes"},
      {14, "pyramid of the second order, 14 nodes"},
      {16, "quadrangle of the second order, 8 nodes"},
      {17, "hexahedron of the second order, 20 nodes"},
      {18, "prism of the second order, 15 nodes"},
      {19, "pyramid of the second order, 13 nodes"},
      {29, "tetrahedron of the third order, 20 nodes"},
  }};
  const auto found = std::ranges::find(names, type, &std::pair<int, const char*>::first);
  return found == names.end() ? "see the manual of Gmsh" : found->second;
}

}  // namespace fluxpact
