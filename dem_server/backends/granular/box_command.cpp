#include "dem_server/backends/granular/box_command.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace fluxpact {
namespace {

constexpr double skin_per_diameter = 0.15;

}  // namespace

BoxCommands box_commands(const Domain& domain, const Vector3& gravity,
                         const ParticleState& spheres) {
  double largest = 0;
  double mean = 0;
  for (const double radius : spheres.radius) {
    largest = std::max(largest, 2 * radius);
    mean += 2 * radius / static_cast<double>(spheres.radius.size());
  }
  const double shortest = (domain.upper - domain.lower).minCoeff();
  if (spheres.size() == 0) largest = mean = 1e-2 * shortest;  // who comes in is about as small
  BoxCommands box{"boundary", "processors", "region box block",
                  fmt::format("neighbor {:.17g} bin", skin_per_diameter * mean)};
  int down = -1;
  if (gravity.norm() > 0) gravity.cwiseAbs().maxCoeff(&down);
  for (int axis = 0; axis < 3; ++axis) {
    box.boundary += domain.periodic(axis) ? " p" : " f";
    box.processors += axis == down ? " 1" : " *";
  }
  for (int side = 0; side < 6; ++side) {
    const double outward = side % 2 == 0 ? -1 : 1;
    double margin = 0;
    if (domain.sides[side] == SideKind::wall) margin = 2 * largest;
    if (domain.sides[side] == SideKind::open) {
      margin = 2 * largest + domain.length(side / 2);
    }
    box.region += fmt::format(" {:.17g}", domain.plane(side) + outward * margin);
  }
  box.region += " units box";
  return box;
}

}  // namespace fluxpact
