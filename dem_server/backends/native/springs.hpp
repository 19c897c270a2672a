// What contacts remember from one sub-step to the next.
#pragma once

#include <cstddef>

#include "dem_server/backends/native/huge_vector.hpp"

namespace fluxpact {

/// Springs of the contacts of one list, one row of numbers for each component: x, y, z of the
/// elongation [m], seen from the holder, then what the law wants beside. Rows have room for whole
/// vector registers.
template <class Real>
struct Springs {
  static constexpr int widest = 16;  // contacts in one register
  HugeVector<Real> values;
  int contacts = 0;
  std::ptrdiff_t stride = 0;  // from one row to the next

  /// All zero, for so many contacts with so many numbers each.
  void reset(int count, int numbers) {
    contacts = count;
    stride = (count + widest - 1) / widest * widest;
    values.assign(static_cast<std::size_t>(stride) * numbers, Real(0));
  }
  Real* row(int number) { return values.data() + number * stride; }
  const Real* row(int number) const { return values.data() + number * stride; }
};

}  // namespace fluxpact
