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
  /// matrix · v, in the time of one component where v lies along an axis.
  Vector3 multiplied(const Matrix3& matrix, std::size_t i) const {
    if (axis_.empty()) return matrix * full_[i];
    return length_[i] * matrix.col(axis_[i]);
  }
  /// matrixᵀ · v
  Vector3 multiplied_transposed(const Matrix3& matrix, std::size_t i) const {
    if (axis_.empty()) return matrix.transpose() * full_[i];
    return length_[i] * matrix.row(axis_[i]).transpose();
  }
  double dot(const Vector3& other, std::size_t i) const {
    return axis_.empty() ? other.dot(full_[i]) : length_[i] * other[axis_[i]];
  }
  /// sum += factor v
  void add(double factor, std::size_t i, Vector3& sum) const {
    if (axis_.empty()) {
      sum += factor * full_[i];
    } else {
      sum[axis_[i]] += factor * length_[i];
    }
  }
  /// sum += other vᵀ
  void add_outer(const Vector3& other, std::size_t i, Matrix3& sum) const {
    if (axis_.empty()) {
      sum.noalias() += other * full_[i].transpose();
    } else {
      sum.col(axis_[i]) += length_[i] * other;
    }
  }
  bool empty() const { return full_.empty() && axis_.empty(); }

 private:
  std::vector<Vector3> full_;
  std::vector<double> length_;
  std::vector<std::uint8_t> axis_;
};

}  // namespace fluxpact
