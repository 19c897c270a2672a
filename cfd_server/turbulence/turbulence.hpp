// The turbulence model of a run: from the flow to the viscosity that the momentum equation feels.
//
// Stands at both ends of a fluid's step: before it, the viscosity of the state it starts from;
// after it, the model's own fields move with the closed fluxes. A scene with `model: none` has none
// of this.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "cfd_server/scalars/scalar_step.hpp"
#include "cfd_server/turbulence/k_epsilon.hpp"
#include "cfd_server/vans/boundary_conditions.hpp"
#include "cfd_server/vans/momentum.hpp"

namespace fluxpact {

class Turbulence {
 public:
  /// Stencil and conditions must outlive this. Throws ConfigError.
  Turbulence(const Scene& scene, const Mesh& mesh, const Stencil& stencil,
             const BoundaryConditions& conditions);

  void start();
  /// Candidate := committed.
  void open_window();
  /// The viscosity for a step from this velocity [m/s], one a cell, with the candidate fields.
  ViscosityFields prepare(std::span<const Vector3> velocity, const BoundaryValues& boundary);
  /// The candidate fields over one step, with the velocity at its end.
  void advance(const FluidStep& step, std::span<const Vector3> velocity,
               const BoundaryValues& boundary);
  void commit();

  /// μ_t [Pa s] of the candidate, one a cell.
  std::span<const double> eddy_viscosity() const { return eddy_; }
  /// k and ε; empty with other models.
  const TurbulentLevel& committed() const { return committed_; }
  const TurbulentLevel& candidate() const { return candidate_; }

 private:
  void find_gradient(std::span<const Vector3> velocity, const BoundaryValues& boundary);
  void find_eddy();

  const Stencil& stencil_;
  const BoundaryConditions& conditions_;
  double density_ = 0;
  double viscosity_ = 0;
  double smagorinsky_constant_ = 0;
  std::vector<Vector3> coefficients_;  ///< of the gradient, one a side
  std::vector<Vector3> jump_;          ///< one a boundary face
  std::vector<Matrix3> gradient_;      ///< one a cell
  std::vector<double> eddy_;           ///< [Pa s] one a cell
  std::vector<double> total_;          ///< [Pa s] molecular and eddy, one a cell
  // model: k_epsilon
  std::optional<KEpsilon> k_epsilon_;
  TurbulentLevel committed_, candidate_;
  std::vector<double> of_boundary_;  ///< [Pa s] one a boundary face
  std::vector<double> strain_;       ///< [1/s] one a cell
  std::vector<double> wall_speed_;   ///< [m/s] one a wall face
};

}  // namespace fluxpact
