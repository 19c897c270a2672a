// What the scene prescribes at each boundary face, and its values for one step.
//
// Read once from scene.fluid.boundaries; the values are renewed for the end of each step, because a
// formula may carry the time and an interstitial velocity carries the voidage of the adjacent cell.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "cfd_server/discretisation/stencil.hpp"
#include "cfd_server/vans/profile.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

enum class FaceKind : std::uint8_t {
  fixed_flux,  ///< flux and velocity are given: inlets, walls to which the fluid sticks
  slip,        ///< no flux; the wall drags a share of the tangential velocity along
  pressure,    ///< pressure is given, the flux is solved for; what flows in has the velocity of the
               ///< cell
};

/// What holds on one patch, as functions of place and time.
struct PatchCondition {
  std::string name;
  int first = 0;  ///< boundary faces [first, first + size)
  int size = 0;
  BoundaryType type = BoundaryType::wall;
  bool is_interstitial = false;  ///< type velocity
  VectorValue velocity;          ///< [m/s] types velocity and wall
  FormulaValue scalar;           ///< [Pa] type pressure; [kg/s] type mass_flow
  ProfileFactor factor;
  Vector3 centre{0, 0, 0};  ///< [m] where the formula of a mass flow is evaluated
  double area = 0;          ///< [m²] sum of |A|; type mass_flow: weighted by the profile's shape
  bool varies = false;      ///< in time
};

/// One entry a boundary face (face − internal faces) unless stated.
struct BoundaryConditions {
  std::vector<PatchCondition> patches;
  std::vector<FaceKind> kind;
  std::vector<double> grip;  ///< [-] slip faces: share of the tangential velocity difference to the
                             ///< wall that falls off within the cell: 0 free, 1 no slip
  std::vector<Vector3> centre;  ///< [m]
  double density = 0;           ///< [kg/m³]
  Vector3 gravity{0, 0, 0};     ///< [m/s²]
  double level =
      0;  ///< [Pa] mean of p_b − ρ g·x_f at time 0: left out in the solver to save digits
};

/// What holds at the boundary at the end of one step; one entry a boundary face.
struct BoundaryValues {
  std::vector<Vector3> given;  ///< [m/s] as the scene says it: superficial or interstitial
  std::vector<double>
      flux;  ///< [m³/s] superficial, out of the domain; 0 at slip and pressure faces
  std::vector<Vector3> superficial;  ///< [m/s] fixed_flux and slip faces
  std::vector<Vector3> velocity;     ///< [m/s] interstitial, fixed_flux and slip faces
  std::vector<double> pressure;      ///< [Pa] pressure faces: p_b − ρ g·x_f − level
};

/// Conditions of every patch. The patch `walls` has a default (no-slip wall); any other patch
/// without an entry, an entry without a patch, or an incomplete entry is a ConfigError.
BoundaryConditions read_boundaries(const Scene& scene, const Mesh& mesh, const Stencil& stencil);

/// Values for this voidage (one a cell) and time [s]. Sizes the arrays on first use. Throws
/// NumericsError naming patch, face and time where a formula gives no finite value.
void update_boundary_values(const Stencil& stencil, const BoundaryConditions& conditions,
                            std::span<const double> voidage, double time, BoundaryValues& values);

/// jump = φ_b − φ_P with φ_b from `prescribed` at fixed_flux faces; at slip faces minus the normal
/// part of φ_P and `grip` of the tangential difference; zero at pressure faces. One entry a
/// boundary face, the unit of `field`.
void boundary_jump(const Stencil& stencil, const BoundaryConditions& conditions,
                   std::span<const Vector3> prescribed, std::span<const Vector3> field,
                   std::span<Vector3> jump);

/// 1 for the boundary faces that give a velocity: all but pressure faces.
std::vector<std::uint8_t> faces_with_velocity(const BoundaryConditions& conditions);

}  // namespace fluxpact
