#include "dem_server/walls/sheet.hpp"

namespace fluxpact {

NearestFacet nearest_in(const BoxTree& tree, const Facets& facets, int first, const Vector3& x) {
  NearestFacet nearest;
  double square = nearest.square;
  tree.visit(x, square, [&](int index) {
    consider(facets.facets[first + index], x, nearest);
    square = nearest.square;
  });
  return nearest;
}

const FacetJoint* joint_at(const Facets& facets, const NearestFacet& nearest) {
  if (nearest.point.part == FacetPart::face) return nullptr;
  return &joint_of(facets, *nearest.facet, nearest.point);
}

Vector3 sheet_normal(const Facets& facets, const NearestFacet& nearest) {
  const FacetJoint* joint = joint_at(facets, nearest);
  // No sum was made at crowded joints.
  if (joint == nullptr || joint->normal.squaredNorm() < 1e-12) return nearest.facet->normal;
  return joint->normal;
}

double height(const Facets& facets, const NearestFacet& nearest, const Vector3& x) {
  return sheet_normal(facets, nearest).dot(x - nearest.point.point);
}

bool at_rim(const Facets& facets, const NearestFacet& nearest) {
  const FacetJoint* joint = joint_at(facets, nearest);
  return joint != nullptr && joint->rim;
}

}  // namespace fluxpact
