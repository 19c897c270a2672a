#include "cfd_server/vans/flow_fields.hpp"

#include <algorithm>

#include "cfd_server/discretisation/gradient.hpp"

namespace fluxpact {

FlowFields::FlowFields(const Scene& scene, const FluidProblem& problem) : problem_(problem) {
  const Stencil& s = problem.stencil;
  const auto cells = static_cast<std::size_t>(s.cells);
  turbulent_ = has_force(scene, InterphaseForce::turbulent_dispersion);
  if (has_force(scene, InterphaseForce::viscous)) {
    viscous_force_.resize(cells);
    for (auto* values :
         {&stress_.mass_flux, &stress_.diffusion, &stress_.into_owner, &stress_.into_neighbour}) {
      values->assign(static_cast<std::size_t>(s.faces), 0.0);
    }
  }
  if (has_force(scene, InterphaseForce::added_mass)) acceleration_.resize(cells);
  if (has_force(scene, InterphaseForce::saffman_lift) ||
      has_force(scene, InterphaseForce::magnus_lift)) {
    vorticity_.resize(cells);
  }
  if (viscous_force_.empty() && acceleration_.empty() && vorticity_.empty()) return;
  jump_.resize(static_cast<std::size_t>(s.boundary_faces()));
  gradient_.resize(cells);
}

void FlowFields::update(std::span<const Vector3> velocity, std::span<const double> voidage,
                        const BoundaryValues& boundary) {
  if (gradient_.empty()) return;
  const Stencil& s = problem_.stencil;
  boundary_jump(s, problem_.conditions, boundary.velocity, velocity, jump_);
  gradient(s, problem_.gradient, velocity, jump_, gradient_);
  if (!viscous_force_.empty()) find_viscous_force(velocity, voidage);
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int cell = 0; cell < s.cells; ++cell) {
    const Matrix3& g = gradient_[cell];
    if (!acceleration_.empty()) acceleration_[cell] = g * velocity[cell];
    if (!vorticity_.empty()) {
      vorticity_[cell] = {g(2, 1) - g(1, 2), g(0, 2) - g(2, 0), g(1, 0) - g(0, 1)};
    }
  }
}

void FlowFields::find_viscous_force(std::span<const Vector3> velocity,
                                    std::span<const double> voidage) {
  const Stencil& s = problem_.stencil;
  transport_coefficients(s, problem_.conditions, problem_.fluid, stress_.mass_flux, voidage, {},
                         stress_);
  transport_force(s, stress_, Convection::upwind, velocity, jump_, gradient_, viscous_force_);
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int cell = 0; cell < s.cells; ++cell) viscous_force_[cell] /= s.volume[cell];
}

}  // namespace fluxpact
