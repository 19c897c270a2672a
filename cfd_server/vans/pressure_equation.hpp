// Continuity as an equation for the pressure: Σ_f s_f φ_f(p) = source in every cell.
//
// s_f = 1 gives the conservative continuity, s_f = 1/ε_f the legacy one; symmetric either way.
#pragma once

#include <span>

#include "cfd_server/linear/pressure_solver.hpp"
#include "cfd_server/vans/face_flux.hpp"
#include "cfd_server/vans/regions.hpp"

namespace fluxpact {

/// face_scale: s_f, one a face; empty: 1.
void assemble_pressure_matrix(const Stencil& stencil, const BoundaryConditions& conditions,
                              const FluidRegions& regions, const FaceCoefficients& coefficients,
                              std::span<const double> face_scale, PressureMatrix& matrix);

/// rhs = source − Σ s φ_explicit + pressure faces. source [m³/s] one a cell, flux: explicit part
/// [m³/s] one a face.
void assemble_pressure_rhs(const Stencil& stencil, const BoundaryValues& values,
                           const FaceCoefficients& coefficients, std::span<const double> face_scale,
                           std::span<const double> source, std::span<const double> flux,
                           std::span<double> rhs);

}  // namespace fluxpact
