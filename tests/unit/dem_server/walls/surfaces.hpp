// Scenes with walls, and triangulated bodies, for the tests of the walls.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <random>
#include <string>

#include "dem_server/walls/walls.hpp"
#include "proto/mesh/box.hpp"

namespace fluxpact {

/// A box mesh of side 2 about the origin.
inline Scene wall_scene() {
  Scene scene;
  scene.fluid.mesh.box = {{-1, -1, -1}, {1, 1, 1}, {2, 2, 2}};
  scene.particles.materials["glass"].density = 2500;
  return scene;
}

inline SurfaceSettings plane(const Vector3& point, const Vector3& normal) {
  SurfaceSettings surface;
  surface.type = SurfaceType::plane;
  surface.point = point;
  surface.normal = normal;
  return surface;
}

inline SurfaceSettings cylinder(const Vector3& point, const Vector3& direction, double radius,
                                double length = 0) {
  SurfaceSettings surface;
  surface.type = SurfaceType::cylinder;
  surface.point = point;
  surface.direction = direction;
  surface.radius = radius;
  surface.length = length;
  return surface;
}

inline Walls walls_with(const SurfaceSettings& surface) {
  Scene scene = wall_scene();
  scene.particles.surfaces.emplace_back("wall", surface);
  return make_walls(scene, make_box(scene.fluid.mesh));
}

/// An ascii STL file that lives as long as the test.
class StlFile {
 public:
  explicit StlFile(const std::string& text, const std::string& name = "")
      : path_(::testing::UnitTest::GetInstance()->current_test_info()->name() + name + ".stl") {
    std::replace(path_.begin(), path_.end(), '/', '_');  // of a test with a parameter
    path_ = ::testing::TempDir() + "fluxpact_walls_" + path_;
    std::ofstream(path_, std::ios::binary) << text;
  }
  explicit StlFile(const TriangleSurface& surface, const std::string& name = "")
      : StlFile(text_of(surface), name) {}
  ~StlFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  StlFile(const StlFile&) = delete;
  StlFile& operator=(const StlFile&) = delete;
  const std::string& path() const { return path_; }

  SurfaceSettings surface() const {
    SurfaceSettings settings;
    settings.type = SurfaceType::stl;
    settings.path = path_;
    return settings;
  }

  /// All digits, so that the points are those of the surface to the last bit.
  static std::string text_of(const TriangleSurface& surface) {
    std::string text = "solid test\n";
    for (const auto& triangle : surface.triangles) {
      text += "facet normal 0 0 0\n outer loop\n";
      for (const int corner : triangle) {
        const Vector3& p = surface.points[corner];
        text += fmt::format("  vertex {} {} {}\n", p.x(), p.y(), p.z());
      }
      text += " endloop\nendfacet\n";
    }
    return text + "endsolid test\n";
  }

 private:
  std::string path_;
};

/// A rectangle corner + u [0, 1] + v [0, 1] in n x m pairs of triangles, in front of it u x v.
inline TriangleSurface sheet(const Vector3& corner, const Vector3& u, const Vector3& v, int n,
                             int m) {
  TriangleSurface surface;
  for (int j = 0; j <= m; ++j) {
    for (int i = 0; i <= n; ++i) surface.points.push_back(corner + u * i / n + v * j / m);
  }
  const auto at = [n](int i, int j) { return i + (n + 1) * j; };
  for (int j = 0; j < m; ++j) {
    for (int i = 0; i < n; ++i) {
      surface.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      surface.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return surface;
}

inline void append(TriangleSurface& to, const TriangleSurface& from) {
  const int shift = static_cast<int>(to.points.size());
  to.points.insert(to.points.end(), from.points.begin(), from.points.end());
  for (const auto& [a, b, c] : from.triangles) {
    to.triangles.push_back({a + shift, b + shift, c + shift});
  }
}

/// The cube [-half, half]³ with n x n pairs of triangles on each side, pointing out.
inline TriangleSurface cube(double half, int n) {
  TriangleSurface surface;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 w = Vector3::Unit(axis);
    const Vector3 u = Vector3::Unit((axis + 1) % 3);
    const Vector3 v = Vector3::Unit((axis + 2) % 3);
    append(surface, sheet(half * (w - u - v), 2 * half * u, 2 * half * v, n, n));
    append(surface, sheet(half * (-w - u - v), 2 * half * v, 2 * half * u, n, n));
  }
  return surface;
}

/// A ball about the origin: an octahedron whose triangles were cut in four `levels` times, pointing
/// out.
inline TriangleSurface ball(double radius, int levels) {
  TriangleSurface surface;
  for (int axis = 0; axis < 3; ++axis) {
    surface.points.push_back(Vector3::Unit(axis));
    surface.points.push_back(-Vector3::Unit(axis));
  }
  surface.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                       {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [at, added] = middles.try_emplace({std::min(a, b), std::max(a, b)},
                                                   static_cast<int>(surface.points.size()));
      if (added) {
        surface.points.push_back((surface.points[a] + surface.points[b]).normalized());
      }
      return at->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& [a, b, c] : surface.triangles) {
      const int ab = middle(a, b);
      const int bc = middle(b, c);
      const int ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    surface.triangles = std::move(finer);
  }
  for (Vector3& point : surface.points) point *= radius;
  return surface;
}

/// A cylinder about the z axis from -half to half with n facets of m pairs of triangles, pointing
/// out, open at its ends. WallFacet k lies about the angle 2 π (k + 1/2)/n.
inline TriangleSurface tube_of_facets(double radius, double half, int n, int m) {
  TriangleSurface surface;
  for (int k = 0; k < n; ++k) {
    const auto at = [&](int i) {
      const double angle = 2 * std::numbers::pi * (i % n) / n;
      return Vector3(radius * std::cos(angle), radius * std::sin(angle), -half);
    };
    append(surface, sheet(at(k), at(k + 1) - at(k), {0, 0, 2 * half}, 1, m));
  }
  return surface;
}

/// What a sphere touches, with a list made there and then.
inline std::vector<WallTouch> touches_at(const Walls& walls, const Vector3& x, double radius) {
  std::vector<int> elements;
  EXPECT_TRUE(walls.nearby(x, 1.2 * radius, {}, elements));
  std::vector<WallTouch> touches(most_wall_touches);
  const int count = walls.touches(x, radius, elements, touches);
  EXPECT_GE(count, 0);
  touches.resize(static_cast<std::size_t>(std::max(count, 0)));
  return touches;
}

inline Vector3 random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Vector3(normal(random), normal(random), normal(random)).normalized();
}

}  // namespace fluxpact
