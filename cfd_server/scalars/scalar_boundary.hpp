// What the boundary does to a scalar: one rule for each boundary face, and its values at a time.
//
// Read once from the scene; the values are renewed before each step because they may be formulas.
#pragma once

#include <cstdint>
#include <vector>

namespace fluxpact {

enum class ScalarFace : std::uint8_t {
  zero_gradient,  ///< what leaves has the value of the cell, and so has what enters
  value,          ///< held at c_b: enters with the inflow, and diffuses
  backflow,       ///< c_b enters with the inflow only: pressure faces, whose flux has either sign
  influx,         ///< a given amount enters through a wall
};

/// One entry a boundary face (face − internal faces).
struct ScalarBoundary {
  std::vector<ScalarFace> kind;
  std::vector<double> value;  ///< c_b [c], or the amount that enters through the face [kg c/s]

  /// Whether what enters with the fluid has a value of its own.
  bool brings(int face) const {
    return kind[face] == ScalarFace::value || kind[face] == ScalarFace::backflow;
  }
};

}  // namespace fluxpact
