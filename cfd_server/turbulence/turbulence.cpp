#include "cfd_server/turbulence/turbulence.hpp"

#include <algorithm>

#include "cfd_server/discretisation/gradient.hpp"
#include "cfd_server/turbulence/eddy_viscosity.hpp"

namespace fluxpact {

Turbulence::Turbulence(const Scene& scene, const Mesh& mesh, const Stencil& s,
                       const BoundaryConditions& conditions)
    : stencil_(s),
      conditions_(conditions),
      density_(scene.fluid.density),
      viscosity_(scene.fluid.viscosity),
      smagorinsky_constant_(scene.fluid.turbulence.smagorinsky_constant),
      coefficients_(gradient_coefficients(s, faces_with_velocity(conditions))) {
  const auto cells = static_cast<std::size_t>(s.cells);
  jump_.assign(static_cast<std::size_t>(s.boundary_faces()), Vector3::Zero());
  gradient_.assign(cells, Matrix3::Zero());
  eddy_.assign(cells, 0.0);
  total_.assign(cells, viscosity_);
  if (scene.fluid.turbulence.model != TurbulenceModel::k_epsilon) return;
  k_epsilon_.emplace(scene, mesh, s);
  of_boundary_.assign(jump_.size(), viscosity_);
  strain_.assign(cells, 0.0);
  wall_speed_.assign(k_epsilon_->walls().size(), 0.0);
}

void Turbulence::start() {
  if (k_epsilon_) committed_ = k_epsilon_->start();
  candidate_ = committed_;
}

void Turbulence::open_window() {
  std::ranges::copy(committed_.energy, candidate_.energy.begin());
  std::ranges::copy(committed_.dissipation, candidate_.dissipation.begin());
}

void Turbulence::find_gradient(std::span<const Vector3> velocity, const BoundaryValues& boundary) {
  boundary_jump(stencil_, conditions_, boundary.velocity, velocity, jump_);
  gradient(stencil_, coefficients_, velocity, jump_, gradient_);
}

void Turbulence::find_eddy() {
  if (k_epsilon_) {
    k_epsilon_->find_viscosity(candidate_, density_, eddy_);
  } else {
    smagorinsky_viscosity(density_, smagorinsky_constant_, stencil_.volume, gradient_, eddy_);
  }
}

ViscosityFields Turbulence::prepare(std::span<const Vector3> velocity,
                                    const BoundaryValues& boundary) {
  if (!k_epsilon_) find_gradient(velocity, boundary);
  find_eddy();
  for (int cell = 0; cell < stencil_.cells; ++cell) total_[cell] = viscosity_ + eddy_[cell];
  if (!k_epsilon_) return {total_, {}};
  for (int b = 0; b < stencil_.boundary_faces(); ++b)
    of_boundary_[b] = total_[stencil_.owner[stencil_.internal_faces + b]];
  for (const WallFace& wall : k_epsilon_->walls())
    of_boundary_[wall.face] = k_epsilon_->wall_viscosity(candidate_, wall, density_, viscosity_);
  return {total_, of_boundary_};
}

void Turbulence::advance(const FluidStep& step, std::span<const Vector3> velocity,
                         const BoundaryValues& boundary) {
  find_gradient(velocity, boundary);
  if (k_epsilon_) {
    for (int cell = 0; cell < stencil_.cells; ++cell) strain_[cell] = strain_rate(gradient_[cell]);
    const std::vector<WallFace>& walls = k_epsilon_->walls();
    for (std::size_t i = 0; i < walls.size(); ++i) {
      const int f = stencil_.internal_faces + walls[i].face;
      const Vector3 normal = stencil_.area[f] / stencil_.area_size(f);
      const Vector3& jump = jump_[walls[i].face];
      wall_speed_[i] = (jump - jump.dot(normal) * normal).norm();
    }
    k_epsilon_->advance(step, {density_, viscosity_, strain_, wall_speed_, boundary.velocity},
                        eddy_, candidate_);
  }
  find_eddy();
}

void Turbulence::commit() { std::swap(committed_, candidate_); }

}  // namespace fluxpact
