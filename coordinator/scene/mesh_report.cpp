#include "coordinator/scene/mesh_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "proto/mesh/mesh_quality.hpp"
#include "proto/scene/size_law.hpp"

namespace fluxpact {
namespace {

/// The largest diameter that the scene names [m], 0 without particles. A file of particles may
/// hold others in a column of its own.
double largest_diameter(const Scene& scene) {
  double largest = 0;
  for (const InsertionSettings& entry : scene.particles.insertion) {
    largest = std::max(largest, SizeLaw(entry.diameter, entry.sizes).largest());
  }
  for (const InflowSettings& inflow : scene.particles.inflow) {
    largest = std::max(largest, SizeLaw(inflow.diameter, inflow.sizes).largest());
  }
  return largest;
}

std::string place_of(const Worst& worst) {
  return fmt::format("at ({:.4g}, {:.4g}, {:.4g}) m", worst.place.x(), worst.place.y(),
                     worst.place.z());
}

std::string patches_of(const Mesh& mesh) {
  std::vector<std::string> patches;
  for (const Patch& patch : mesh.patches) {
    patches.push_back(fmt::format("{} {}", patch.name, patch.size));
  }
  if (!mesh.periodic_faces.empty()) {
    patches.push_back(fmt::format("(periodic {})", mesh.periodic_faces.size()));
  }
  return patches.empty() ? "none" : fmt::format("{}", fmt::join(patches, ", "));
}

/// Below three diameters a particle that crosses a face moves much of a cell's solids at once.
constexpr double centroid_needs = 3;

// Below this many diameters a cell holds a sphere or a gap, not a mean of some.
constexpr double single_spheres = 1.5;

std::string notes(const Scene& scene, const MeshQuality& quality, double diameter) {
  std::string text;
  if (quality.steep_faces > 0) {
    text += fmt::format(
        "  warning: {} faces are beyond {} degrees, the worst {}; expect a loss of accuracy and "
        "slow convergence there\n",
        quality.steep_faces, steep_angle, place_of(quality.non_orthogonality));
  }
  if (quality.outside_faces > 0) {
    text += fmt::format(
        "  warning: {} faces do not lie between the centres of their cells; the most skewed {}\n",
        quality.outside_faces, place_of(quality.skewness));
  }
  if (scene.interphase.voidage.map == VoidageMap::centroid && diameter > 0 &&
      quality.smallest_cell < centroid_needs * diameter) {
    text += fmt::format(
        "  note: interphase.voidage: centroid wants cells of {} diameters, the smallest has "
        "{:.3g}; `exact` takes any\n",
        centroid_needs, quality.smallest_cell / diameter);
  }
  const VoidageMap map = scene.interphase.voidage.map;
  if ((map == VoidageMap::exact || map == VoidageMap::satellite) && diameter > 0 &&
      quality.smallest_cell < single_spheres * diameter) {
    text += fmt::format(
        "  note: the smallest cell has {:.3g} diameters: below {} the voidage is that of single "
        "spheres, and cells in a sphere pass on what they cannot hold; `kernel` and `diffusion` of "
        "interphase.voidage smooth it over a width\n",
        quality.smallest_cell / diameter, single_spheres);
  }
  return text;
}

}  // namespace

std::string mesh_report(const Scene& scene, const Mesh& mesh) {
  const MeshQuality q = measure_quality(mesh);
  const double diameter = largest_diameter(scene);
  std::string text = fmt::format("mesh: {} cells, {} faces, {} points; patches: {}\n", mesh.cells(),
                                 mesh.faces(), mesh.points.size(), patches_of(mesh));
  const auto row = [&](const char* name, const std::string& value, const std::string& where) {
    text += fmt::format("  {:<28}{:<22}{}\n", name, value, where);
  };
  const auto number = [](double value) { return fmt::format("{:.3g}", value); };
  if (mesh.internal_faces() > 0) {
    row("non-orthogonality [deg]",
        fmt::format("{:.1f}, mean {:.1f}", q.non_orthogonality.value, q.mean_non_orthogonality),
        place_of(q.non_orthogonality));
    row("skewness", number(q.skewness.value), place_of(q.skewness));
    row("volume ratio of neighbours", number(q.volume_ratio.value), place_of(q.volume_ratio));
  }
  row("aspect ratio", number(q.aspect_ratio.value), place_of(q.aspect_ratio));
  row("cell size [m]", fmt::format("{:.3g} .. {:.3g}", q.smallest_cell, q.largest_cell), "");
  if (diameter > 0) {
    row("cell size / particle",
        fmt::format("{:.3g} .. {:.3g}", q.smallest_cell / diameter, q.largest_cell / diameter), "");
  }
  return text + notes(scene, q, diameter);
}

std::string mesh_line(const Scene& scene, const Mesh& mesh) {
  const MeshQuality q = measure_quality(mesh);
  const double diameter = largest_diameter(scene);
  std::string text = fmt::format(
      "mesh: {} cells of {:.3g} .. {:.3g} m, {} faces; patches: {}; non-orthogonality {:.1f} deg, "
      "skewness {:.3g}, aspect ratio {:.3g}, volume ratio {:.3g}",
      mesh.cells(), q.smallest_cell, q.largest_cell, mesh.faces(), patches_of(mesh),
      q.non_orthogonality.value, q.skewness.value, q.aspect_ratio.value, q.volume_ratio.value);
  if (diameter > 0)
    text += fmt::format(", cell size / particle {:.3g}", q.smallest_cell / diameter);
  return text;
}

}  // namespace fluxpact
