#include "dem_server/walls/room.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "dem_server/walls/mesh_surface.hpp"
#include "dem_server/walls/sheet.hpp"

namespace fluxpact {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

bool is_wrong_side(SurfaceSide side, double outside) {
  return (side == SurfaceSide::inside && outside > 0) ||
         (side == SurfaceSide::outside && outside < 0);
}

}  // namespace

Room::Room(const Scene& scene, const Mesh& mesh) : walls_(make_walls(scene, mesh)) {
  const Domain domain = particle_domain(scene, mesh);
  std::vector<int> faces(static_cast<std::size_t>(mesh.faces() - mesh.internal_faces()));
  std::iota(faces.begin(), faces.end(), mesh.internal_faces());
  const auto off_box = [&](int face) { return side_of_face(domain, mesh, face) < 0; };
  if (std::none_of(faces.begin(), faces.end(), off_box)) return;
  std::int32_t features = 0;
  add_facets(with_periodic_images(triangles_of(mesh, faces), domain), 0, "fluid.mesh", boundary_,
             features);
  std::vector<Extent> boxes;
  for (const WallFacet& facet : boundary_.facets) {
    const Vector3 b = facet.corner + facet.side[0];
    const Vector3 c = facet.corner + facet.side[1];
    boxes.push_back({facet.corner.cwiseMin(b).cwiseMin(c), facet.corner.cwiseMax(b).cwiseMax(c)});
  }
  tree_ = BoxTree(boxes);
}

double Room::clearance_of(const WallSurface& surface, const Vector3& x) const {
  const Vector3 at = surface.pose.to_body(x);
  if (surface.type == SurfaceType::plane) return surface.normal.dot(at - surface.point);
  if (surface.type != SurfaceType::stl) {
    const TubePoint nearest = nearest_on(surface.tube, at);
    const double distance = (at - nearest.point).norm();
    const double z = (at - surface.tube.start).dot(surface.tube.axis);
    const bool beside = std::isinf(surface.tube.length) || (z >= 0 && z <= surface.tube.length);
    return beside && is_wrong_side(surface.side, nearest.outside) ? -distance : distance;
  }
  const int first = surface.first_element - walls_.primitives();
  const NearestFacet nearest = nearest_in(surface.tree, walls_.facets(), first, at);
  const double distance = std::sqrt(nearest.square);
  return is_wrong_side(surface.side, height(walls_.facets(), nearest, at)) ? -distance : distance;
}

double Room::depth_in_mesh(const Vector3& x) const {
  if (boundary_.facets.empty()) return infinity;
  const NearestFacet nearest = nearest_in(tree_, boundary_, 0, x);
  return height(boundary_, nearest, x) <= 0 ? infinity : -std::sqrt(nearest.square);
}

double Room::clearance(const Vector3& x) const {
  double least = depth_in_mesh(x);
  for (int s = 0; s < walls_.size(); ++s) least = std::min(least, clearance_of(walls_[s], x));
  return least;
}

std::string Room::nearest_wall(const Vector3& x) const {
  double least = depth_in_mesh(x);
  std::string name = least < infinity ? "mesh" : "";
  for (int s = 0; s < walls_.size(); ++s) {
    const double clear = clearance_of(walls_[s], x);
    if (clear >= least) continue;
    least = clear;
    name = walls_[s].name;
  }
  return name;
}

}  // namespace fluxpact
