// What the scene prescribes at each boundary face, and its values for one window.
//
// Read once from scene.fluid.boundaries; the values are renewed at the start of each window because
// an interstitial velocity carries the voidage of the adjacent cell.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cfd_server/discretisation/stencil.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

enum class FaceKind : std::uint8_t {
  fixed_flux,  ///< flux and velocity are given: inlets, no-slip walls
  free_slip,   ///< no flux, no tangential stress
  pressure,    ///< pressure is given, the flux is solved for; what flows in has the velocity of the
               ///< cell
};

/// One entry a boundary face (face − internal faces).
struct BoundaryConditions {
  std::vector<FaceKind> kind;
  std::vector<Vector3> given;  ///< [m/s] fixed_flux: superficial, or interstitial where flagged
  std::vector<std::uint8_t> is_interstitial;
  std::vector<double> pressure;  ///< [Pa] pressure faces: p_b − ρ g·x_f − level
  double level = 0;  ///< [Pa] mean of p_b − ρ g·x_f: subtracted inside the solver to save digits
};

/// What holds at the boundary during one window; one entry a boundary face.
struct BoundaryValues {
  std::vector<double>
      flux;  ///< [m³/s] superficial, out of the domain; fixed_flux and free_slip faces
  std::vector<Vector3> superficial;  ///< [m/s] fixed_flux faces
  std::vector<Vector3> velocity;     ///< [m/s] interstitial, fixed_flux faces
};

/// Conditions of every patch. The patch `walls` has a default (no-slip wall); any other patch
/// without an entry, an entry without a patch, or an incomplete entry is a ConfigError.
BoundaryConditions read_boundaries(const Scene& scene, const Mesh& mesh);

/// Values for this voidage (one a cell). Sizes the arrays on first use.
void update_boundary_values(const Stencil& stencil, const BoundaryConditions& conditions,
                            std::span<const double> voidage, BoundaryValues& values);

/// jump = φ_b − φ_P with φ_b from `prescribed` at fixed_flux faces; minus the normal part of φ_P at
/// free_slip faces; zero at pressure faces. One entry a boundary face, the unit of `field`.
void boundary_jump(const Stencil& stencil, const BoundaryConditions& conditions,
                   std::span<const Vector3> prescribed, std::span<const Vector3> field,
                   std::span<Vector3> jump);

/// 1 for the boundary faces that give a velocity (all but pressure faces), or (of_pressure) a
/// pressure.
std::vector<std::uint8_t> faces_with_value(const BoundaryConditions& conditions, bool of_pressure);

}  // namespace fluxpact
