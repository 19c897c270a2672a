// What makes a mesh unusable: numbers that do not fit, and faces, cells and points that are not
// sound. Every mesh passes here, made or read or received, before anything is computed on it.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "proto/mesh/mesh.hpp"

namespace fluxpact {

/// Throws ConfigError if the lengths of the lists do not fit, a number points nowhere, a face has
/// fewer than 3 points or joins a cell to itself, or the patches do not cover the boundary in
/// order.
void check_topology(const MeshTopology& mesh);

/// The number of cells. Throws ConfigError if a cell below the highest number has no face.
int count_cells(const MeshTopology& mesh);

enum class MeshFault { unused_point, face_without_area, open_cell, cell_without_volume };

/// All faults of a mesh: how many of each kind, and the first few with their place.
class MeshFaults {
 public:
  /// `measure`: of a face its area [m²], of an open cell the sum of its face areas over its
  /// surface [-], of a cell its volume [m³]; for points without meaning.
  void add(MeshFault fault, int index, const Vector3& place, double measure);

  /// Throws ConfigError that lists them, if there is any.
  void refuse() const;

 private:
  struct Entry {
    int total = 0;
    std::vector<std::string> first;
  };
  std::array<Entry, 4> entries_;
};

/// Adds the points that no face uses. Does nothing with periodic faces: of those only one side is
/// stored, so points of the other may be on no face.
void find_unused_points(const MeshTopology& mesh, MeshFaults& faults);

}  // namespace fluxpact
