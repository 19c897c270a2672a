// The momentum balance of the fluid in each cell over one window, and its implicit predictor.
//
// For u = u^{n+1}, with χ = ε where fluid and particles share the pressure gradient (model A) and
// χ = 1 where the fluid bears it alone (model B; Gidaspow, Multiphase Flow and Fluidization, 1994);
// where particles answer the gradient within the window, with what they return of it:
//     (A_t + A_b) u_P − C_P(u) + χ V ∇p = B_t + S
// A_t = ρ V ε^n/Δt is the inertia, B_t = A_t u^n (Euler; see time_scheme.hpp), A_b the drag
// coefficient, S the drag source, C_P the net force of convection and of the viscous stress
// ε μ (∇u + ∇uᵀ − 2/3 ∇·u). It equals the conservative form because continuity holds exactly.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cfd_server/discretisation/transport.hpp"
#include "cfd_server/linear/momentum_solver.hpp"
#include "cfd_server/vans/boundary_conditions.hpp"
#include "cfd_server/vans/solver.hpp"
#include "cfd_server/vans/time_scheme.hpp"

namespace fluxpact {

/// What is fixed for a run.
struct FluidProperties {
  double density = 0;    ///< [kg/m³]
  double viscosity = 0;  ///< [Pa s]
  Convection convection = Convection::limited;
};

/// Where turbulence adds to the fluid's own viscosity [Pa s]; empty without a model.
struct ViscosityFields {
  std::span<const double> of_cells;
  std::span<const double> of_boundary;  ///< one a boundary face, with wall functions; empty: that
                                        ///< of the cell
};

/// Coefficients of one window. One entry a cell unless stated.
struct MomentumCoefficients {
  std::vector<double> inertia;      ///< A_t [kg/s]
  std::span<const double> drag;     ///< A_b [kg/s], of the solids
  std::vector<double> transport;    ///< A_c [kg/s]: sum of the neighbours' weights
  std::vector<Vector3> known;       ///< B_t + S [N]
  std::span<const Vector3> source;  ///< S [N], of the solids
  TransportCoefficients faces;      ///< one entry a face
};

void resize(MomentumCoefficients& coefficients, const Stencil& stencil);

/// Convection by the flux Φ [kg/s] and the viscous stress of ε μ, one entry a face. voidage one a
/// cell.
void transport_coefficients(const Stencil& stencil, const BoundaryConditions& conditions,
                            const FluidProperties& fluid, std::span<const double> flux,
                            std::span<const double> voidage, const ViscosityFields& viscosity,
                            TransportCoefficients& faces);

/// Fill the coefficients from the last state and the solids at the step's end, whose drag they go
/// on to read. convecting: Φ [kg/s], one a face.
void assemble_momentum(const Stencil& stencil, const BoundaryConditions& conditions,
                       const FluidProperties& fluid, const FluidState& old_state,
                       const SolidsInput& solids, const TimeCoefficients& time,
                       std::span<const double> convecting, const ViscosityFields& viscosity,
                       MomentumCoefficients& coefficients);

/// velocity [m/s] += the change that solves the predictor with the deferred parts of `force`
/// frozen: residual = known + force − (A_t + A_b) u − χ V ∇p. pressure_share: χ, one a cell.
/// Returns the iterations.
int predict_velocity(const Stencil& stencil, const MomentumCoefficients& coefficients,
                     std::span<const double> pressure_share, std::span<const Vector3> force,
                     std::span<const Vector3> pressure_gradient, MomentumSolver& solver,
                     std::span<Vector3> velocity);

/// ∇p [Pa/m] that closes each cell's balance: [known + C(u_before) + A_c u_before − (A_t + A_b +
/// A_c) u]/(χ V).
void close_momentum(const Stencil& stencil, const MomentumCoefficients& coefficients,
                    std::span<const double> pressure_share, std::span<const Vector3> force,
                    std::span<const Vector3> velocity_before, std::span<const Vector3> velocity,
                    std::span<Vector3> pressure_gradient);

/// Cells with too few faces to be rebuilt from their fluxes alone (Stencil::few_faces): velocity
/// [m/s], in: as rebuilt; out: the mean of that and of what the cell's balance gives with this ∇p
/// [Pa/m], by x/(1 + x) with the largest drag over inertia x of the cell and its neighbours. A
/// rebuilt velocity errs from cell to cell, which viscous stress and convection would feed on; in a
/// bed and beside it drag rules, and a balance would magnify the error of the gradient. At a
/// pressure face the balance alone counts: what is rebuilt there rests on an extrapolated gradient
/// of the velocity, which would feed back. Other cells are left alone.
void balance_cells(const Stencil& stencil, const BoundaryConditions& conditions,
                   const MomentumCoefficients& coefficients, std::span<const double> pressure_share,
                   std::span<const Vector3> force, std::span<const Vector3> velocity_before,
                   std::span<const Vector3> gradient, std::span<Vector3> velocity);

}  // namespace fluxpact
