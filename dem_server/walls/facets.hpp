// Triangles as walls: what touches of a sphere need to know of each triangle, edge and vertex.
// Made once; in the frame of the surface at rest.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "proto/mesh/triangle_surface.hpp"

namespace fluxpact {

struct WallFacet {
  Vector3 corner;               ///< [m] corner 0
  std::array<Vector3, 2> side;  ///< [m] from corner 0 to 1 and to 2
  Vector3 normal;               ///< unit; all of a shell point to the same side of it
  std::array<int, 3> edges{};   ///< from corner 0 to 1, 1 to 2, 2 to 0
  std::array<int, 3> vertices{};
  int shell = 0;
  std::int32_t feature = 0;  ///< the same for connected facets of one plane
};

/// An edge or a vertex: where it is nearest to a place, and on which side of its shell that is.
struct FacetJoint {
  Vector3 normal = Vector3::Zero();  ///< sum of the facets' normals, by angle at a vertex
  std::int32_t feature = 0;
  bool rim = false;  ///< at the border of its shell: it has no sides there
  int first = 0;     ///< into Facets::away
  int count = 0;
  int first_face = 0;  ///< into Facets::faces
  int face_count = 0;
};

/// Facets connected across edges of two. A shell has two sides; a closed one an inside.
struct Shell {
  int surface = 0;  ///< index of the surface it belongs to
};

/// The facets of all surfaces.
struct Facets {
  std::vector<WallFacet> facets;
  std::vector<FacetJoint> edges;
  std::vector<FacetJoint> vertices;
  /// Unit vectors: from an edge into each of its facets, from a vertex along each of its edges, of
  /// other shells, too. The joint is the nearest point of these facets to x where x - joint has no
  /// positive product with any of its.
  std::vector<Vector3> away;
  std::vector<std::int32_t> faces;  ///< features of the facets around each joint
  std::vector<Shell> shells;
};

/// Facets whose normals differ by less than this [rad] and that are connected have one feature.
inline constexpr double coplanar = 1e-3;

/// Add the triangles of a surface, whose points are merged. `features` is the next free feature
/// number and moves on. Throws ConfigError that names `source` and a triangle if a shell has one
/// side only (a Moebius strip).
void add_facets(const TriangleSurface& surface, int index, const std::string& source,
                Facets& facets, std::int32_t& features);

enum class FacetPart : std::uint8_t { face, edge, vertex };

/// The point of a facet nearest to a place.
struct FacetPoint {
  Vector3 point;  ///< [m]
  FacetPart part = FacetPart::face;
  int corner = 0;  ///< the vertex, or the corner from which the edge goes to the next
};

/// Ericson, Real-Time Collision Detection, 2005, section 5.1.5.
inline FacetPoint nearest_on(const WallFacet& facet, const Vector3& x) {
  const Vector3& ab = facet.side[0];
  const Vector3& ac = facet.side[1];
  const Vector3 ap = x - facet.corner;
  const double d1 = ab.dot(ap);
  const double d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {facet.corner, FacetPart::vertex, 0};
  const Vector3 bp = ap - ab;
  const double d3 = ab.dot(bp);
  const double d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {facet.corner + ab, FacetPart::vertex, 1};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    return {facet.corner + d1 / (d1 - d3) * ab, FacetPart::edge, 0};
  }
  const Vector3 cp = ap - ac;
  const double d5 = ab.dot(cp);
  const double d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {facet.corner + ac, FacetPart::vertex, 2};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    return {facet.corner + d2 / (d2 - d6) * ac, FacetPart::edge, 2};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    return {facet.corner + ab + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (ac - ab), FacetPart::edge,
            1};
  }
  return {x - facet.normal.dot(ap) * facet.normal, FacetPart::face, 0};
}

/// What the nearest point of a facet belongs to, if that is no face.
inline const FacetJoint& joint_of(const Facets& facets, const WallFacet& facet,
                                  const FacetPoint& nearest) {
  const auto corner = static_cast<std::size_t>(nearest.corner);
  return nearest.part == FacetPart::edge ? facets.edges[facet.edges[corner]]
                                         : facets.vertices[facet.vertices[corner]];
}

}  // namespace fluxpact
