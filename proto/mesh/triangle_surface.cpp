#include "proto/mesh/triangle_surface.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

/// Points in cubes far larger than the tolerance, so that few lookups go to more than one.
class PointMerger {
 public:
  explicit PointMerger(double tolerance) : tolerance_(tolerance), size_(1e3 * tolerance) {}

  /// The number of the first point within the tolerance of this one, which may be itself.
  int number_of(const Vector3& point) {
    std::array<std::int64_t, 3> low{};
    std::array<std::int64_t, 3> high{};
    for (int axis = 0; axis < 3; ++axis) {
      low.at(axis) = cube(point[axis] - tolerance_);
      high.at(axis) = cube(point[axis] + tolerance_);
    }
    for (std::int64_t i = low[0]; i <= high[0]; ++i) {
      for (std::int64_t j = low[1]; j <= high[1]; ++j) {
        for (std::int64_t k = low[2]; k <= high[2]; ++k) {
          const auto [begin, end] = cubes_.equal_range(key(i, j, k));
          for (auto at = begin; at != end; ++at) {
            if ((points_[at->second] - point).norm() <= tolerance_) return at->second;
          }
        }
      }
    }
    const int number = static_cast<int>(points_.size());
    points_.push_back(point);
    cubes_.emplace(key(cube(point.x()), cube(point.y()), cube(point.z())), number);
    return number;
  }

  std::vector<Vector3> take() { return std::move(points_); }

 private:
  std::int64_t cube(double x) const { return static_cast<std::int64_t>(std::floor(x / size_)); }
  static std::uint64_t key(std::int64_t i, std::int64_t j, std::int64_t k) {
    // Two cubes with one key cost a comparison more, nothing else.
    const auto mix = [](std::int64_t v, std::uint64_t factor) {
      return static_cast<std::uint64_t>(v) * factor;
    };
    return mix(i, 0x9e3779b97f4a7c15U) ^ mix(j, 0xc2b2ae3d27d4eb4fU) ^ mix(k, 0x165667b19e3779f9U);
  }

  double tolerance_;
  double size_;
  std::vector<Vector3> points_;
  std::unordered_multimap<std::uint64_t, int> cubes_;
};

Vector3 area_of(const TriangleSurface& surface, const std::array<int, 3>& t) {
  const Vector3& a = surface.points[t[0]];
  return 0.5 * (surface.points[t[1]] - a).cross(surface.points[t[2]] - a);
}

}  // namespace

SurfaceEdges find_edges(const TriangleSurface& surface) {
  struct Half {
    std::array<int, 2> points;
    SurfaceEdges::Side side;
  };
  std::vector<Half> halves;
  halves.reserve(3 * surface.triangles.size());
  for (int t = 0; t < static_cast<int>(surface.triangles.size()); ++t) {
    const std::array<int, 3>& corners = surface.triangles[t];
    for (int s = 0; s < 3; ++s) {
      const int a = corners.at(s);
      const int b = corners.at((s + 1) % 3);
      halves.push_back({{std::min(a, b), std::max(a, b)}, {t, s, a < b}});
    }
  }
  std::stable_sort(halves.begin(), halves.end(),
                   [](const Half& a, const Half& b) { return a.points < b.points; });
  SurfaceEdges edges;
  edges.of.resize(surface.triangles.size());
  for (const Half& half : halves) {
    if (edges.edges.empty() || edges.edges.back().points != half.points) {
      edges.edges.push_back({half.points, static_cast<int>(edges.sides.size()), 0});
    }
    ++edges.edges.back().count;
    edges.sides.push_back(half.side);
    edges.of[half.side.triangle].at(half.side.side) = static_cast<int>(edges.edges.size()) - 1;
  }
  return edges;
}

TriangleSurface with_merged_points(const TriangleSurface& surface, double tolerance) {
  PointMerger merger(tolerance);
  TriangleSurface merged;
  std::vector<int> became;
  became.reserve(surface.points.size());
  for (const Vector3& point : surface.points) became.push_back(merger.number_of(point));
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto [a, b, c] = surface.triangles[t];
    const std::array<int, 3> corners{became[a], became[b], became[c]};
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    merged.triangles.push_back(corners);
    merged.number.push_back(surface.number.empty() ? static_cast<int>(t) + 1 : surface.number[t]);
  }
  merged.points = merger.take();
  return merged;
}

SurfaceQuality measure_surface(const TriangleSurface& surface) {
  SurfaceQuality quality;
  quality.triangles = static_cast<int>(surface.triangles.size());
  if (surface.triangles.empty()) return quality;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  quality.lower.setConstant(infinity);
  quality.upper.setConstant(-infinity);
  quality.smallest_area = quality.shortest_edge = infinity;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const std::array<int, 3>& corners = surface.triangles[t];
    for (const int corner : corners) {
      quality.lower = quality.lower.cwiseMin(surface.points[corner]);
      quality.upper = quality.upper.cwiseMax(surface.points[corner]);
    }
    const double area = area_of(surface, corners).norm();
    if (area >= quality.smallest_area) continue;
    quality.smallest_area = area;
    quality.smallest = surface.number.empty() ? static_cast<int>(t) + 1 : surface.number[t];
  }
  const SurfaceEdges edges = find_edges(surface);
  for (const SurfaceEdge& edge : edges.edges) {
    quality.open_edges += edge.count == 1 ? 1 : 0;
    quality.crowded_edges += edge.count > 2 ? 1 : 0;
    quality.turned_edges +=
        edge.count == 2 && edges.sides[edge.first].along == edges.sides[edge.first + 1].along ? 1
                                                                                              : 0;
    const Vector3 along = surface.points[edge.points[1]] - surface.points[edge.points[0]];
    quality.shortest_edge = std::min(quality.shortest_edge, along.norm());
  }
  return quality;
}

void refuse_if_open(const std::string& key, const std::string& source,
                    const SurfaceQuality& quality) {
  if (quality.closed()) return;
  throw ConfigError(
      "{}: {} is not closed ({} open edges, {} with more than two triangles, {} whose triangles "
      "point to different sides), so nothing is inside or outside; mend it, or use `side: both`",
      key, source, quality.open_edges, quality.crowded_edges, quality.turned_edges);
}

double enclosed_volume(const TriangleSurface& surface) {
  if (surface.triangles.empty()) return 0;
  const Vector3 origin = surface.points[surface.triangles.front()[0]];
  double volume = 0;
  for (const std::array<int, 3>& corners : surface.triangles) {
    volume += area_of(surface, corners).dot(surface.points[corners[0]] - origin) / 3.0;
  }
  return volume;
}

}  // namespace fluxpact
