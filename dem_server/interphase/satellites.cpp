#include "dem_server/interphase/satellites.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

namespace fluxpact {

std::vector<Vector3> satellite_points(int count) {
  // The real root of g⁴ = g + 1: powers of 1/g make the sequence of lowest discrepancy in a cube.
  constexpr double g = 1.22074408460575947536;
  const int pairs = count / 2;
  std::vector<Vector3> points;
  points.reserve(static_cast<std::size_t>(count));
  Matrix3 moments = Matrix3::Zero();
  for (int k = 0; k < pairs; ++k) {
    const double rise = std::fmod(0.5 + k / g, 1.0);
    const double turn = 2 * std::numbers::pi * std::fmod(0.5 + k / (g * g), 1.0);
    const double radius = std::cbrt((k + 0.5) / pairs);
    const double flat = std::sqrt(1 - rise * rise);
    const Vector3 point = radius * Vector3(flat * std::cos(turn), flat * std::sin(turn), rise);
    points.push_back(point);
    points.push_back(-point);
    moments += 2.0 / count * point * point.transpose();
  }
  if (count % 2 == 1) points.push_back(Vector3::Zero());
  if (pairs >= 3) {  // fewer span no space
    const Eigen::SelfAdjointEigenSolver<Matrix3> axes(moments);
    const Matrix3 stretch = std::sqrt(0.2) * axes.operatorInverseSqrt();
    for (Vector3& point : points) point = stretch * point;
  }
  return points;
}

}  // namespace fluxpact
