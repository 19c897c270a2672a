// The momentum balance of the fluid in each cell over one window, and its implicit predictor.
//
// For u = u^{n+1}, implicit Euler, pressure shared in proportion to the voidage (model A):
//     (A_t + A_b) u_P − C_P(u) + ε V ∇p = B_t + S
// A_t = ρ V ε^n/Δt is the inertia, B_t = A_t u^n, A_b the drag coefficient, S the drag source, C_P
// the net force of convection and viscous stress ε μ ∇u. It equals the conservative form because
// continuity holds exactly. The transposed part of the stress is left out: it vanishes where ε is
// uniform, and where ε varies drag outweighs it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cfd_server/discretisation/transport.hpp"
#include "cfd_server/linear/momentum_solver.hpp"
#include "cfd_server/vans/boundary_conditions.hpp"
#include "cfd_server/vans/solver.hpp"

namespace fluxpact {

/// What is fixed for a run.
struct FluidProperties {
  double density = 0;    ///< [kg/m³]
  double viscosity = 0;  ///< [Pa s]
  Convection convection = Convection::limited;
};

/// Coefficients of one window. One entry a cell unless stated.
struct MomentumCoefficients {
  std::vector<double> inertia;    ///< A_t [kg/s]
  std::vector<double> drag;       ///< A_b [kg/s]
  std::vector<double> transport;  ///< A_c [kg/s]: sum of the neighbours' weights
  std::vector<Vector3> known;     ///< B_t + S [N]
  std::vector<Vector3> source;    ///< S [N]
  TransportCoefficients faces;    ///< one entry a face
};

void resize(MomentumCoefficients& coefficients, const Stencil& stencil);

/// Fill the coefficients from the committed state (whose flux convects) and the solids at the
/// window's end.
void assemble_momentum(const Stencil& stencil, const BoundaryConditions& conditions,
                       const FluidProperties& fluid, const FluidState& old_state,
                       const SolidsInput& solids, double window,
                       MomentumCoefficients& coefficients);

/// velocity [m/s] += the change that solves the predictor with the deferred parts of `force`
/// frozen: residual = known + force − (A_t + A_b) u − ε V ∇p. Returns the iterations.
int predict_velocity(const Stencil& stencil, const MomentumCoefficients& coefficients,
                     std::span<const double> voidage, std::span<const Vector3> force,
                     std::span<const Vector3> pressure_gradient, MomentumSolver& solver,
                     std::span<Vector3> velocity);

/// ∇p [Pa/m] that closes each cell's balance: [known + C(u_before) + A_c u_before − (A_t + A_b +
/// A_c) u]/(ε V).
void close_momentum(const Stencil& stencil, const MomentumCoefficients& coefficients,
                    std::span<const double> voidage, std::span<const Vector3> force,
                    std::span<const Vector3> velocity_before, std::span<const Vector3> velocity,
                    std::span<Vector3> pressure_gradient);

}  // namespace fluxpact
