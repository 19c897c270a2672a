#include "dem_server/insertion/settling.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "dem_server/backends/native/native_engine.hpp"
#include "proto/base/errors.hpp"
#include "proto/mesh/box.hpp"

namespace fluxpact {
namespace {

/// At rest: mean kinetic energy over m g d.
constexpr double rest = 1e-5;
/// Looser than a settled bed of any friction, so that every sphere comes down.
constexpr std::array<double, 4> loose_fractions{0.53, 0.48, 0.42, 0.3};
/// Denser than a settled bed, so that enough comes down to fill the height.
constexpr double dense_fraction = 0.66;
/// Overlap at the bottom of the bed while it is soft, of the diameter.
constexpr double soft_overlap = 0.02;
constexpr int sub_steps_of_window = 20;
constexpr int windows_of_log = 50;

/// A bed on its way down.
struct Settling {
  const std::string& entry;
  const Scene& scene;
  int up = 2;                    ///< axis against gravity
  double sign = 1;               ///< +1: up is towards larger coordinates
  double gravity = 0;            ///< [m/s²]
  double diameter = 0;           ///< mean [m]
  double height = 0;             ///< of the loose packing [m]
  double density = 0;            ///< [kg/m³]
  PackingBox room{};             ///< of the loose packing
  const Mesh* vessel = nullptr;  ///< the mesh that holds it, if that is no box

