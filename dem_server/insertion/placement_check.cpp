#include "dem_server/insertion/placement_check.hpp"

#include <algorithm>

#include "dem_server/backends/cell_grid.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

/// A bed that was saved while it lay on a wall, and is read again, is fine; a lapse of the user is
/// not.
constexpr double most_overlap = 0.1;

std::string who(const ParticleState& particles, const std::vector<int>& entry, int row) {
  const Vector3& at = particles.position[row];
  return fmt::format("particle {} of particles.insertion entry {} at ({:.6g}, {:.6g}, {:.6g}) m",
                     particles.id[row], entry[row], at.x(), at.y(), at.z());
}

void check_inside(const ParticleState& particles, const std::vector<int>& entry,
                  const Domain& domain) {
  for (int row = 0; row < particles.size(); ++row) {
    for (int side = 0; side < 6; ++side) {
      const double outward = side % 2 == 0 ? -1.0 : 1.0;
      const double room = outward * (domain.plane(side) - particles.position[row][side / 2]);
      const double radius = particles.radius[row];
      const double least =
          domain.sides[side] == SideKind::periodic ? 0.0 : radius - most_overlap * 2 * radius;
      if (room >= least) continue;
      throw ConfigError(
          "{} {} the domain at {} = {:.6g} m by {:.3g} m; move it in, or enlarge the box",
          who(particles, entry, row), room < 0 ? "is outside" : "sticks out of", side_name(side),
          domain.plane(side), room < 0 ? -room : radius - room);
    }
  }
}

struct WorstPair {
  double overlap = most_overlap;  // of the smaller diameter
  int a = -1;
  int b = -1;
};

WorstPair find_worst_pair(const ParticleState& particles, const Domain& domain) {
  WorstPair worst;
  std::vector<Vector3> position = particles.position;
  for (Vector3& x : position) x = wrapped(domain, x);
  CellGrid grid;
  const double largest = 2 * *std::max_element(particles.radius.begin(), particles.radius.end());
  grid.sort(domain, largest, {position.front().data(), 3, particles.size()});
  const std::array<Vector3, 27> shifts = shift_vectors(domain);
  for (int place = 0; place < particles.size(); ++place) {
    const int a = grid.order()[place];
    grid.visit_partners(place, [&](int other, int shift) {
      const int b = grid.order()[other];
      const double sum = particles.radius[a] + particles.radius[b];
      const Vector3 apart = position[b] + shifts[shift] - position[a];
      if (apart.squaredNorm() >= sum * sum) return;
      const double smaller = 2 * std::min(particles.radius[a], particles.radius[b]);
      const double overlap = (sum - apart.norm()) / smaller;
      if (overlap > worst.overlap) worst = {overlap, std::min(a, b), std::max(a, b)};
    });
  }
  return worst;
}

}  // namespace

void check_placement(const ParticleState& particles, const std::vector<int>& entry,
                     const Domain& domain) {
  if (particles.size() == 0) return;
  check_inside(particles, entry, domain);
  const WorstPair worst = find_worst_pair(particles, domain);
  if (worst.a < 0) return;
  throw ConfigError(
      "{} overlaps particle {} of entry {} by {:.3g} of the smaller diameter; at most {} is "
      "accepted: "
      "move one of them, or their entries' regions, apart",
      who(particles, entry, worst.b), particles.id[worst.a], entry[worst.a], worst.overlap,
      most_overlap);
}

void check_walls(const ParticleState& particles, const std::vector<int>& entry, const Room& room) {
  if (room.unbounded()) return;
  for (int row = 0; row < particles.size(); ++row) {
    const double radius = particles.radius[row];
    const double clear = room.clearance(particles.position[row]);
    if (clear >= radius - most_overlap * 2 * radius) continue;
    const std::string wall = room.nearest_wall(particles.position[row]);
    throw ConfigError(
        "{} {} the wall `{}` by {:.3g} m; move it, or the wall (particles.surfaces, fluid.mesh)",
        who(particles, entry, row), clear < 0 ? "is behind" : "sticks into", wall,
        clear < 0 ? -clear : radius - clear);
  }
}

}  // namespace fluxpact
