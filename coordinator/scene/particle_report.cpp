#include "coordinator/scene/particle_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "proto/scene/names.hpp"
#include "proto/scene/size_law.hpp"

namespace fluxpact {
namespace {

// Added mass is ρ/(2 ρ_p) of a sphere's own: 5 % of it at this ratio of the densities.
constexpr double light = 10;

struct Box {
  Vector3 lower, upper;  // [m]
};

Box box_of(const Region& within, const Mesh& mesh) {
  Box box{mesh.points.front(), mesh.points.front()};
  for (const Vector3& point : mesh.points) {
    box.lower = box.lower.cwiseMin(point);
    box.upper = box.upper.cwiseMax(point);
  }
  const std::array<const std::optional<std::array<double, 2>>*, 3> ranges{&within.x, &within.y,
                                                                          &within.z};
  for (int axis = 0; axis < 3; ++axis) {
    if (!ranges.at(axis)->has_value()) continue;
    box.lower[axis] = std::max(box.lower[axis], ranges.at(axis)->value()[0]);
    box.upper[axis] = std::min(box.upper[axis], ranges.at(axis)->value()[1]);
  }
  return box;
}

std::string sizes_text(const SizeLaw& sizes) {
  return sizes.smallest() == sizes.largest()
             ? fmt::format("{:.4g} m", sizes.largest())
             : fmt::format("{:.4g} .. {:.4g} m", sizes.smallest(), sizes.largest());
}

std::string amount_text(double count, const SizeLaw& sizes, double density) {
  return fmt::format("{}{:.0f} spheres of {}, {:.5g} kg",
                     sizes.smallest() == sizes.largest() ? "" : "about ", count, sizes_text(sizes),
                     count * sizes.mean_volume() * density);
}

/// Spheres of a lattice that fills the box, away from periodic sides.
double lattice_count(const InsertionSettings& entry, const Box& box) {
  const double spacing = entry.spacing > 0 ? entry.spacing : 1.001 * entry.diameter;
  double count = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double room = box.upper[axis] - box.lower[axis] - entry.diameter;
    count *= std::floor(room / spacing + 1e-9) + 1;
  }
  return std::max(count, 0.0);
}

std::string entry_text(const InsertionSettings& entry, const Mesh& mesh, double density) {
  if (entry.type == InsertionType::file) return fmt::format("as many as {} holds", entry.path);
  const SizeLaw sizes(entry.diameter, entry.sizes);
  const Box box = box_of(entry.within, mesh);
  const double volume = (box.upper - box.lower).prod();
  if (entry.type == InsertionType::lattice) {
    return amount_text(lattice_count(entry, box), sizes, density);
  }
  if (entry.height > 0) {
    return fmt::format(
        "a bed of {} up to {:.4g} m above its bottom; its count shows once it has "
        "settled",
        sizes_text(sizes), entry.height);
  }
  if (entry.fraction > 0) {
    return amount_text(std::round(entry.fraction * volume / sizes.mean_volume()), sizes, density);
  }
  if (entry.number_density > 0) {
    return amount_text(std::round(entry.number_density * volume), sizes, density);
  }
  return amount_text(entry.count, sizes, density);
}

std::string inflow_text(const Scene& scene, const InflowSettings& inflow, double density) {
  const SizeLaw sizes(inflow.diameter, inflow.sizes);
  const double mass = density * sizes.mean_volume();
  const double rate = inflow.number_rate > 0 ? inflow.number_rate : inflow.mass_rate / mass;
  const double end = std::min(inflow.stop.value_or(scene.scene.end_time), scene.scene.end_time);
  const double time = std::max(0.0, end - inflow.start);
  return fmt::format("{:.5g} 1/s of {}, {:.5g} kg/s; {:.5g} spheres, {:.5g} kg until {:.6g} s",
                     rate, sizes_text(sizes), rate * mass, std::floor(rate * time),
                     rate * time * mass, end);
}

}  // namespace

std::string particle_report(const Scene& scene, const Mesh& mesh) {
  std::string text;
  const ParticleSettings& particles = scene.particles;
  for (std::size_t i = 0; i < particles.insertion.size(); ++i) {
    const InsertionSettings& entry = particles.insertion[i];
    const double density = particles.materials.at(entry.material).density;
    text += fmt::format("  insertion {} ({}, {}): {}\n", i + 1, name_of(entry.type), entry.material,
                        entry_text(entry, mesh, density));
  }
  for (std::size_t i = 0; i < particles.inflow.size(); ++i) {
    const InflowSettings& inflow = particles.inflow[i];
    const double density = particles.materials.at(inflow.material).density;
    text += fmt::format("  inflow {} ({}): {}\n", i + 1, inflow.material,
                        inflow_text(scene, inflow, density));
  }
  return text;
}

std::optional<double> solid_fraction(const InsertionSettings& entry, const Mesh& mesh,
                                     double margin) {
  if (entry.type == InsertionType::file || entry.height > 0) return std::nullopt;
  const Box box = box_of(entry.within, mesh);
  const Vector3 size = box.upper - box.lower;
  const double sphere = SizeLaw(entry.diameter, entry.sizes).mean_volume();
  double solids = entry.count * sphere;
  if (entry.type == InsertionType::lattice) {
    solids = lattice_count(entry, box) * sphere;
  } else if (entry.fraction > 0) {
    solids = entry.fraction * size.prod();
  } else if (entry.number_density > 0) {
    solids = entry.number_density * size.prod() * sphere;
  }
  return solids / (size + Vector3::Constant(2 * margin)).prod();
}

std::vector<std::string> particle_warnings(const Scene& scene) {
  const ParticleSettings& particles = scene.particles;
  double least = std::numeric_limits<double>::infinity();  // [kg/m³]
  std::string of;
  const auto meet = [&](const std::string& material) {
    const double density = particles.materials.at(material).density;
    if (density >= least) return;
    least = density;
    of = material;
  };
  for (const InsertionSettings& entry : particles.insertion) {
    if (entry.motion == Mobility::free) meet(entry.material);
  }
  for (const InflowSettings& inflow : particles.inflow) meet(inflow.material);
  const double ratio = least / scene.fluid.density;
  const bool known = has_force(scene, InterphaseForce::added_mass);
  if (particles.backend == ParticleBackend::kinematic || known || ratio >= light) return {};
  return {fmt::format(
      "interphase.forces does not have 'added_mass', but particles of '{}' are only {:.3g} times "
      "as "
      "dense as the fluid: in an accelerating flow they bear {:.0f} % more than their own mass, "
      "and "
      "without it dense suspensions (above 1/4 of the volume) can be unstable; add it to "
      "interphase.forces",
      of, ratio, 50 / ratio)};
}

}  // namespace fluxpact
