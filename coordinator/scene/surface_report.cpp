#include "coordinator/scene/surface_report.hpp"

#include <fmt/format.h>

#include "proto/mesh/stl.hpp"

namespace fluxpact {

std::vector<std::string> surface_lines(const Scene& scene) {
  std::vector<std::string> lines;
  for (const auto& [name, surface] : scene.particles.surfaces) {
    if (surface.type != SurfaceType::stl) continue;
    const TriangleSurface triangles = read_stl(surface.path, surface.scale);
    const SurfaceQuality q = measure_surface(triangles);
    if (surface.side != SurfaceSide::both) {
      refuse_if_open("particles.surfaces." + name + ".side", surface.path, q);
    }
    lines.push_back(fmt::format(
        "surface {}: {} triangles within ({:.4g}, {:.4g}, {:.4g}) .. ({:.4g}, {:.4g}, {:.4g}) m; "
        "{}; shortest edge {:.3g} m, smallest triangle {} of {:.3g} m2",
        name, q.triangles, q.lower.x(), q.lower.y(), q.lower.z(), q.upper.x(), q.upper.y(),
        q.upper.z(),
        q.closed() ? "closed"
                   : fmt::format("open: {} open edges, {} with more than two triangles, {} whose "
                                 "triangles point to different sides",
                                 q.open_edges, q.crowded_edges, q.turned_edges),
        q.shortest_edge, q.smallest, q.smallest_area));
  }
  return lines;
}

}  // namespace fluxpact
