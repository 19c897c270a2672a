// From the scene to its walls.
#include <cmath>
#include <limits>
#include <utility>

#include "dem_server/walls/mesh_surface.hpp"
#include "dem_server/walls/walls.hpp"
#include "proto/base/errors.hpp"
#include "proto/mesh/stl.hpp"

namespace fluxpact {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

void check_direction(const std::string& key, const Vector3& direction) {
  if (direction.allFinite() && direction.norm() > 0) return;
  throw ConfigError("{}: ({}, {}, {}) has no direction; e.g. [0, 0, 1]", key, direction.x(),
                    direction.y(), direction.z());
}

double from_axis(const MotionSettings& motion, const Vector3& x) {
  return (x - motion.point).cross(motion.direction.normalized()).norm();
}

/// True if the rotation leaves a body that is round about this axis where it is.
bool turns_in_itself(const MotionSettings& motion, const Vector3& point, const Vector3& axis) {
  const Vector3 spin = motion.direction.normalized();
  const double scale = 1 + point.norm() + motion.point.norm();
  return axis.cross(spin).norm() <= 1e-14 && from_axis(motion, point) <= 1e-14 * scale;
}

}  // namespace

/// Fills a Walls surface by surface.
class WallsMaker {
 public:
  explicit WallsMaker(const Domain& domain) {
    walls_.lower_ = domain.lower;
    walls_.upper_ = domain.upper;
  }

  void add_primitive(const std::string& name, const SurfaceSettings& settings) {
    const std::string key = "particles.surfaces." + name;
    WallSurface& surface = start(name, settings);
    surface.first_element = static_cast<int>(walls_.surface_of_primitive_.size());
    surface.elements = 1;
    surface.feature = features_;
    walls_.surface_of_primitive_.push_back(walls_.size() - 1);
    if (settings.type == SurfaceType::plane) {
      check_direction(key + ".normal", settings.normal);
      surface.point = settings.point;
      surface.normal = settings.normal.normalized();
      features_ += 1;
    } else {
      check_direction(key + ".direction", settings.direction);
      surface.tube = make_tube(settings);
      features_ += 3;  // the shell and its two rims
    }
    set_arm(surface);
  }

  /// After all primitives: the elements of triangles follow theirs.
  void add_triangles(const std::string& name, const SurfaceSettings& settings,
                     const TriangleSurface& triangles, const std::string& source) {
    WallSurface& surface = start(name, settings);
    const std::size_t first = walls_.facets_.facets.size();
    add_facets(triangles, walls_.size() - 1, source, walls_.facets_, features_);
    std::vector<Extent> boxes;
    for (std::size_t f = first; f < walls_.facets_.facets.size(); ++f) {
      const WallFacet& facet = walls_.facets_.facets[f];
      const Vector3 b = facet.corner + facet.side[0];
      const Vector3 c = facet.corner + facet.side[1];
      boxes.push_back({facet.corner.cwiseMin(b).cwiseMin(c), facet.corner.cwiseMax(b).cwiseMax(c)});
      if (settings.motion.type != MotionType::rotation) continue;
      for (const Vector3& corner : {facet.corner, b, c}) {
        surface.arm = std::max(surface.arm, from_axis(settings.motion, corner));
      }
    }
    surface.tree = BoxTree(boxes);
    surface.first_element = static_cast<int>(walls_.surface_of_primitive_.size() + first);
    surface.elements = static_cast<int>(boxes.size());
    if (walls_.facets_.facets.size() > most_facets) {
      throw ConfigError("{}: {} triangles in all walls; at most {} are counted, use a coarser one",
                        source, walls_.facets_.facets.size(), most_facets);
    }
  }

  Walls take() {
    walls_.place(0);
    return std::move(walls_);
  }

 private:
  static constexpr std::size_t most_facets = 1 << 28;  // two bits of an element are its side

  WallSurface& start(const std::string& name, const SurfaceSettings& settings) {
    const MotionSettings& motion = settings.motion;
    if (motion.type == MotionType::rotation) {
      check_direction("particles.surfaces." + name + ".motion.direction", motion.direction);
    }
    walls_.moving_ = walls_.moving_ || motion.type != MotionType::none;
    WallSurface& surface = walls_.surfaces_.emplace_back();
    surface.name = name;
    surface.material = settings.material;
    surface.type = settings.type;
    surface.side = settings.side;
    surface.motion = motion;
    return surface;
  }

  static void set_arm(WallSurface& surface) {
    const MotionSettings& motion = surface.motion;
    if (motion.type != MotionType::rotation) return;
    const Tube& tube = surface.tube;
    if (surface.type == SurfaceType::plane) {
      const bool square = surface.normal.cross(motion.direction.normalized()).norm() <= 1e-14;
      surface.arm = square ? 0 : infinity;
    } else if (turns_in_itself(motion, tube.start, tube.axis)) {
      surface.arm = 0;
    } else if (std::isinf(tube.length)) {
      surface.arm = infinity;
    } else {
      const Vector3 end = tube.start + tube.length * tube.axis;
      surface.arm = std::max(from_axis(motion, tube.start) + tube.radius,
                             from_axis(motion, end) + tube.end_radius);
    }
  }

  Walls walls_;
  std::int32_t features_ = 0;
};

Walls make_walls(const Scene& scene, const Mesh& mesh) {
  const Domain domain = particle_domain(scene, mesh);
  WallsMaker maker(domain);
  for (const auto& [name, settings] : scene.particles.surfaces) {
    if (settings.type != SurfaceType::stl) maker.add_primitive(name, settings);
  }
  if (scene.particles.walls == WallSource::from_mesh) {
    const std::vector<int> faces = faces_off_the_box(scene, mesh, domain);
    SurfaceSettings settings;
    settings.type = SurfaceType::stl;
    if (!faces.empty()) {
      maker.add_triangles("mesh", settings, with_periodic_images(triangles_of(mesh, faces), domain),
                          "fluid.mesh");
    }
  }
  for (const auto& [name, settings] : scene.particles.surfaces) {
    if (settings.type != SurfaceType::stl) continue;
    const TriangleSurface triangles = read_stl(settings.path, settings.scale);
    if (settings.side != SurfaceSide::both) {
      refuse_if_open("particles.surfaces." + name + ".side", settings.path,
                     measure_surface(triangles));
    }
    maker.add_triangles(name, settings, triangles, settings.path);
  }
  return maker.take();
}

}  // namespace fluxpact
