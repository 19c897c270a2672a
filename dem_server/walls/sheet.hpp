// On which side of a sheet of facets a place is.
#pragma once

#include <limits>

#include "dem_server/walls/box_tree.hpp"
#include "dem_server/walls/facets.hpp"

namespace fluxpact {

/// The point of some facets that is nearest to a place.
struct NearestFacet {
  double square = std::numeric_limits<double>::infinity();  ///< of the distance [m²]
  const WallFacet* facet = nullptr;
  FacetPoint point;
};

/// Make `nearest` that of a further facet if it is nearer.
inline void consider(const WallFacet& facet, const Vector3& x, NearestFacet& nearest) {
  const FacetPoint point = nearest_on(facet, x);
  const double square = (x - point.point).squaredNorm();
  if (square < nearest.square) nearest = {square, &facet, point};
}

/// The nearest of the facets of a tree, whose first facet has the number `first`.
NearestFacet nearest_in(const BoxTree& tree, const Facets& facets, int first, const Vector3& x);

/// The edge or vertex that the nearest point belongs to; nullptr in a face.
const FacetJoint* joint_at(const Facets& facets, const NearestFacet& nearest);

/// Normal of the sheet at its nearest point, of any length: whether a place is before or behind the
/// sheet is the sign of its product with the way there, at edges and vertices, too (Baerentzen and
/// Aanaes, IEEE Trans. Vis. Comput. Graph. 11, 2005, 243-253). Where more than two facets share an
/// edge, that of the facet.
Vector3 sheet_normal(const Facets& facets, const NearestFacet& nearest);

/// Positive if x is in front of the sheet, negative behind it, 0 on it.
double height(const Facets& facets, const NearestFacet& nearest, const Vector3& x);

/// True if the nearest point is at the border of the sheet.
bool at_rim(const Facets& facets, const NearestFacet& nearest);

}  // namespace fluxpact
