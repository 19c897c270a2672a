#include "cfd_server/vans/window_check.hpp"

#include <algorithm>
#include <cmath>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

[[noreturn]] void refuse(const Stencil& s, const char* field, int cell, double value,
                         std::int64_t step, const char* why) {
  const Vector3& at = s.centre[cell];
  throw NumericsError("fluid, step {}: {} is {} in cell {} at ({:.6g}, {:.6g}, {:.6g}): {}", step,
                      field, value, cell, at.x(), at.y(), at.z(), why);
}

void check_size(const Stencil& s, const char* field, std::size_t size, std::int64_t step) {
  if (size == static_cast<std::size_t>(s.cells)) return;
  throw NumericsError("fluid, step {}: {} has {} values, the mesh has {} cells", step, field, size,
                      s.cells);
}

/// The first of `count` of which bad(i) holds, or −1.
template <class Bad>
int first_bad(int count, int threads, const Bad& bad) {
  int first = count;
#pragma omp parallel for schedule(static) num_threads(threads) reduction(min : first)
  for (int i = 0; i < count; ++i) {
    if (bad(i)) first = std::min(first, i);
  }
  return first < count ? first : -1;
}

}  // namespace

void check_voidage(const Stencil& s, std::span<const double> voidage, std::int64_t step) {
  check_size(s, "voidage", voidage.size(), step);
  const int cell = first_bad(
      s.cells, s.threads, [&](int at) { return !(voidage[at] > 0 && voidage[at] <= 1 + 1e-12); });
  if (cell < 0) return;
  refuse(s, "voidage", cell, voidage[cell], step,
         "it must lie above 0 and not above 1; cells smaller than the particles need a mapping "
         "that spreads them, or "
         "coarsen the mesh");
}

void check_window(const Stencil& s, const Window& window, const SolidsInput& solids) {
  if (!(window.length > 0) || !std::isfinite(window.length)) {
    throw NumericsError("fluid, step {}: the window is {} s long; coupling.window must be positive",
                        window.step, window.length);
  }
  check_voidage(s, solids.voidage, window.step);
  check_size(s, "drag_coefficient", solids.drag_coefficient.size(), window.step);
  check_size(s, "drag_source", solids.drag_source.size(), window.step);
  if (!solids.pressure_return.empty()) {
    check_size(s, "pressure_return", solids.pressure_return.size(), window.step);
    const int wrong = first_bad(s.cells, s.threads, [&](int at) {
      return !(solids.pressure_return[at] >= 0) || !std::isfinite(solids.pressure_return[at]);
    });
    if (wrong >= 0) {
      refuse(s, "pressure_return", wrong, solids.pressure_return[wrong], window.step,
             "it must be finite and not negative");
    }
  }
  const auto drag_is_bad = [&](int cell) {
    const double drag = solids.drag_coefficient[cell];
    return !(drag >= 0) || !std::isfinite(drag);
  };
  const int cell = first_bad(s.cells, s.threads, [&](int at) {
    return drag_is_bad(at) || !solids.drag_source[at].allFinite();
  });
  if (cell < 0) return;
  if (drag_is_bad(cell)) {
    refuse(s, "drag_coefficient", cell, solids.drag_coefficient[cell], window.step,
           "it must be finite and not negative");
  }
  refuse(s, "drag_source", cell, solids.drag_source[cell].sum(), window.step, "it must be finite");
}

void check_finite(const Stencil& s, const FluidState& state, std::int64_t step) {
  const char* advice =
      "the window diverged; shorten coupling.window or look at the drag of this cell";
  const int cell = first_bad(s.cells, s.threads, [&](int at) {
    return !state.velocity[at].allFinite() || !std::isfinite(state.pressure[at]) ||
           !state.pressure_gradient[at].allFinite();
  });
  if (cell >= 0) {
    if (!state.velocity[cell].allFinite())
      refuse(s, "velocity", cell, state.velocity[cell].sum(), step, advice);
    if (!std::isfinite(state.pressure[cell]))
      refuse(s, "pressure", cell, state.pressure[cell], step, advice);
    refuse(s, "pressure_gradient", cell, state.pressure_gradient[cell].sum(), step, advice);
  }
  const int f =
      first_bad(s.faces, s.threads, [&](int at) { return !std::isfinite(state.face_flux[at]); });
  if (f >= 0) refuse(s, "face_flux", s.owner[f], state.face_flux[f], step, advice);
}

}  // namespace fluxpact
