#include "proto/mesh/grading.hpp"

#include <cmath>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

/// Share of a part's length behind its first i of n cells whose last is `ratio` times its first:
/// (q^i − 1)/(q^n − 1) with q = ratio^(1/(n − 1)); written so that q near 1 costs no digits.
double share_of_part(int i, int n, double ratio) {
  if (ratio == 1 || n == 1) return static_cast<double>(i) / n;
  const double growth = std::log(ratio) / (n - 1);
  return std::expm1(i * growth) / std::expm1(n * growth);
}

}  // namespace

std::vector<double> node_shares(int cells, std::span<const GradingSettings> parts,
                                std::string_view key) {
  std::vector<double> nodes{0.0};
  if (parts.empty()) {
    for (int i = 1; i <= cells; ++i) nodes.push_back(static_cast<double>(i) / cells);
    return nodes;
  }
  double all_lengths = 0;
  double all_cells = 0;
  for (const GradingSettings& part : parts) {
    all_lengths += part.length;
    all_cells += part.cells;
  }
  double length = 0;
  double share = 0;
  int first = 0;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    share += parts[p].cells;
    const bool last = p + 1 == parts.size();
    const int end = last ? cells : static_cast<int>(std::lround(cells * share / all_cells));
    const int here = end - first;
    if (here < 1 || (here == 1 && parts[p].ratio != 1)) {
      throw ConfigError(
          "{}[{}]: {} of the {} cells are in this part{}; give it a larger share or the axis more "
          "cells",
          key, p, here, cells, here == 1 ? ", and a ratio takes two" : "");
    }
    const double size = parts[p].length / all_lengths;
    for (int i = 1; i <= here; ++i) {
      nodes.push_back(length + size * share_of_part(i, here, parts[p].ratio));
    }
    length += size;
    first = end;
  }
  nodes.back() = 1.0;
  return nodes;
}

}  // namespace fluxpact
