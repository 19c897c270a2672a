#include "dem_server/walls/mesh_surface.hpp"

#include <map>

namespace fluxpact {
namespace {

/// Points of the mesh that the surface uses, each once.
class Points {
 public:
  Points(const Mesh& mesh, TriangleSurface& surface) : mesh_(mesh), surface_(surface) {}

  int number_of(int point) {
    const auto [at, added] = numbers_.try_emplace(point, size());
    if (added) surface_.points.push_back(mesh_.points[point]);
    return at->second;
  }
  int add(const Vector3& point) {
    surface_.points.push_back(point);
    return size() - 1;
  }

 private:
  int size() const { return static_cast<int>(surface_.points.size()); }

  const Mesh& mesh_;
  TriangleSurface& surface_;
  std::map<int, int> numbers_;
};

/// True if each triangle of the fan about corner `hub` points along the area of the face.
bool fans_outwards(const Mesh& mesh, std::span<const int> corners, std::size_t hub,
                   const Vector3& area) {
  const std::size_t size = corners.size();
  const Vector3& first = mesh.points[corners[hub]];
  for (std::size_t k = 1; k + 1 < size; ++k) {
    const Vector3 a = mesh.points[corners[(hub + k) % size]] - first;
    const Vector3 b = mesh.points[corners[(hub + k + 1) % size]] - first;
    // Corners on one line would make a triangle without a normal.
    if (a.cross(b).dot(area) <= 1e-9 * area.squaredNorm()) return false;
  }
  return true;
}

}  // namespace

TriangleSurface triangles_of(const Mesh& mesh, std::span<const int> faces) {
  TriangleSurface surface;
  Points points(mesh, surface);
  for (const int face : faces) {
    const auto first = static_cast<std::size_t>(mesh.face_offsets[face]);
    const auto size = static_cast<std::size_t>(mesh.face_offsets[face + 1]) - first;
    const std::span<const int> corners(&mesh.face_points[first], size);
    std::size_t hub = 0;
    while (hub < size && !fans_outwards(mesh, corners, hub, mesh.face_areas[face])) ++hub;
    if (hub < size) {
      for (std::size_t k = 1; k + 1 < size; ++k) {
        surface.triangles.push_back({points.number_of(corners[hub]),
                                     points.number_of(corners[(hub + k) % size]),
                                     points.number_of(corners[(hub + k + 1) % size])});
      }
      continue;
    }
    Vector3 mean = Vector3::Zero();
    for (const int corner : corners) mean += mesh.points[corner] / static_cast<double>(size);
    const int middle = points.add(mean);
    for (std::size_t k = 0; k < size; ++k) {
      surface.triangles.push_back(
          {middle, points.number_of(corners[k]), points.number_of(corners[(k + 1) % size])});
    }
  }
  return surface;
}

TriangleSurface with_periodic_images(TriangleSurface surface, const Domain& domain) {
  bool any = false;
  for (int axis = 0; axis < 3; ++axis) {
    if (!domain.periodic(axis)) continue;
    any = true;
    const double length = domain.length(axis);
    const std::size_t count = surface.triangles.size();
    const int points = static_cast<int>(surface.points.size());
    for (const int way : {-1, 1}) {
      const int shift = static_cast<int>(surface.points.size());
      for (int p = 0; p < points; ++p) {
        surface.points.push_back(surface.points[p] + way * length * Vector3::Unit(axis));
      }
      for (std::size_t t = 0; t < count; ++t) {
        const auto [a, b, c] = surface.triangles[t];
        const double centre =
            (surface.points[a][axis] + surface.points[b][axis] + surface.points[c][axis]) / 3;
        const bool low = centre < domain.lower[axis] + 0.5 * length;
        if (low == (way > 0)) surface.triangles.push_back({a + shift, b + shift, c + shift});
      }
    }
  }
  if (!any || surface.triangles.empty()) return surface;
  // Points of a periodic pair may differ by what the file's digits leave.
  return with_merged_points(surface, 1e-6 * (domain.upper - domain.lower).norm());
}

}  // namespace fluxpact
