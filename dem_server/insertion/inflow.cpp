#include "dem_server/insertion/inflow.hpp"

#include <algorithm>
#include <cmath>

#include "dem_server/insertion/entry_box.hpp"
#include "dem_server/insertion/insertion.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

/// Places tried for a particle before it waits. At a solid fraction of 0.3 in the region one place
/// in some 30 is free.
constexpr int most_tries = 200;
/// Of a particle: what is due is not missed by the rounding of rate times time.
constexpr double rounding = 1e-6;

std::string name_of_entry(std::size_t index) {
  return fmt::format("particles.inflow entry {}", index + 1);
}

void clear(ParticleState& state) {
  state.id.clear();
  state.position.clear();
  state.velocity.clear();
  state.spin.clear();
  state.radius.clear();
  state.density.clear();
  state.material.clear();
}

}  // namespace

Inflow::Inflow(const Scene& scene, const Mesh& mesh, std::int64_t first_id)
    : domain_(particle_domain(scene, mesh)), room_(scene, mesh) {
  const std::vector<std::string> names = material_names(scene.particles);
  for (std::size_t i = 0; i < scene.particles.inflow.size(); ++i) {
    const InflowSettings& settings = scene.particles.inflow[i];
    const auto material = std::find(names.begin(), names.end(), settings.material);
    if (material == names.end()) {
      throw ConfigError("{}: material `{}` is not in particles.materials ({})", name_of_entry(i),
                        settings.material, fmt::join(names, ", "));
    }
    Source& source =
        sources_.emplace_back(Source{settings,
                                     SizeLaw(settings.diameter, settings.sizes),
                                     static_cast<int>(material - names.begin()),
                                     scene.particles.materials.at(settings.material).density,
                                     {},
                                     {},
                                     {},
                                     {}});
    if (settings.within) {
      lay_box(name_of_entry(i), source);
    } else {
      lay_gates(scene, mesh, source);
    }
    Given given{UniformRandom(static_cast<std::uint64_t>(settings.seed)), 0, 0, 0, {}};
    given.diameter = source.sizes.quantile(given.random.next());
    committed_.given.push_back(given);
  }
  committed_.next_id = first_id;
  candidate_ = committed_;
}

void Inflow::lay_box(const std::string& name, Source& source) const {
  const PackingBox box = entry_box(name, *source.settings.within, domain_);
  source.lower = box.lower;
  source.upper = box.upper;
  source.periodic = box.periodic;
  for (int axis = 0; axis < 3; ++axis) {
    const double length = box.upper[axis] - box.lower[axis];
    if (box.periodic.at(axis) || length >= source.sizes.largest()) continue;
    throw ConfigError(
        "{}: the region is {:.6g} m long in {}, too short for a particle of diameter {:.6g} m; "
        "enlarge `within`",
        name, length, "xyz"[axis], source.sizes.largest());
  }
}

/// The faces of the patch, cut into triangles about their centres.
void Inflow::lay_gates(const Scene& scene, const Mesh& mesh, Source& source) const {
  const Patch* const patch = mesh.find_patch(source.settings.patch);
  if (patch == nullptr || patch->size == 0) {
    throw ConfigError(
        "particles.inflow: patch `{}` has no faces in the mesh; particles come in "
        "through one that has, or a box (`within`)",
        source.settings.patch);
  }
  double area = 0;
  source.lower = source.upper = mesh.face_centres[patch->first];
  for (int face = patch->first; face < patch->first + patch->size; ++face) {
    const Vector3 inward = -mesh.face_areas[face].normalized();
    const double depth =
        std::max(0.0, source.settings.velocity.dot(inward)) * scene.coupling.window;
    const int first = mesh.face_offsets[face];
    const int corners = mesh.face_offsets[face + 1] - first;
    const Vector3& centre = mesh.face_centres[face];
    for (int c = 0; c < corners; ++c) {
      const Vector3& a = mesh.points[mesh.face_points[first + c]];
      const Vector3& b = mesh.points[mesh.face_points[first + (c + 1) % corners]];
      area += 0.5 * (a - centre).cross(b - centre).norm();
      source.gates.push_back({centre, a - centre, b - centre, inward, depth, area});
      const Vector3 far = a + (depth + source.sizes.largest()) * inward;
      source.lower = source.lower.cwiseMin(a).cwiseMin(far);
      source.upper = source.upper.cwiseMax(a).cwiseMax(far);
    }
  }
}

/// Particles that should have come in by `time`, less those that have.
std::int64_t Inflow::due(const Source& source, const Given& given, double time) const {
  const InflowSettings& flow = source.settings;
  const double end = flow.stop ? std::min(time, *flow.stop) : time;
  const double elapsed = std::max(0.0, end - flow.start);
  if (flow.number_rate > 0) {
    return static_cast<std::int64_t>(std::floor(flow.number_rate * elapsed + rounding)) -
           given.count;
  }
  const double next = source.density * sphere_volume(given.diameter);
  const double missing = flow.mass_rate * elapsed - given.mass.value();
  return std::max<std::int64_t>(0,
                                static_cast<std::int64_t>(std::floor(missing / next + rounding)));
}

