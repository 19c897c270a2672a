#include "dem_server/insertion/near_spheres.hpp"

#include <algorithm>
#include <cmath>

namespace fluxpact {

void NearSpheres::start(const Vector3& lower, const Vector3& upper, double largest) {
  constexpr double most_cells = 64;  // along an axis: more cost more to clear than they save
  const double reach = 2 * largest;
  lower_ = lower - Vector3::Constant(reach);
  upper_ = upper + Vector3::Constant(reach);
  std::size_t total = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double length = upper_[axis] - lower_[axis];
    cells_.at(axis) = static_cast<int>(std::clamp(std::floor(length / reach), 1.0, most_cells));
    width_[axis] = length / cells_.at(axis);
    total *= static_cast<std::size_t>(cells_.at(axis));
  }
  first_.assign(total, -1);
  spheres_.clear();
}

int NearSpheres::cell_at(const Vector3& point, int axis) const {
  const int cell = static_cast<int>(std::floor((point[axis] - lower_[axis]) / width_[axis]));
  return std::clamp(cell, 0, cells_.at(axis) - 1);
}

void NearSpheres::add(const Vector3& centre, double radius) {
  if ((centre.array() < lower_.array()).any() || (centre.array() > upper_.array()).any()) return;
  const int cell =
      cell_at(centre, 0) + cells_[0] * (cell_at(centre, 1) + cells_[1] * cell_at(centre, 2));
  spheres_.push_back({centre, radius, first_[cell]});
  first_[cell] = static_cast<int>(spheres_.size()) - 1;
}

bool NearSpheres::is_free(const Vector3& centre, double radius) const {
  std::array<int, 3> low{};
  std::array<int, 3> high{};
  for (int axis = 0; axis < 3; ++axis) {
    low.at(axis) = std::max(cell_at(centre, axis) - 1, 0);
    high.at(axis) = std::min(cell_at(centre, axis) + 1, cells_.at(axis) - 1);
  }
  for (int k = low[2]; k <= high[2]; ++k) {
    for (int j = low[1]; j <= high[1]; ++j) {
      for (int i = low[0]; i <= high[0]; ++i) {
        for (int s = first_[i + cells_[0] * (j + cells_[1] * k)]; s >= 0; s = spheres_[s].next) {
          const double sum = spheres_[s].radius + radius;
          if ((spheres_[s].centre - centre).squaredNorm() < sum * sum) return false;
        }
      }
    }
  }
  return true;
}

}  // namespace fluxpact
