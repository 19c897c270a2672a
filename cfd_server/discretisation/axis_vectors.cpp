#include "cfd_server/discretisation/axis_vectors.hpp"

namespace fluxpact {

AxisVectors::AxisVectors(std::vector<Vector3> vectors, bool along_axes) {
  if (!along_axes) {
    vectors.shrink_to_fit();
    full_ = std::move(vectors);
    return;
  }
  length_.reserve(vectors.size());
  axis_.reserve(vectors.size());
  for (const Vector3& vector : vectors) {
    int axis = 0;
    vector.cwiseAbs().maxCoeff(&axis);
    length_.push_back(vector[axis]);
    axis_.push_back(static_cast<std::uint8_t>(axis));
  }
}

}  // namespace fluxpact
