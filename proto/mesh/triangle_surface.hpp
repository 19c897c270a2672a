// Triangles with shared points: walls of particles from a file or from the boundary of a mesh.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "proto/base/vector.hpp"

namespace fluxpact {

struct TriangleSurface {
  std::vector<Vector3> points;                ///< [m]
  std::vector<std::array<int, 3>> triangles;  ///< right-handed about the outward normal
  std::vector<int> number;  ///< of each triangle in its file, from 1; empty: as they stand
};

/// An edge between two points, and the triangles that have it as a side.
struct SurfaceEdge {
  std::array<int, 2> points{};  ///< ascending
  int first = 0;                ///< into SurfaceEdges::sides
  int count = 0;                ///< 1: open, 2: as it should be, more: several sheets meet
};

struct SurfaceEdges {
  /// A side of a triangle: from its corner `side` to the next, along the edge or against it.
  struct Side {
    int triangle = 0;
    int side = 0;
    bool along = true;  ///< from the lower point to the higher
  };
  std::vector<SurfaceEdge> edges;      ///< ascending by points
  std::vector<Side> sides;             ///< edge by edge, ascending by triangle
  std::vector<std::array<int, 3>> of;  ///< edge of each side of each triangle
};

SurfaceEdges find_edges(const TriangleSurface& surface);

/// Make one point of those that lie within `tolerance` [m] of each other, in the order of the
/// first of each, and drop triangles two of whose corners became one (their neighbours join).
TriangleSurface with_merged_points(const TriangleSurface& surface, double tolerance);

/// What a user wants to know before a run.
struct SurfaceQuality {
  int triangles = 0;
  Vector3 lower = Vector3::Zero();  ///< [m]
  Vector3 upper = Vector3::Zero();  ///< [m]
  int open_edges = 0;               ///< with one triangle
  int crowded_edges = 0;            ///< with more than two
  int turned_edges = 0;             ///< whose two triangles disagree about the outward side
  double smallest_area = 0;         ///< [m²]
  int smallest = 0;                 ///< number of that triangle
  double shortest_edge = 0;         ///< [m]

  /// True if it bounds a volume whose outside the triangles agree about.
  bool closed() const { return open_edges == 0 && crowded_edges == 0 && turned_edges == 0; }
};

SurfaceQuality measure_surface(const TriangleSurface& surface);

/// Throws ConfigError that begins with `key` and names `source` and its faults if the surface is
/// not closed.
void refuse_if_open(const std::string& key, const std::string& source,
                    const SurfaceQuality& quality);

/// The volume that a closed surface holds [m³]; negative if the triangles point inwards.
double enclosed_volume(const TriangleSurface& surface);

}  // namespace fluxpact
