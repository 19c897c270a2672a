// Convection and diffusion of a cell vector by given face fluxes, as the net force on each cell.
//
// Net form: Σ_f F (u_f − u_P), which is the conservative form minus u_P times continuity. A uniform
// field therefore feels exactly nothing, whatever the fluxes are.
#pragma once

#include <span>
#include <vector>

#include "cfd_server/discretisation/stencil.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// Held over one window; one entry a face.
struct TransportCoefficients {
  std::vector<double> mass_flux;  ///< F [kg/s], the convecting flux, out of the owner; 0 where
                                  ///< nothing is convected in
  std::vector<double> diffusion;  ///< μ ε_f g [kg/s]; 0 where no value is given
  std::vector<double>
      into_owner;  ///< max(−F, 0) + diffusion: weight of the neighbour's value in the owner
  std::vector<double>
      into_neighbour;  ///< max(F, 0) + diffusion: weight of the owner's value in the neighbour
};

/// Fill into_owner and into_neighbour from mass_flux and diffusion.
void finish_coefficients(TransportCoefficients& coefficients, int threads = 1);

/// force [N] = Σ_f [ a (u_N − u_P) − F (u_higher − u_upwind) + μ ε_f (∇u)_f·k
///                   + μ ε_f ((∇u)ᵀ_f − 2/3 (∇·u)_f)·A ] for each cell.
/// velocity [m/s] and its gradient one a cell; boundary_jump = u_b − u_P, zero where no value is
/// given. limited: van Leer's limiter for each component (van Leer, J. Comput. Phys. 14, 1974,
/// 361-370), in the form for unstructured meshes of Darwish & Moukalled (Int. J. Heat Mass Transfer
/// 46, 2003, 599-611).
void transport_force(const Stencil& stencil, const TransportCoefficients& coefficients,
                     Convection scheme, std::span<const Vector3> velocity,
                     std::span<const Vector3> boundary_jump, std::span<const Matrix3> gradient,
                     std::span<Vector3> force);

}  // namespace fluxpact
