// What a fluid window must be given, and must not produce: checks at the border of the solver.
#pragma once

#include <cstdint>
#include <span>

#include "cfd_server/discretisation/stencil.hpp"
#include "cfd_server/vans/solver.hpp"

namespace fluxpact {

/// Throws NumericsError naming field, cell, value and step unless 0 < ε <= 1 (one rounding above 1
/// passes).
void check_voidage(const Stencil& stencil, std::span<const double> voidage, std::int64_t step);

/// check_voidage, and: B finite and not negative, S finite, a value for every cell, a window longer
/// than zero.
void check_window(const Stencil& stencil, const Window& window, const SolidsInput& solids);

/// Throws NumericsError naming field, cell or face, and step if the state is not finite.
void check_finite(const Stencil& stencil, const FluidState& state, std::int64_t step);

}  // namespace fluxpact
