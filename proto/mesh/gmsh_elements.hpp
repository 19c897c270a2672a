// The numbering of nodes in the elements of Gmsh (its reference manual, "Node ordering").
#pragma once

#include <array>
#include <vector>

namespace fluxpact {

/// A volume element: its sides, right-handed about the direction out of it; −1 fills triangles.
struct GmshCell {
  int type = 0;
  int nodes = 0;
  std::vector<std::array<int, 4>> sides;
};

/// The cell of a type number of Gmsh, or nullptr if it is none that a mesh here may have.
const GmshCell* find_gmsh_cell(int type);

/// "tetrahedron of 10 nodes" ..., for messages.
const char* gmsh_type_name(int type);

}  // namespace fluxpact
