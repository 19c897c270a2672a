// One axis of a lattice: which interval holds a coordinate. Inline, for it is asked three times a
// particle and window.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "proto/mesh/mesh.hpp"

namespace fluxpact {

struct LatticeAxis {
  std::vector<double> nodes;   ///< [m]
  double front = 0, back = 0;  ///< [m]
  double per_length = 0;       ///< intervals over the whole length [1/m]
  int last = 0;                ///< interval
  int stride = 1;              ///< of the cell's number
  bool periodic = false;

  double period() const { return back - front; }  ///< [m]

  /// Of x, which is brought into the period; -1 outside, and for x in the last plane. The guess is
  /// right for equal cells; from there it is a short walk.
  int interval(double& x) const {
    if (!(x >= front && x < back) && !wrap(x)) return -1;
    int i = std::min(static_cast<int>((x - front) * per_length), last);
    while (i < last && x >= nodes[i + 1]) ++i;
    while (i > 0 && x < nodes[i]) --i;
    return i;
  }

  /// Brings x into the period; false if it stays outside.
  bool wrap(double& x) const {
    if (!periodic || !std::isfinite(x)) return false;
    x -= period() * std::floor((x - front) / period());
    return x < back;  // it may be rounded up to the other end
  }
};

inline std::array<LatticeAxis, 3> lattice_axes(const Lattice& lattice) {
  std::array<LatticeAxis, 3> axes;
  int stride = 1;
  for (int k = 0; k < 3; ++k) {
    const auto& nodes = lattice.nodes[k];
    const int intervals = static_cast<int>(nodes.size()) - 1;
    const double length = nodes.back() - nodes.front();
    axes[k] = {nodes,         nodes.front(), nodes.back(),       intervals / length,
               intervals - 1, stride,        lattice.periodic[k]};
    stride *= intervals;
  }
  return axes;
}

}  // namespace fluxpact
