#include "dem_server/backends/size_levels.hpp"

#include <algorithm>
#include <cmath>

namespace fluxpact {

void SizeLevels::sort_level(const Domain& domain, double skin, PositionRows positions,
                            Level& level) {
  const double cutoff = 2 * level.largest_radius + skin;
  level.first = static_cast<int>(order_.size());
  if (levels_.size() == 1) {
    level.grid.sort(domain, cutoff, positions);
    return;
  }
  level.positions.clear();
  for (const int row : level.rows) {
    level.positions.emplace_back(Eigen::Map<const Vector3>(positions[row]));
  }
  const double* data = level.positions.empty() ? nullptr : level.positions.front().data();
  level.grid.sort(domain, cutoff, {data, 3, static_cast<int>(level.rows.size())});
  for (const int k : level.grid.order()) order_.push_back(level.rows[k]);
}

void SizeLevels::sort(const Domain& domain, double skin, PositionRows positions, RadiusRows radii) {
  double largest = 0;
  double smallest = std::numeric_limits<double>::infinity();
  for (int row = 0; row < positions.size; ++row) {
    largest = std::max(largest, radii[row]);
    smallest = std::min(smallest, radii[row]);
  }
  const auto level_of = [&](double radius) { return std::ilogb(largest / radius); };
  levels_.resize(positions.size > 0 ? level_of(smallest) + 1 : 0);
  for (Level& level : levels_) {
    level.largest_radius = 0;
    level.rows.clear();
  }
  for (int row = 0; row < positions.size; ++row) {
    Level& level = levels_[level_of(radii[row])];
    level.largest_radius = std::max(level.largest_radius, radii[row]);
    if (levels_.size() > 1) level.rows.push_back(row);
  }
  order_.clear();
  if (levels_.size() > 1) order_.reserve(positions.size);
  for (Level& level : levels_) sort_level(domain, skin, positions, level);
}

}  // namespace fluxpact
