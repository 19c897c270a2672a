#include "cfd_server/scalars/flux_correction.hpp"

#include <algorithm>
#include <cmath>

namespace fluxpact {
namespace {

/// Excess over a range that is rounding [-], of the size of the values: what a steady state or a
/// plateau shows. A cell guarded for its sake would lose its higher-order fluxes for nothing.
constexpr double rounding = 1e-14;

void widen(CorrectionWork& w, int cell, double value) {
  w.lowest[cell] = std::min(w.lowest[cell], value);
  w.highest[cell] = std::max(w.highest[cell], value);
}

void find_bounds(const Stencil& s, const CorrectedField& in, CorrectionWork& w) {
  std::ranges::copy(in.value, w.lowest.begin());
  std::ranges::copy(in.value, w.highest.begin());
  for (int f = 0; f < s.internal_faces; ++f) {
    const int p = s.owner[f];
    const int n = s.neighbour[f];
    widen(w, p, in.value[n]);
    widen(w, n, in.value[p]);
  }
  for (int b = 0; b < s.boundary_faces(); ++b) {
    const int f = s.internal_faces + b;
    if (in.into_owner[f] > 0) widen(w, s.owner[f], in.boundary.value[b]);
  }
}

/// Zalesak's factors of a cell, from all its fluxes uncut.
void guard(const Stencil& s, int cell, std::span<const double> capacity,
           std::span<const double> value, std::span<const double> flux, CorrectionWork& w) {
  double enters = 0;
  double leaves = 0;
  for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
    const double out = s.side_sign[side] * flux[s.side_face[side]];
    (out > 0 ? leaves : enters) += std::abs(out);
  }
  const double room_above = capacity[cell] * (w.highest[cell] - value[cell]);
  const double room_below = capacity[cell] * (value[cell] - w.lowest[cell]);
  const double gain = enters > room_above ? room_above / enters : 1.0;
  const double loss = leaves > room_below ? room_below / leaves : 1.0;
  w.guarded[cell] = 1;
  for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
    const int f = s.side_face[side];
    const bool out = s.side_sign[side] * flux[f] > 0;
    w.factor[f] = std::min(w.factor[f], out ? loss : gain);
  }
}

void apply(const Stencil& s, std::span<const double> capacity, std::span<const double> value,
           std::span<const double> flux, CorrectionWork& w) {
  for (int cell = 0; cell < s.cells; ++cell) {
    double out = 0;
    for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
      const int f = s.side_face[side];
      out += s.side_sign[side] * w.factor[f] * flux[f];
    }
    w.corrected[cell] = value[cell] - out / capacity[cell];
  }
}

bool leaves_its_range(const CorrectionWork& w, int cell) {
  const double slack = rounding * std::max(std::abs(w.lowest[cell]), std::abs(w.highest[cell]));
  return w.corrected[cell] > w.highest[cell] + slack || w.corrected[cell] < w.lowest[cell] - slack;
}

}  // namespace

void resize(CorrectionWork& w, const Stencil& s) {
  const auto cells = static_cast<std::size_t>(s.cells);
  for (auto* values : {&w.lowest, &w.highest, &w.corrected}) values->assign(cells, 0.0);
  w.guarded.assign(cells, 0);
  w.factor.assign(static_cast<std::size_t>(s.faces), 1.0);
}

void limit_correction(const Stencil& s, const CorrectedField& field,
                      std::span<const double> capacity, CorrectionWork& w, std::span<double> flux) {
  find_bounds(s, field, w);
  std::ranges::fill(w.guarded, std::uint8_t{0});
  std::ranges::fill(w.factor, 1.0);
  bool settled = false;
  while (!settled) {
    settled = true;
    apply(s, capacity, field.value, flux, w);
    for (int cell = 0; cell < s.cells; ++cell) {
      if (w.guarded[cell] != 0 || !leaves_its_range(w, cell)) continue;
      guard(s, cell, capacity, field.value, flux, w);
      settled = false;
    }
  }
  for (int f = 0; f < s.faces; ++f) flux[f] *= w.factor[f];
}

}  // namespace fluxpact
