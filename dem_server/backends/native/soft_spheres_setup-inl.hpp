// What follows from the scene and the particles before the first sub-step.
#pragma once

#include "dem_server/backends/native/soft_spheres.hpp"
#include "proto/scene/size_law.hpp"

namespace fluxpact {

/// List pairs per particle against rebuilds: near the best from a bed at rest to one that bubbles.
inline constexpr double least_slack_per_diameter = 0.075;
inline constexpr double most_slack_per_diameter = 0.3;
inline constexpr int sub_steps_of_a_list = 30;

/// Pairs of the list name their law by one byte.
inline void check_law_indices(const ContactLaws& laws) {
  if (laws.count() <= 256) return;
  throw ConfigError(
      "particles.materials: {} materials; the native engine tells at most 15 apart, so give those "
      "that behave alike one name",
      laws.walls());
}

/// Velocities and spins as bodies of this precision have them, so that presented rows and bodies
/// tell the same.
template <class Real>
ParticleState as_held(ParticleState particles) {
  if constexpr (sizeof(Real) == sizeof(double)) return particles;
  const auto rounded = [](double number) { return static_cast<double>(static_cast<Real>(number)); };
  for (int row = 0; row < particles.size(); ++row) {
    const double radius = particles.radius[row];
    for (int axis = 0; axis < 3; ++axis) {
      double& velocity = particles.velocity[row][axis];
      double& spin = particles.spin[row][axis];
      velocity = rounded(velocity);
      spin = rounded(radius * spin) / radius;
    }
  }
  return particles;
}

/// Of particles that all have the same mass, and are free.
inline RootMasses common_root_masses(const ParticleState& particles) {
  const int count = particles.size();
  const auto mass = [&](int row) {
    return sphere_mass(particles.radius[row], particles.density[row]);
  };
  for (int row = 0; row < count; ++row) {
    if (mass(row) != mass(0) || particles.is_fixed(row)) return {};
  }
  if (count == 0) return {};
  return {std::sqrt(mass(0) / 2), std::sqrt(mass(0))};
}

template <class Real, bool turning>
SoftSpheres<Real, turning>::SoftSpheres(const Scene& scene, const Mesh& mesh, ContactLaws laws,
                                        ParticleState initial)
    : domain_(particle_domain(scene, mesh)),
      laws_(std::move(laws)),
      law_table_(law_table<Real>(laws_)),
      gravity_(scene.scene.gravity),
      flow_(particles_flow(scene)),
      walls_(make_walls(scene, mesh)),
      presented_(as_held<Real>(checked_rows(std::move(initial), laws_.walls()))) {
  const auto is = [this](SideKind kind) {
    return std::find(domain_.sides.begin(), domain_.sides.end(), kind) != domain_.sides.end();
  };
  any_periodic_ = is(SideKind::periodic);
  const int asked = scene.particles.numerics.threads;
  threads_ = asked > 0 ? asked : omp_get_max_threads();
  if (is(SideKind::wall)) walls_present_.push_back({laws_.walls(), 0});
  name_walls();
  expect_inflow(scene);
  time_step_ = scene.coupling.window / sub_steps(scene);
  check_law_indices(laws_);
  size_up();
  check_inflow();
  tabulate_sides();
  const int count = presented_.size();
  bodies_.reserve(count);
  for (int row = 0; row < count; ++row) bodies_.push_back(body_of(row));
  lists_[list_].row.resize(count);
  std::iota(lists_[list_].row.begin(), lists_[list_].row.end(), 0);
  check(0, 0, 0);
  loads_.resize(count);
  sort_and_list(nullptr, false);
  // Forces of contacts that exist from the start, with their springs at rest.
  sweep(Phase::settle, 0, 0);
  committed_list_ = list_;
  present();
}

/// The materials of the surfaces.
template <class Real, bool turning>
void SoftSpheres<Real, turning>::name_walls() {
  for (int surface = 0; surface < walls_.size(); ++surface) {
    int material = 0;
    while (material < laws_.walls() && laws_.name(material) != walls_[surface].material) ++material;
    surface_materials_.push_back(material);
    auto known = std::ranges::find(walls_present_, material, &WallsPresent::material);
    if (known == walls_present_.end()) {
      known = walls_present_.insert(known, {material, 0});
    }
    known->speed = std::max(known->speed, walls_.fastest(surface));
  }
}

/// What comes in later must not be refused then.
template <class Real, bool turning>
void SoftSpheres<Real, turning>::expect_inflow(const Scene& scene) {
  for (const InflowSettings& inflow : scene.particles.inflow) {
    const auto& materials = scene.particles.materials;
    const auto material = materials.find(inflow.material);
    if (material == materials.end()) continue;  // an error of the inflow's own
    const SizeLaw sizes(inflow.diameter, inflow.sizes);
    for (const double diameter : {sizes.smallest(), sizes.largest()}) {
      to_come_.id.push_back(to_come_.size() + 1);
      to_come_.position.emplace_back(Vector3::Zero());
      to_come_.velocity.push_back(inflow.velocity);
      to_come_.spin.emplace_back(Vector3::Zero());
      to_come_.radius.push_back(0.5 * diameter);
      to_come_.density.push_back(material->second.density);
      to_come_.material.push_back(static_cast<int>(std::distance(materials.begin(), material)));
    }
  }
}

/// Throws for those that particles.inflow can bring as `size_up` does for those that are there.
template <class Real, bool turning>
void SoftSpheres<Real, turning>::check_inflow() const {
  if (to_come_.size() == 0) return;
  ParticleState all = presented_;
  all.fixed.resize(all.fixed.empty() ? 0 : all.id.size() + to_come_.id.size(), 0);
  const auto append = [](auto& values, const auto& more) {
    values.insert(values.end(), more.begin(), more.end());
  };
  append(all.id, to_come_.id);
  append(all.position, to_come_.position);
  append(all.velocity, to_come_.velocity);
  append(all.radius, to_come_.radius);
  append(all.density, to_come_.density);
  append(all.material, to_come_.material);
  StepLimit limit = step_limit(laws_, all, walls_present_);
  if (limit.longest < sizes_.limit.longest) limit.reason += ", once particles.inflow has begun";
  check_time_step(limit, time_step_);
  const double largest = 2 * *std::ranges::max_element(all.radius);
  check_periods(
      domain_, largest,
      largest * (1 + 2 * least_slack_per_diameter) + reach_beyond_contact(laws_, 0.5 * largest));
}

template <class Real, bool turning>
void SoftSpheres<Real, turning>::place_walls(double time) {
  placed_at_ = time;
  if (walls_.moving()) walls_.place(time);
}

/// True if a surface may have come near a particle that the list does not know of.
template <class Real, bool turning>
bool SoftSpheres<Real, turning>::walls_moved_far() const {
  const Slack& slack = sizes_.slack;
  const double reach = sizes_.largest_radius + slack.least + slack.most;
  return walls_.moving() && walls_.travelled(lists_[list_].time, reach) > slack.least;
}

template <class Real, bool turning>
void SoftSpheres<Real, turning>::check_surfaces() const {
  const List& list = lists_[list_];
  for (int b = 0; b < list.blocks.count(); ++b) {
    const int place = list.block[b].surfaces.lost;
    if (place >= 0) refuse_lost_in_surface(presented_.id[list.row[list.blocks.first(b) + place]]);
  }
}

/// Lengths and limits that follow from the particles.
template <class Real, bool turning>
void SoftSpheres<Real, turning>::size_up() {
  double largest = 0;
  double mean = 0;
  for (const double radius : presented_.radius) {
    largest = std::max(largest, 2 * radius);
    mean += 2 * radius / presented_.size();
  }
  sizes_.largest_radius = 0.5 * largest;
  sizes_.beyond_contact = reach_beyond_contact(laws_, 0.5 * largest);
  sizes_.root_masses = common_root_masses(presented_);
  sizes_.limit = step_limit(laws_, presented_, walls_present_);
  Slack& slack = sizes_.slack;
  slack.least = least_slack_per_diameter * mean;
  slack.most = most_slack_per_diameter * mean;
  slack.flight = sub_steps_of_a_list * time_step_;
  check_periods(domain_, largest, largest + 2 * slack.least + sizes_.beyond_contact);
  for (int axis = 0; axis < 3; ++axis) {
    if (!domain_.periodic(axis)) continue;  // no farther than to the next image
    const double free = domain_.length(axis) - largest - sizes_.beyond_contact;
    slack.most = std::max(slack.least, std::min(slack.most, 0.5 * free));
  }
  check_time_step(sizes_.limit, time_step_);
}

template <class Real, bool turning>
void SoftSpheres<Real, turning>::tabulate_sides() {
  const std::array<Vector3, 27> shifts = shift_vectors(domain_);
  for (int code = 0; code < 27; ++code) {
    for (int axis = 0; axis < 3; ++axis) shifts_[code][axis] = shifts[code][axis];
  }
  for (int side = 0; side < 6; ++side) {
    const double inward = side % 2 == 0 ? 1.0 : -1.0;
    planes_[side][side / 2] = inward;
    planes_[side][3] = inward * domain_.plane(side);
  }
}

template <class Real, bool turning>
auto SoftSpheres<Real, turning>::body_of(int row) const -> BodyRow {
  const double radius = presented_.radius[row];
  BodyRow body{};
  body.radius = radius;
  if (!presented_.is_fixed(row)) {
    body.inverse_mass = static_cast<Real>(1 / sphere_mass(radius, presented_.density[row]));
  }
  if constexpr (turning) body.inverse_radius = static_cast<Real>(1 / radius);
  set_motion(row, body);
  return body;
}

/// Of a body that has its radius.
template <class Real, bool turning>
void SoftSpheres<Real, turning>::set_motion(int row, BodyRow& body) const {
  for (int axis = 0; axis < 3; ++axis) {
    body.position[axis] = presented_.position[row][axis];
    body.velocity[axis] = static_cast<Real>(presented_.velocity[row][axis]);
    if constexpr (turning) {
      body.radius_spin[axis] = static_cast<Real>(body.radius * presented_.spin[row][axis]);
    }
  }
}

}  // namespace fluxpact
