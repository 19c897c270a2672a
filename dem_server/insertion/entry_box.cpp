#include "dem_server/insertion/entry_box.hpp"

#include <algorithm>

#include "proto/base/errors.hpp"

namespace fluxpact {

PackingBox entry_box(const std::string& entry, const Region& within, const Domain& domain) {
  PackingBox box{domain.lower, domain.upper, {}};
  const std::array<const std::optional<std::array<double, 2>>*, 3> ranges{&within.x, &within.y,
                                                                          &within.z};
  for (int axis = 0; axis < 3; ++axis) {
    box.periodic[axis] = domain.periodic(axis);
    if (!ranges[axis]->has_value()) continue;
    const auto [low, high] = **ranges[axis];
    // A bound written with fewer digits than the mesh's point is still the side.
    const double rounding = 1e-9 * domain.length(axis);
    if (!(low < high) || low < domain.lower[axis] - rounding ||
        high > domain.upper[axis] + rounding) {
      throw ConfigError(
          "{}: within.{} is [{:.6g}, {:.6g}] m; it must ascend and lie "
          "in the "
          "domain, [{:.6g}, {:.6g}] m",
          entry, "xyz"[axis], low, high, domain.lower[axis], domain.upper[axis]);
    }
    const bool whole =
        low <= domain.lower[axis] + rounding && high >= domain.upper[axis] - rounding;
    box.periodic[axis] = box.periodic[axis] && whole;
    box.lower[axis] = std::max(low, domain.lower[axis]);
    box.upper[axis] = std::min(high, domain.upper[axis]);
  }
  return box;
}

}  // namespace fluxpact
