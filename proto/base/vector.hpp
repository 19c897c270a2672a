// The one vector type of all programs, and views of arrays of it.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>  // cross products
#include <span>
#include <vector>

namespace fluxpact {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
static_assert(sizeof(Vector3) == 3 * sizeof(double),
              "arrays of vectors go on the wire as rows of 3");

/// View of n vectors as 3n doubles (x0 y0 z0 x1 ...), as they go on the wire and to files.
inline std::span<const double> as_doubles(std::span<const Vector3> vectors) {
  return {vectors.empty() ? nullptr : vectors.front().data(), 3 * vectors.size()};
}

/// View of 3n doubles as n vectors. The data must be aligned to 8 bytes, and its size a multiple
/// of 3.
inline std::span<const Vector3> as_vectors(std::span<const double> doubles) {
  return {reinterpret_cast<const Vector3*>(doubles.data()), doubles.size() / 3};
}

}  // namespace fluxpact
