// Sums that have the same bits for any number of threads.
#pragma once

#include <algorithm>
#include <array>

namespace fluxpact {

/// Σ term(i), i < count, over a fixed number of blocks that depends on `count` only; the blocks'
/// sums are added in order. T needs +=; T{} must be zero.
template <class T, class Term>
T blocked_sum(int count, int threads, const Term& term) {
  constexpr int most_blocks = 128;
  constexpr int smallest = 2048;
  const int size = std::max(smallest, (count + most_blocks - 1) / most_blocks);
  const int blocks = (count + size - 1) / size;
  std::array<T, most_blocks> partial{};
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
  for (int block = 0; block < blocks; ++block) {
    T sum{};
    const int last = std::min(count, (block + 1) * size);
    for (int i = block * size; i < last; ++i) sum += term(i);
    partial[static_cast<std::size_t>(block)] = sum;
  }
  T sum{};
  for (int block = 0; block < blocks; ++block) sum += partial[static_cast<std::size_t>(block)];
  return sum;
}

}  // namespace fluxpact
