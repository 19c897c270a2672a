#include "coordinator/scene/self_disturbance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coordinator/scene/particle_report.hpp"
#include "proto/scene/names.hpp"
#include "proto/scene/size_law.hpp"

namespace fluxpact {
namespace {

constexpr double few = 0.01;       // solid fraction within four cells: else neighbours disturb more
constexpr double worth_it = 0.01;  // share of the slip

/// Drag over that of Stokes (Schiller and Naumann 1933).
double over_stokes(double reynolds) { return 1 + 0.15 * std::pow(reynolds, 0.687); }

/// What carries the momentum away from a cube or bell of `size` diameters, over 3π μ d f.
double carried_away(double still, double swept, double size, double reynolds) {
  return (still * size + swept * reynolds * size * size) /
         (3 * std::numbers::pi * over_stokes(reynolds));
}

bool narrow(VoidageMap map) {
  return map == VoidageMap::exact || map == VoidageMap::centroid || map == VoidageMap::satellite;
}

double mean_edge(const Mesh& mesh) {
  double volume = 0;
  for (const double cell : mesh.cell_volumes) volume += cell;
  return std::cbrt(volume / static_cast<double>(mesh.cell_volumes.size()));
}

/// Of a correction that is for single spheres.
std::vector<std::string> warnings_of_many(const Scene& scene, const Mesh& mesh) {
  for (const InsertionSettings& entry : scene.particles.insertion) {
    const std::optional<double> fraction = solid_fraction(entry, mesh, 4 * mean_edge(mesh));
    if (!fraction || *fraction < few) continue;
    return {fmt::format(
        "interphase.self_disturbance 'corrected' is for single spheres, and those of '{}' fill "
        "{:.2g} % of where they begin: drag laws of beds mean the flow that all spheres have made; "
        "take self_disturbance: none (docs/theory.md, section 3)",
        entry.material, 100 * *fraction)};
  }
  return {};
}

struct Worst {
  double share = 0;
  double diameter = 0;  // [m]
  double reynolds = 0;
  std::string material;
};

}  // namespace

double self_disturbance(double cells, double reynolds) {
  return 1 / (1 + carried_away(9, 1.5, cells, reynolds));
}

double wide_enough(double reynolds) {
  // A Gaussian force of width W, seen through the same Gaussian: in creeping flow the mean of its
  // own velocity is F/(6π μ σ √π) (Maxey and Patel 2001), σ = W/2.355; swept, half of it has acted
  // on the fluid that meets it, F/(2 ρ u 4π σ²).
  constexpr double still = 14.2;
  constexpr double swept = 4.53;
  constexpr double left = 0.005;
  double low = 0;
  double high = 1e5;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (carried_away(still, swept, middle, reynolds) < 1 / left - 1 ? low : high) = middle;
  }
  return high;
}

double terminal_reynolds(const FluidSettings& fluid, double gravity, double diameter,
                         double density) {
  // Re f(Re) = Archimedes' number/18; the left side rises.
  const double driven = gravity * std::abs(density - fluid.density) * fluid.density * diameter *
                        diameter * diameter / (18 * fluid.viscosity * fluid.viscosity);
  double low = 0;
  double high = driven;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (middle * over_stokes(middle) < driven ? low : high) = middle;
  }
  return high;
}

std::vector<std::string> self_disturbance_warnings(const Scene& scene, const Mesh& mesh) {
  const double gravity = scene.scene.gravity.norm();
  const InterphaseSettings& interphase = scene.interphase;
  if (interphase.self_disturbance == SelfDisturbance::corrected)
    return warnings_of_many(scene, mesh);
  if (!narrow(interphase.voidage.map) || interphase.drag == DragLaw::none || gravity == 0) {
    return {};
  }
  const double edge = mean_edge(mesh);
  Worst worst;
  for (const InsertionSettings& entry : scene.particles.insertion) {
    const std::optional<double> fraction = solid_fraction(entry, mesh, 4 * edge);
    if (!fraction || *fraction >= few) continue;
    const double diameter = SizeLaw(entry.diameter, entry.sizes).largest();
    const double density = scene.particles.materials.at(entry.material).density;
    const double reynolds = terminal_reynolds(scene.fluid, gravity, diameter, density);
    const double share = self_disturbance(edge / diameter, reynolds);
    if (share > worst.share) worst = {share, diameter, reynolds, entry.material};
  }
  if (worst.share <= worth_it) return {};
  const double width = std::max(wide_enough(worst.reynolds) * worst.diameter, 4 * edge);
  return {fmt::format(
      "interphase.voidage.map '{}' in cells of {:.2g} diameters: a sphere of '{}' slows down the "
      "fluid that it sees, and its drag can be up to {:.2g} % too small (at its terminal slip, Re "
      "= "
      "{:.2g}); where single particles matter take self_disturbance: corrected in cells of "
      "five diameters and more, or map: kernel or diffusion with width: {:.2g} m "
      "(docs/theory.md, section 3)",
      name_of(scene.interphase.voidage.map), edge / worst.diameter, worst.material,
      100 * worst.share, worst.reynolds, width)};
}

}  // namespace fluxpact
