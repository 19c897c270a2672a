#include "cfd_server/vans/window_check.hpp"

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

}  // namespace

void check_voidage(const Stencil& s, std::span<const double> voidage, std::int64_t step) {
  check_size(s, "voidage", voidage.size(), step);
  for (int cell = 0; cell < s.cells; ++cell) {
    if (voidage[cell] > 0 && voidage[cell] <= 1 + 1e-12) continue;
    refuse(s, "voidage", cell, voidage[cell], step,
           "it must lie above 0 and not above 1; cells smaller than the particles need a mapping "
           "that spreads them, or "
           "coarsen the mesh");
  }
}

void check_window(const Stencil& s, const Window& window, const SolidsInput& solids) {
  if (!(window.length > 0) || !std::isfinite(window.length)) {
    throw NumericsError("fluid, step {}: the window is {} s long; coupling.window must be positive",
                        window.step, window.length);
  }
  check_voidage(s, solids.voidage, window.step);
  check_size(s, "drag_coefficient", solids.drag_coefficient.size(), window.step);
  check_size(s, "drag_source", solids.drag_source.size(), window.step);
  for (int cell = 0; cell < s.cells; ++cell) {
    const double drag = solids.drag_coefficient[cell];
    if (!(drag >= 0) || !std::isfinite(drag)) {
      refuse(s, "drag_coefficient", cell, drag, window.step, "it must be finite and not negative");
    }
    const Vector3& source = solids.drag_source[cell];
    if (!source.allFinite())
      refuse(s, "drag_source", cell, source.sum(), window.step, "it must be finite");
  }
}

void check_finite(const Stencil& s, const FluidState& state, std::int64_t step) {
  const char* advice =
      "the window diverged; shorten coupling.window or look at the drag of this cell";
  for (int cell = 0; cell < s.cells; ++cell) {
    if (!state.velocity[cell].allFinite())
      refuse(s, "velocity", cell, state.velocity[cell].sum(), step, advice);
    if (!std::isfinite(state.pressure[cell]))
      refuse(s, "pressure", cell, state.pressure[cell], step, advice);
    if (!state.pressure_gradient[cell].allFinite()) {
      refuse(s, "pressure_gradient", cell, state.pressure_gradient[cell].sum(), step, advice);
    }
  }
  for (int f = 0; f < s.faces; ++f) {
    if (!std::isfinite(state.face_flux[f]))
      refuse(s, "face_flux", s.owner[f], state.face_flux[f], step, advice);
  }
}

}  // namespace fluxpact
