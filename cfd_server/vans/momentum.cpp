#include "cfd_server/vans/momentum.hpp"

#include "cfd_server/linear/blocked_sum.hpp"

namespace fluxpact {
namespace {

/// Weight of what lies across a side of a cell [kg/s].
double weight_of_side(const Stencil& s, const TransportCoefficients& faces, int side) {
  const int f = s.side_face[side];
  return s.side_sign[side] > 0 ? faces.into_owner[f] : faces.into_neighbour[f];
}

}  // namespace

void resize(MomentumCoefficients& c, const Stencil& s) {
  const auto cells = static_cast<std::size_t>(s.cells);
  const auto faces = static_cast<std::size_t>(s.faces);
  for (auto* values : {&c.inertia, &c.transport}) values->assign(cells, 0.0);
  c.known.assign(cells, Vector3::Zero());
  for (auto* values :
       {&c.faces.mass_flux, &c.faces.diffusion, &c.faces.into_owner, &c.faces.into_neighbour}) {
    values->assign(faces, 0.0);
  }
}

void transport_coefficients(const Stencil& s, const BoundaryConditions& conditions,
                            const FluidProperties& fluid, std::span<const double> flux,
                            std::span<const double> voidage, const ViscosityFields& viscosity,
                            TransportCoefficients& faces) {
  const auto stress = [&](int cell) {
    return (viscosity.of_cells.empty() ? fluid.viscosity : viscosity.of_cells[cell]) *
           voidage[cell];
  };
  const auto boundary_stress = [&](int f) {
    const int cell = s.owner[f];
    return viscosity.of_boundary.empty()
               ? stress(cell)
               : viscosity.of_boundary[f - s.internal_faces] * voidage[cell];
  };
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int f = 0; f < s.internal_faces; ++f) {
    const double w = s.weight[f];
    faces.mass_flux[f] = flux[f];
    faces.diffusion[f] =
        ((1 - w) * stress(s.owner[f]) + w * stress(s.neighbour[f])) * s.conductance[f];
  }
  for (int f = s.internal_faces; f < s.faces; ++f) {
    // Through a pressure face the cell's own velocity passes, either way: no net force.
    const bool fixed = conditions.kind[f - s.internal_faces] == FaceKind::fixed_flux;
    faces.mass_flux[f] = fixed ? flux[f] : 0.0;
    faces.diffusion[f] = fixed ? boundary_stress(f) * s.conductance[f] : 0.0;
  }
  finish_coefficients(faces, s.threads);
  for (int f = s.internal_faces; f < s.faces; ++f) {
    // A wall that fluid slips along holds the normal part of the velocity and a share of the rest:
    // it has a weight, but no gradient of its own.
    if (conditions.kind[f - s.internal_faces] == FaceKind::slip) {
      faces.into_owner[f] = boundary_stress(f) * s.conductance[f];
    }
  }
}

void assemble_momentum(const Stencil& s, const BoundaryConditions& conditions,
                       const FluidProperties& fluid, const FluidState& old_state,
                       const SolidsInput& solids, const TimeCoefficients& time,
                       std::span<const double> convecting, const ViscosityFields& viscosity,
                       MomentumCoefficients& c) {
  transport_coefficients(s, conditions, fluid, convecting, solids.voidage, viscosity, c.faces);
  c.drag = solids.drag_coefficient;
  c.source = solids.drag_source;
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int cell = 0; cell < s.cells; ++cell) {
    double transport = 0;
    for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side)
      transport += weight_of_side(s, c.faces, side);
    c.transport[cell] = transport;
    const double mass = fluid.density * s.volume[cell] / time.step;
    c.inertia[cell] = mass * time.last * old_state.voidage[cell];
    Vector3 carried = c.inertia[cell] * old_state.velocity[cell];
    if (time.two_steps()) {
      const double before = mass * time.before * old_state.before.voidage[cell];
      c.inertia[cell] -= before;
      carried -= before * old_state.before.velocity[cell];
    }
    c.known[cell] = carried + c.source[cell];
  }
}

int predict_velocity(const Stencil& s, const MomentumCoefficients& c,
                     std::span<const double> pressure_share, std::span<const Vector3> force,
                     std::span<const Vector3> pressure_gradient, MomentumSolver& solver,
                     std::span<Vector3> velocity) {
  const double scale = blocked_sum<double>(s.cells, s.threads, [&](int cell) {
    const double diagonal = c.inertia[cell] + c.drag[cell];
    solver.diagonal[cell] = diagonal + c.transport[cell];
    const Vector3 pressure_force = pressure_share[cell] * s.volume[cell] * pressure_gradient[cell];
    const Vector3 resisted = diagonal * velocity[cell];
    solver.residual[cell] = c.known[cell] + force[cell] - resisted - pressure_force;
    // Of all terms: in a fluid that starts from rest most of them vanish.
    return c.known[cell].squaredNorm() + force[cell].squaredNorm() + resisted.squaredNorm() +
           pressure_force.squaredNorm();
  });
  solver.into_owner = c.faces.into_owner;
  solver.into_neighbour = c.faces.into_neighbour;
  for (SlipFace& face : solver.slip) face.weight = face.slipping * c.faces.into_owner[face.face];
  const int iterations = solver.solve(scale);
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int cell = 0; cell < s.cells; ++cell) velocity[cell] += solver.change[cell];
  return iterations;
}

void close_momentum(const Stencil& s, const MomentumCoefficients& c,
                    std::span<const double> pressure_share, std::span<const Vector3> force,
                    std::span<const Vector3> velocity_before, std::span<const Vector3> velocity,
                    std::span<Vector3> pressure_gradient) {
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int cell = 0; cell < s.cells; ++cell) {
    pressure_gradient[cell] = (c.known[cell] + force[cell] +
                               c.transport[cell] * (velocity_before[cell] - velocity[cell]) -
                               (c.inertia[cell] + c.drag[cell]) * velocity[cell]) /
                              (pressure_share[cell] * s.volume[cell]);
  }
}

void balance_cells(const Stencil& s, const BoundaryConditions& conditions,
                   const MomentumCoefficients& c, std::span<const double> pressure_share,
                   std::span<const Vector3> force, std::span<const Vector3> velocity_before,
                   std::span<const Vector3> gradient, std::span<Vector3> velocity) {
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int cell = 0; cell < s.cells; ++cell) {
    if (s.few_faces[cell] == 0) continue;
    const double whole = c.inertia[cell] + c.drag[cell] + c.transport[cell];
    double stiffest = c.drag[cell] / c.inertia[cell];
    bool extrapolated = false;
    for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
      const int other = s.side_other[side];
      if (other >= 0) stiffest = std::max(stiffest, c.drag[other] / c.inertia[other]);
      const int b = s.side_face[side] - s.internal_faces;
      extrapolated = extrapolated || (b >= 0 && conditions.kind[b] == FaceKind::pressure);
    }
    const double dragged = extrapolated ? 0.0 : stiffest / (1 + stiffest);
    const Vector3 driving = c.known[cell] + force[cell] +
                            c.transport[cell] * velocity_before[cell] -
                            pressure_share[cell] * s.volume[cell] * gradient[cell];
    velocity[cell] = dragged * velocity[cell] + (1 - dragged) * driving / whole;
  }
}

}  // namespace fluxpact
