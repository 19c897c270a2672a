// The momentum balance at the faces: superficial fluxes as a function of the pressure.
//
// Along the path from P over the face to N the two half-cells act in series, each with its own
// voidage and drag, so a voidage jump in one cell is exact. The face remembers its own flux φ^n;
// convection and viscous stress come as net cell forces, their diagonal multiplies a second-order
// face value Q:
//     φ_f = K { H − g (p_N − p_P) − k·∇p },   1/K = w R_P + (1−w) R_N
//     R = (A_t + A_b + A_c)/(χ ε V),   G = (C + S)/(χ V)
//     H = [w G_P + (1−w) G_N]·A + m φ^n + R^c_f Q
// with χ as in momentum.hpp: the face only adds two half-cells, whatever the model.
// In a steady state A_t, A_c and the old flux drop out: the result does not depend on the window.
#pragma once

#include <span>
#include <vector>

#include "cfd_server/discretisation/stencil.hpp"
#include "cfd_server/vans/boundary_conditions.hpp"
#include "cfd_server/vans/momentum.hpp"

namespace fluxpact {

/// Coefficients of one window, the same in all its correctors. One entry a face.
struct FaceCoefficients {
  std::vector<double> mobility;              ///< K [m³ s/kg]; 0 where the flux is given
  std::vector<double> transport_resistance;  ///< R^c_f [kg/(m³ s)]
  std::vector<double> memory;                ///< m φ^n [kg/s²]: inertia of the old fluxes
};

/// How much of Q is rebuilt from the cells at a face: all on uniform lattices; elsewhere mostly the
/// face's own last flux, because the interpolation error of irregular cells would feed back; least
/// beside cells that are not rebuilt from their fluxes (with nothing at all, fluxes that no cell
/// sees would never decay).
double rebuilt_share(const Stencil& stencil, int face);

/// What the levels before leave on a face: ρ (last φ^n − before φ^{n−1})/step [kg/s²].
double carried_flux(const FluidState& old_state, const TimeCoefficients& time, int face);

void resize(FaceCoefficients& coefficients, const Stencil& stencil);

/// pressure_share: χ, one a cell. The old state gives the fluxes that the faces remember.
void assemble_faces(const Stencil& stencil, const BoundaryConditions& conditions,
                    const MomentumCoefficients& momentum, std::span<const double> voidage,
                    std::span<const double> pressure_share, const FluidState& old_state,
                    const TimeCoefficients& time, FaceCoefficients& coefficients);

/// What the flux of one corrector is made of.
struct FaceFluxInput {
  std::span<const Vector3> specific_force;        ///< G = (C(u) + S)/(χ V) [N/m³], one a cell
  std::span<const Vector3> superficial;           ///< q = ε u [m/s], one a cell
  std::span<const Matrix3> superficial_gradient;  ///< ∇q [1/s], one a cell
  std::span<const double> last_flux;  ///< φ of the corrector before [m³/s], one a face
  std::span<const Vector3>
      pressure_gradient;  ///< kinked ∇p [Pa/m], one a cell; empty on orthogonal meshes
};

/// K {H − k·∇p} [m³/s]: the flux but for the pressure difference; where the flux is given, that.
void explicit_flux(const Stencil& stencil, const BoundaryConditions& conditions,
                   const BoundaryValues& values, const FaceCoefficients& coefficients,
                   const FaceFluxInput& input, std::span<double> flux);

/// flux −= K g (p_N − p_P), with p_b at pressure faces [Pa].
void add_pressure_flux(const Stencil& stencil, const BoundaryValues& values,
                       const FaceCoefficients& coefficients, std::span<const double> pressure,
                       std::span<double> flux);

/// The face's first guess in a window: φ^n plus the change of ε u in its two cells [m³/s].
void predict_flux(const Stencil& stencil, const FluidState& old_state, double density,
                  std::span<const Vector3> superficial, std::span<double> flux);

}  // namespace fluxpact
