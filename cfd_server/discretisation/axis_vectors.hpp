// Vectors of faces or sides that take 9 bytes instead of 24 where each lies along an axis.
#pragma once

#include <cstdint>
#include <vector>

#include "proto/base/vector.hpp"

namespace fluxpact {

class AxisVectors {
 public:
  AxisVectors() = default;
  /// along_axes: each vector but for rounding is a multiple of an axis, as on a lattice; only its
  /// largest component is kept.
  AxisVectors(std::vector<Vector3> vectors, bool along_axes);

  Vector3 operator[](std::size_t i) const {
    if (axis_.empty()) return full_[i];
    const double length = length_[i];
    const int axis = axis_[i];
    return {axis == 0 ? length : 0.0, axis == 1 ? length : 0.0, axis == 2 ? length : 0.0};
  }
  bool empty() const { return full_.empty() && axis_.empty(); }

 private:
  std::vector<Vector3> full_;
  std::vector<double> length_;
  std::vector<std::uint8_t> axis_;
};

}  // namespace fluxpact
