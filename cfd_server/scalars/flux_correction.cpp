#include "cfd_server/scalars/flux_correction.hpp"

#include <algorithm>
#include <cmath>

namespace fluxpact {
namespace {

void widen(CorrectionWork& w, int cell, double lowest, double highest) {
  w.lowest[cell] = std::min(w.lowest[cell], lowest);
  w.highest[cell] = std::max(w.highest[cell], highest);
}

void find_bounds(const Stencil& s, const ScalarBoundary& boundary,
                 std::span<const double> into_owner, std::span<const double> low,
                 std::span<const double> old, CorrectionWork& w) {
  for (int cell = 0; cell < s.cells; ++cell) {
    w.lowest[cell] = std::min(low[cell], old[cell]);
    w.highest[cell] = std::max(low[cell], old[cell]);
  }
  for (int f = 0; f < s.internal_faces; ++f) {
    const int p = s.owner[f];
    const int n = s.neighbour[f];
    widen(w, p, std::min(low[n], old[n]), std::max(low[n], old[n]));
    widen(w, n, std::min(low[p], old[p]), std::max(low[p], old[p]));
  }
  for (int b = 0; b < s.boundary_faces(); ++b) {
    const int f = s.internal_faces + b;
    if (!(into_owner[f] > 0)) continue;
    widen(w, s.owner[f], boundary.value[b], boundary.value[b]);
  }
}

}  // namespace

void resize(CorrectionWork& w, int cells) {
  for (auto* values : {&w.lowest, &w.highest, &w.gain, &w.loss})
    values->assign(static_cast<std::size_t>(cells), 0.0);
}

void limit_correction(const Stencil& s, const ScalarBoundary& boundary,
                      std::span<const double> into_owner, std::span<const double> capacity,
                      std::span<const double> low, std::span<const double> old, CorrectionWork& w,
                      std::span<double> flux) {
  find_bounds(s, boundary, into_owner, low, old, w);
  std::ranges::fill(w.gain, 0.0);
  std::ranges::fill(w.loss, 0.0);
  for (int f = 0; f < s.faces; ++f) {
    const int p = s.owner[f];
    (flux[f] > 0 ? w.loss : w.gain)[p] += std::abs(flux[f]);
    if (f < s.internal_faces) (flux[f] > 0 ? w.gain : w.loss)[s.neighbour[f]] += std::abs(flux[f]);
  }
  for (int cell = 0; cell < s.cells; ++cell) {
    const double room_above = capacity[cell] * (w.highest[cell] - low[cell]);
    const double room_below = capacity[cell] * (low[cell] - w.lowest[cell]);
    w.gain[cell] = w.gain[cell] > room_above ? room_above / w.gain[cell] : 1.0;
    w.loss[cell] = w.loss[cell] > room_below ? room_below / w.loss[cell] : 1.0;
  }
  for (int f = 0; f < s.faces; ++f) {
    const int p = s.owner[f];
    double factor = flux[f] > 0 ? w.loss[p] : w.gain[p];
    if (f < s.internal_faces) {
      const int n = s.neighbour[f];
      factor = std::min(factor, flux[f] > 0 ? w.gain[n] : w.loss[n]);
    }
    flux[f] *= factor;
  }
}

}  // namespace fluxpact