  double above_bottom(const PackingBox& box, const Vector3& x) const {
    return sign > 0 ? x[up] - box.lower[up] : box.upper[up] - x[up];
  }
};

/// The axis along which gravity points down.
void find_up(Settling& bed) {
  const Vector3& gravity = bed.scene.scene.gravity;
  bed.gravity = gravity.norm();
  gravity.cwiseAbs().maxCoeff(&bed.up);
  bed.sign = gravity[bed.up] < 0 ? 1 : -1;
  if (bed.gravity > 0 && std::abs(gravity[bed.up]) >= (1 - 1e-6) * bed.gravity) return;
  throw ConfigError(
      "{}: a bed settles along an axis, but scene.gravity is ({}, {}, {}) m/s²; settle it with "
      "another gravity and read it from its results.h5 (type: file)",
      bed.entry, gravity.x(), gravity.y(), gravity.z());
}

/// Volume [m³] of the room up to `height` [m] above its bottom: of a mesh, the cells whose centres
/// are.
double volume_below(const Settling& bed, const PackingBox& box, double height) {
  if (bed.vessel == nullptr) {
    return box.volume() / (box.upper[bed.up] - box.lower[bed.up]) * height;
  }
  double volume = 0;
  for (int cell = 0; cell < bed.vessel->cells(); ++cell) {
    if (bed.above_bottom(box, bed.vessel->cell_centres[cell]) <= height) {
      volume += bed.vessel->cell_volumes[cell];
    }
  }
  return volume;
}

/// Least of the heights [m] up to `most` below which the room has `volume` [m³], or `most`.
double height_of(const Settling& bed, const PackingBox& box, double volume, double most) {
  double low = 0;
  double high = most;
  for (int halving = 0; halving < 40; ++halving) {
    const double middle = 0.5 * (low + high);
    (volume_below(bed, box, middle) < volume ? low : high) = middle;
  }
  return high;
}

/// Places of a loose packing on the bottom of the box, up to the end of the domain if need be.
std::vector<Vector3> pack_loosely(Settling& bed, const PackingBox& box, const Domain& domain,
                                  std::span<const double> diameters, std::uint64_t seed) {
  double solids = 0;
  for (const double diameter : diameters) solids += sphere_volume(diameter);
  const double largest = *std::max_element(diameters.begin(), diameters.end());
  const double most = bed.sign > 0 ? domain.upper[bed.up] - box.lower[bed.up]
                                   : box.upper[bed.up] - domain.lower[bed.up];
  for (const double fraction : loose_fractions) {
    const double height = std::min(most, height_of(bed, box, solids / fraction, most) + largest);
    bed.room = box;
    bed.room.periodic.at(bed.up) = false;
    if (bed.sign > 0) bed.room.upper[bed.up] = box.lower[bed.up] + height;
    if (bed.sign < 0) bed.room.lower[bed.up] = box.upper[bed.up] - height;
    bed.height = height;
    if (auto centres = random_packing(bed.room, diameters, seed)) return std::move(*centres);
  }
  throw ConfigError(
      "{}: {} spheres do not fit loosely into {:.4g} m above the bottom of the region, as high as "
      "the domain goes: a bed needs some room to settle from; ask for fewer, or make the domain "
      "higher",
      bed.entry, diameters.size(), most);
}

/// A scene in which the bed alone settles in its own room.
Scene scene_of(const Settling& bed, const std::string& material) {
  Scene scene = bed.scene;
  if (bed.vessel == nullptr) {
    scene.fluid.mesh = {};
    scene.fluid.mesh.box = {bed.room.lower, bed.room.upper, {1, 1, 1}};
    for (const Axis axis : {Axis::x, Axis::y, Axis::z}) {
      if (bed.room.periodic.at(static_cast<std::size_t>(axis))) {
        scene.fluid.mesh.periodic.push_back(axis);
      }
    }
  }
  scene.fluid.boundaries = {{"walls", {}}};
  scene.particles.walls = WallSource::from_mesh;
  for (auto& [name, surface] : scene.particles.surfaces) surface.motion = {};
  scene.particles.inflow.clear();
  scene.particles.insertion = {InsertionSettings{}};
  scene.particles.insertion.front().material = material;
  scene.particles.outflow.emplace();
  return scene;
}

/// Soft linear springs between all materials, with the friction that the scene gives; the step that
/// they allow.
void soften(const Settling& bed, double smallest, Scene& scene) {
  double stiffest = INFINITY;
  for (const PairSettings& pair : scene.particles.contact.pairs) {
    if (scene.particles.contact.law == ContactLaw::linear) {
      stiffest = std::min(stiffest, pair.normal_stiffness.value_or(INFINITY));
    }
  }
  const double pressure = 0.6 * bed.density * bed.gravity * bed.height;  // at the bottom [Pa]
  const double stiffness = std::min(stiffest, pressure * bed.diameter / soft_overlap);
  ContactSettings soft;
  for (const PairSettings& pair : scene.particles.contact.pairs) {
    PairSettings softened;
    softened.between = pair.between;
    softened.normal_stiffness = stiffness;
    softened.restitution = 0.3;
    softened.friction = pair.friction;
    soft.pairs.push_back(softened);
  }
  scene.particles.contact = soft;
  const double mass = bed.density * sphere_volume(smallest);
  // A fifteenth of the contact time of two of the lightest spheres.
  scene.particles.time_step = std::numbers::pi * std::sqrt(mass / (2 * stiffness)) / 15;
  scene.coupling.window = sub_steps_of_window * scene.particles.time_step;
}

/// Mean kinetic energy over m g d [-].
double restlessness(const Settling& bed, const ParticleState& particles) {
  double sum = 0;
  for (const Vector3& velocity : particles.velocity) sum += velocity.squaredNorm();
  return 0.5 * sum / (particles.size() * bed.gravity * bed.diameter);
}

/// Forces that slow each sphere down with the time constant `time` [s].
void damp(const ParticleState& particles, double time, std::vector<Vector3>& force) {
  force.resize(particles.velocity.size());
  for (int row = 0; row < particles.size(); ++row) {
    const double mass = particles.density[row] * sphere_volume(2 * particles.radius[row]);
    force[row] = -mass / time * particles.velocity[row];
  }
}

/// Let the particles come to rest in the scene: not before `least` [s], and for as long as one
/// falls through a diameter.
ParticleState come_to_rest(const Settling& bed, const char* stage, const Scene& scene,
                           ParticleState particles, double damping, double least,
                           const Progress& alive) {
  const double window = scene.coupling.window;
  const double quiet_time = std::sqrt(2 * bed.diameter / bed.gravity);
  const double most = 20 * (least + std::sqrt(2 * bed.height / bed.gravity));
  const double time_constant = std::max(damping, 2 * window);
  const auto engine =
      make_native_engine(scene, bed.vessel != nullptr ? *bed.vessel : make_box(scene.fluid.mesh),
                         std::move(particles));
  std::vector<Vector3> force;
  double quiet_since = INFINITY;
  double energy = INFINITY;
  for (int done = 1; done * window <= most; ++done) {
    damp(engine->particles(), time_constant, force);
    engine->advance(window, sub_steps(scene), force, alive);
    engine->commit();
    const double time = done * window;
    energy = restlessness(bed, engine->particles());
    if (!(energy < rest) || time < least)
      quiet_since = INFINITY;
    else
      quiet_since = std::min(quiet_since, time);
    if (done % windows_of_log == 0) {
      spdlog::info("{}: {} bed, {:.4g} s: mean kinetic energy {:.2e} m g d (at rest below {:g})",
                   bed.entry, stage, time, energy, rest);
    }
    if (time - quiet_since >= quiet_time) {
      spdlog::info("{}: {} bed at rest after {:.4g} s", bed.entry, stage, time);
      return engine->particles();
    }
  }
  throw NumericsError(
      "{}: the {} bed has not settled within {:.4g} s: its mean kinetic energy is {:.3g} m g d, "
      "and "
      "at rest is below {:g}. Is the restitution 1, or is there no friction? Else settle it in a "
      "run "
      "of its own and read it from its results.h5 (type: file)",
      bed.entry, stage, most, energy, rest);
}

ParticleState state_of(const std::vector<Vector3>& centres, std::span<const double> diameters,
                       double density, int material) {
  ParticleState state;
  for (std::size_t i = 0; i < centres.size(); ++i) {
    state.id.push_back(static_cast<std::int64_t>(i) + 1);
    state.position.push_back(centres[i]);
    state.velocity.emplace_back(Vector3::Zero());
    state.spin.emplace_back(Vector3::Zero());
    state.radius.push_back(0.5 * diameters[i]);
    state.density.push_back(density);
    state.material.push_back(material);
  }
  return state;
}

/// At rest, and without those that stick out above `height` [m]; 0: all.
std::vector<ListedParticle> cut(const Settling& bed, const ParticleState& settled, double height) {
  std::vector<ListedParticle> particles;
  const double bottom = bed.sign > 0 ? bed.room.lower[bed.up] : -bed.room.upper[bed.up];
  double top = 0;
  double highest = 0;
  for (int row = 0; row < settled.size(); ++row) {
    const double above = bed.sign * settled.position[row][bed.up] + settled.radius[row] - bottom;
    highest = std::max(highest, above);
    if (height > 0 && above > height) continue;
    top = std::max(top, above);
    particles.push_back(
        {settled.position[row], Vector3::Zero(), Vector3::Zero(), 2 * settled.radius[row]});
  }
  if (height > 0 && highest < height) {
    throw NumericsError(
        "{}: the settled bed is {:.4g} m high, less than `height`, {:.4g} m; it has more room "
        "between "
        "its spheres than any settled bed: look at its walls and sizes",
        bed.entry, highest, height);
  }
  spdlog::info("{}: {} spheres, {:.5g} m high", bed.entry, particles.size(), top);
  return particles;
}

/// A vessel is a vessel as a whole: nothing would hold the bed at another side of `within`.
void check_whole(const Settling& bed, const PackingBox& box, const Domain& domain) {
  for (int side = 0; side < 6; ++side) {
    const bool top = side == 2 * bed.up + (bed.sign > 0 ? 1 : 0);
    const double at = side % 2 == 0 ? box.lower[side / 2] : box.upper[side / 2];
    if (top || std::abs(at - domain.plane(side)) <= 1e-9 * domain.length(side / 2)) continue;
    throw ConfigError(
        "{}: `within` ends at {} = {:.6g} m inside a mesh that is no box, whose boundary alone "
        "holds a settled bed; leave out that bound, or give `height`",
        bed.entry, "xyz"[side / 2], at);
  }
}

}  // namespace

std::vector<ListedParticle> settled_bed(const Scene& scene, const std::string& entry,
                                        const InsertionSettings& settings, const PackingBox& box,
                                        const Domain& domain, const Mesh& mesh,
                                        const Progress& alive) {
  Settling bed{entry, scene};
  find_up(bed);
  if (box.room != nullptr && box.room->bounded_by_mesh()) {
    bed.vessel = &mesh;
    check_whole(bed, box, domain);
  }
  bed.density = scene.particles.materials.at(settings.material).density;
  const std::vector<double> diameters =
      settings.height > 0
          ? diameters_of_volume(entry, settings,
                                dense_fraction * volume_below(bed, box, settings.height))
          : entry_diameters(entry, settings, box.volume());
  double cubes = 0;
  for (const double diameter : diameters) cubes += diameter * diameter * diameter;
  bed.diameter = std::cbrt(cubes / static_cast<double>(diameters.size()));
  const double smallest = *std::min_element(diameters.begin(), diameters.end());
  const std::vector<Vector3> centres =
      pack_loosely(bed, box, domain, diameters, static_cast<std::uint64_t>(settings.seed));
  const auto material = scene.particles.materials.find(settings.material);
  const auto index = static_cast<int>(std::distance(scene.particles.materials.begin(), material));
  spdlog::info("{}: {} spheres settle from {:.4g} m", entry, centres.size(), bed.height);

  Scene soft = scene_of(bed, settings.material);
  soften(bed, smallest, soft);
  // From rest, all must have had the time to come down: what is loose is less than half the height.
  const double fall = std::sqrt(bed.height / bed.gravity);
  ParticleState state =
      come_to_rest(bed, "soft", soft, state_of(centres, diameters, bed.density, index), 0.25 * fall,
                   fall, alive);
  Scene hard = scene_of(bed, settings.material);
  hard.coupling.window = sub_steps_of_window * (scene.coupling.window / sub_steps(scene));
  hard.particles.time_step = scene.coupling.window / sub_steps(scene);
  state = come_to_rest(bed, "stiff", hard, std::move(state),
                       0.5 * std::sqrt(bed.diameter / bed.gravity), 0, alive);
  return cut(bed, state, settings.height);
}

}  // namespace fluxpact
