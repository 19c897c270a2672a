// The memory of BiCGSTAB (bicgstab.hpp), for those that keep it from solve to solve.
#pragma once

#include <cstddef>
#include <vector>

namespace fluxpact {

/// Memory of a solve, one entry a cell each.
template <class Value>
struct BicgstabWork {
  explicit BicgstabWork(std::size_t cells, const Value& zero)
      : shadow(cells, zero),
        direction(cells, zero),
        hat(cells, zero),
        product(cells, zero),
        second(cells, zero) {}
  std::vector<Value> shadow, direction, hat, product, second;
};

}  // namespace fluxpact
