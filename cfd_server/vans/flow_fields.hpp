// What the forces on the particles need of the flow beyond velocity and pressure: after each
// window, from its velocity. Only what the scene's forces ask for is computed, and has memory.
//
// Gradients are the least-squares ones of the momentum equation, so exact for a linear velocity on
// any mesh; the viscous force is the sum over the faces of the same stress that the fluid feels.
#pragma once

#include <span>
#include <vector>

#include "cfd_server/vans/window_solver.hpp"

namespace fluxpact {

class FlowFields {
 public:
  FlowFields(const Scene& scene, const FluidProblem& problem);

  /// velocity [m/s] and voidage one a cell, `boundary` of the same moment.
  void update(std::span<const Vector3> velocity, std::span<const double> voidage,
              const BoundaryValues& boundary);

  /// ∇·[ε μ (∇u + ∇uᵀ − 2/3 ∇·u)] [N/m³] with the molecular viscosity: the part of the stress that
  /// acts on a particle's surface (Reynolds stresses do not). Empty if not asked for; so are the
  /// others.
  std::span<const Vector3> viscous_force() const { return viscous_force_; }
  /// (u·∇)u [m/s²]
  std::span<const Vector3> convective_acceleration() const { return acceleration_; }
  /// ∇×u [1/s]
  std::span<const Vector3> vorticity() const { return vorticity_; }
  bool turbulent() const { return turbulent_; }  ///< whether k and ε are asked for

 private:
  void find_viscous_force(std::span<const Vector3> velocity, std::span<const double> voidage);

  const FluidProblem& problem_;
  bool turbulent_ = false;
  std::vector<Vector3> jump_;      ///< one a boundary face
  std::vector<Matrix3> gradient_;  ///< one a cell
  std::vector<Vector3> viscous_force_, acceleration_, vorticity_;
  TransportCoefficients stress_;  ///< of a fluid that convects nothing
};

}  // namespace fluxpact