/// All images of a sphere across periodic sides.
void Inflow::add_images(const Vector3& centre, double radius) {
  std::array<int, 3> reach{};
  for (int axis = 0; axis < 3; ++axis) reach.at(axis) = domain_.periodic(axis) ? 1 : 0;
  for (int k = -reach[2]; k <= reach[2]; ++k) {
    for (int j = -reach[1]; j <= reach[1]; ++j) {
      for (int i = -reach[0]; i <= reach[0]; ++i) {
        const Vector3 shift(i * domain_.length(0), j * domain_.length(1), k * domain_.length(2));
        near_.add(centre + shift, radius);
      }
    }
  }
}

/// The spheres beside which a source looks for room.
void Inflow::gather(const Source& source, const ParticleState& present,
                    std::span<const int> leaving, const ParticleState& entering) {
  double largest = 0.5 * source.sizes.largest();
  for (const double radius : present.radius) largest = std::max(largest, radius);
  for (const double radius : entering.radius) largest = std::max(largest, radius);
  near_.start(source.lower, source.upper, largest);
  std::size_t next = 0;
  for (int row = 0; row < present.size(); ++row) {
    if (next < leaving.size() && leaving[next] == row) {
      ++next;
      continue;
    }
    add_images(present.position[row], present.radius[row]);
  }
  for (int row = 0; row < entering.size(); ++row) {
    add_images(entering.position[row], entering.radius[row]);
  }
}

Vector3 Inflow::propose(const Source& source, Given& given) const {
  const double radius = 0.5 * given.diameter;
  const double first = given.random.next();
  const double second = given.random.next();
  const double third = given.random.next();
  if (source.gates.empty()) {
    const Vector3 shares(first, second, third);
    Vector3 place;
    for (int axis = 0; axis < 3; ++axis) {
      const double margin = source.periodic.at(axis) ? 0 : radius;
      const double low = source.lower[axis] + margin;
      place[axis] = low + shares[axis] * (source.upper[axis] - margin - low);
    }
    return place;
  }
  const double area = given.random.next() * source.gates.back().area;
  const auto gate =
      std::upper_bound(source.gates.begin(), source.gates.end() - 1, area,
                       [](double value, const Gate& other) { return value < other.area; });
  // Evenly over a triangle: points beyond its far edge fold back.
  const bool beyond = first + second > 1;
  const double along = beyond ? 1 - first : first;
  const double across = beyond ? 1 - second : second;
  return gate->corner + along * gate->side + across * gate->other_side +
         (radius + third * gate->depth) * gate->inward;
}

/// Centre in the domain and the vessel, and no wall touched.
bool Inflow::is_inside(const Vector3& place, double radius) const {
  // A sphere that just touches the patch behind it, up to rounding.
  const double least = radius * (1 - 1e-9);
  for (int side = 0; side < 6; ++side) {
    if (domain_.sides.at(side) == SideKind::periodic) continue;
    const double inward = side % 2 == 0 ? 1.0 : -1.0;
    const double room = inward * (place[side / 2] - domain_.plane(side));
    if (room < (domain_.sides.at(side) == SideKind::wall ? least : 0.0)) return false;
  }
  return room_.unbounded() || room_.fits(place, radius);
}

bool Inflow::find_place(const Source& source, Given& given, Vector3& place) const {
  for (int attempt = 0; attempt < most_tries; ++attempt) {
    place = propose(source, given);
    const double radius = 0.5 * given.diameter;
    if (near_.is_free(place, radius) && is_inside(place, radius)) return true;
  }
  return false;
}

void Inflow::advance(double time, const ParticleState& present, std::span<const int> leaving,
                     ParticleState& entering) {
  candidate_ = committed_;
  clear(entering);
  room_.place(time);
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const Source& source = sources_[i];
    Given& given = candidate_.given[i];
    given.waiting = due(source, given, time);
    if (given.waiting == 0) continue;
    gather(source, present, leaving, entering);
    Vector3 place;
    while (given.waiting > 0 && find_place(source, given, place)) {
      const double radius = 0.5 * given.diameter;
      entering.id.push_back(candidate_.next_id++);
      entering.position.push_back(wrapped(domain_, place));
      entering.velocity.push_back(source.settings.velocity);
      entering.spin.push_back(Vector3::Zero());
      entering.radius.push_back(radius);
      entering.density.push_back(source.density);
      entering.material.push_back(source.material);
      add_images(entering.position.back(), radius);
      ++given.count;
      given.mass.add(source.density * sphere_volume(given.diameter));
      given.diameter = source.sizes.quantile(given.random.next());
      given.waiting = due(source, given, time);
    }
  }
}

std::int64_t Inflow::waiting() const {
  std::int64_t sum = 0;
  for (const Given& given : candidate_.given) sum += given.waiting;
  return sum;
}

}  // namespace fluxpact
