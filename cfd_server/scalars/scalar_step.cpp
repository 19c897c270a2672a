#include "cfd_server/scalars/scalar_step.hpp"

#include <algorithm>
#include <cmath>

#include "cfd_server/discretisation/gradient.hpp"
#include "cfd_server/linear/bicgstab.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

constexpr int most_iterations = 1000;

/// What the step's equation leaves at `value` [kg c/s].
void evaluate_residual(const Stencil& s, const FluidStep& step, const ScalarInput& in,
                       std::span<const double> old, std::span<const double> value,
                       const ScalarWork& w, std::span<double> residual) {
  const double rate = step.density / step.length;
  for (int cell = 0; cell < s.cells; ++cell) {
    const double old_capacity = rate * s.volume[cell] * step.old_voidage[cell];
    residual[cell] = old_capacity * (old[cell] - value[cell]);
    if (!step.closed) {
      const double capacity = rate * s.volume[cell] * step.voidage[cell];
      residual[cell] -= (capacity - old_capacity) * value[cell];
    }
    if (!in.source.empty()) residual[cell] += in.source[cell];
    if (!in.sink.empty()) residual[cell] -= in.sink[cell] * value[cell];
  }
  for (int f = 0; f < s.internal_faces; ++f) {
    const int p = s.owner[f];
    const int n = s.neighbour[f];
    const double difference = value[n] - value[p];
    residual[p] += w.into_owner[f] * difference - w.flux[f];
    residual[n] -= w.into_neighbour[f] * difference - w.flux[f];
    if (step.closed) continue;
    residual[p] -= step.face_flux[f] * value[p];
    residual[n] += step.face_flux[f] * value[n];
  }
  for (int b = 0; b < s.boundary_faces(); ++b) {
    const int f = s.internal_faces + b;
    const int p = s.owner[f];
    if (in.boundary.kind[b] == ScalarFace::influx) {
      residual[p] += in.boundary.value[b];
    } else {
      residual[p] += w.into_owner[f] * (in.boundary.value[b] - value[p]) - w.flux[f];
    }
    if (!step.closed) residual[p] -= step.face_flux[f] * value[p];
  }
}

/// change: A change = residual, from zero. `size`: |diagonal c|² of the field, for what is
/// rounding.
int solve(const Stencil& s, double tolerance, double size, const char* name, ScalarWork& w) {
  const auto multiply = [&](const std::vector<double>& x, std::vector<double>& y) {
#pragma omp parallel for schedule(static) num_threads(s.threads)
    for (int cell = 0; cell < s.cells; ++cell) {
      double sum = w.diagonal[cell] * x[cell];
      for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
        const int other = s.side_other[side];
        if (other >= 0) sum -= w.weight[side] * x[other];
      }
      y[cell] = sum;
    }
  };
  double start = 0;
  for (const double value : w.residual) start += value * value;
  const double target = std::max(tolerance * tolerance * start, 1e-32 * size);
  std::ranges::fill(w.change, 0.0);
  const BicgstabOutcome outcome = solve_bicgstab(multiply, w.diagonal, s.threads, target,
                                                 most_iterations, w.residual, w.change, w.solver);
  if (!outcome.converged) {
    throw NumericsError(
        "fluid: the equation of '{}' has the relative residual {} after {} iterations; shorten "
        "coupling.window",
        name, std::sqrt(outcome.residual_squared / start), outcome.iterations);
  }
  return outcome.iterations;
}

/// w.flux: the deferred fluxes of the old field, as far as it can take them.
void correct(const Stencil& s, const FluidStep& step, const ScalarInput& in,
             std::span<const Vector3> gradient_coefficients, Convection scheme,
             std::span<const double> old, ScalarWork& w) {
  const double rate = step.density / step.length;
  for (int b = 0; b < s.boundary_faces(); ++b) {
    const bool held = in.boundary.kind[b] == ScalarFace::value;
    w.jump[b] = held ? in.boundary.value[b] - old[s.owner[s.internal_faces + b]] : 0.0;
  }
  gradient(s, gradient_coefficients, old, w.jump, w.gradient);
  deferred_flux(s, scheme, step.face_flux, in.conductance, old, w.gradient, w.flux);
  for (int cell = 0; cell < s.cells; ++cell)
    w.capacity[cell] = rate * s.volume[cell] * step.old_voidage[cell];
  limit_correction(s, {old, in.boundary, w.into_owner}, w.capacity, w.correction, w.flux);
}

/// What left through the boundary [kg c/s].
void sum_boundary(const Stencil& s, const FluidStep& step, const ScalarInput& in,
                  const ScalarWork& w, std::span<double> boundary_flux) {
  for (int b = 0; b < s.boundary_faces(); ++b) {
    const int f = s.internal_faces + b;
    const double own = w.solved[s.owner[f]];
    const double flux = step.face_flux[f];
    if (in.boundary.kind[b] == ScalarFace::influx) {
      boundary_flux[b] = flux * own - in.boundary.value[b];
    } else {
      const bool enters = flux < 0 && in.boundary.brings(b);
      boundary_flux[b] = w.flux[f] + flux * (enters ? in.boundary.value[b] : own) -
                         in.conductance[f] * (in.boundary.value[b] - own);
    }
  }
}

}  // namespace

void assemble_transport(const Stencil& s, const FluidStep& step, const ScalarInput& in,
                        ScalarWork& w) {
  const double rate = step.density / step.length;
  for (int cell = 0; cell < s.cells; ++cell) {
    const double old_capacity = rate * s.volume[cell] * step.old_voidage[cell];
    const double capacity = rate * s.volume[cell] * step.voidage[cell];
    w.diagonal[cell] = step.closed ? old_capacity : capacity;
    if (!in.sink.empty()) w.diagonal[cell] += in.sink[cell];
  }
  for (int f = 0; f < s.faces; ++f) {
    const bool internal = f < s.internal_faces;
    const double flux = step.face_flux[f];
    const bool carries = internal || in.boundary.brings(f - s.internal_faces);
    w.into_owner[f] = (carries ? std::max(-flux, 0.0) : 0.0) + in.conductance[f];
    w.into_neighbour[f] = std::max(flux, 0.0) + in.conductance[f];
    w.diagonal[s.owner[f]] += w.into_owner[f];
    if (internal) w.diagonal[s.neighbour[f]] += w.into_neighbour[f];
    if (step.closed) continue;
    // The rest of r: with M^{n+1} on the diagonal it is the sum of the fluxes.
    w.diagonal[s.owner[f]] += flux;
    if (internal) w.diagonal[s.neighbour[f]] -= flux;
  }
  for (std::size_t side = 0; side < s.side_face.size(); ++side) {
    const int f = s.side_face[side];
    w.weight[side] = s.side_other[side] < 0  ? 0.0
                     : s.side_sign[side] > 0 ? w.into_owner[f]
                                             : w.into_neighbour[f];
  }
}

ScalarWork::ScalarWork(const Stencil& s) : solver(static_cast<std::size_t>(s.cells), 0.0) {
  const auto cells = static_cast<std::size_t>(s.cells);
  const auto faces = static_cast<std::size_t>(s.faces);
  for (auto* values : {&diagonal, &capacity, &residual, &change, &solved})
    values->assign(cells, 0.0);
  for (auto* values : {&into_owner, &into_neighbour, &flux}) values->assign(faces, 0.0);
  weight.assign(s.side_face.size(), 0.0);
  jump.assign(static_cast<std::size_t>(s.boundary_faces()), 0.0);
  gradient.assign(cells, Vector3::Zero());
  resize(correction, s);
}

void diffusive_conductance(const Stencil& s, const ScalarBoundary& boundary,
                           std::span<const double> voidage, double molecular,
                           std::span<const double> eddy, double eddy_number,
                           std::span<double> conductance) {
  const auto of_cell = [&](int cell) {
    return voidage[cell] * (molecular + (eddy.empty() ? 0.0 : eddy[cell] / eddy_number));
  };
  for (int f = 0; f < s.internal_faces; ++f) {
    const double own = of_cell(s.owner[f]);
    const double other = of_cell(s.neighbour[f]);
    const double w = s.weight[f];
    const double mean = own > 0 && other > 0 ? own * other / (w * other + (1 - w) * own) : 0.0;
    conductance[f] = mean * s.conductance[f];
  }
  for (int f = s.internal_faces; f < s.faces; ++f) {
    const bool held = boundary.kind[f - s.internal_faces] == ScalarFace::value;
    conductance[f] = held ? of_cell(s.owner[f]) * s.conductance[f] : 0.0;
  }
}

void deferred_flux(const Stencil& s, Convection scheme, std::span<const double> mass_flux,
                   std::span<const double> conductance, std::span<const double> value,
                   std::span<const Vector3> gradient, std::span<double> flux) {
  std::ranges::fill(flux, 0.0);
  for (int f = 0; f < s.internal_faces && scheme != Convection::upwind; ++f) {
    const int p = s.owner[f];
    const int n = s.neighbour[f];
    const bool out = mass_flux[f] >= 0;
    const int upwind = out ? p : n;
    if (scheme == Convection::linear_upwind) {
      flux[f] = mass_flux[f] * gradient[upwind].dot(out ? s.from_owner[f] : s.from_neighbour[f]);
      continue;
    }
    // Harmonic mean of the slopes before and after, zero at an extremum: van Leer's limiter.
    const double after = out ? value[n] - value[p] : value[p] - value[n];
    const double rise = gradient[upwind].dot(s.delta(f)) * (out ? 1 : -1);
    const double before = 2 * rise - after;
    const double share = out ? s.weight[f] : 1 - s.weight[f];
    if (before * after > 0) flux[f] = mass_flux[f] * share * 2 * before * after / (before + after);
  }
  if (s.orthogonal) return;
  for (int f = 0; f < s.faces; ++f) {
    if (conductance[f] == 0) continue;
    const Vector3& own = gradient[s.owner[f]];
    const double w = s.weight[f];
    const Vector3 at_face =
        f < s.internal_faces ? Vector3((1 - w) * own + w * gradient[s.neighbour[f]]) : own;
    flux[f] -= conductance[f] / s.conductance[f] * at_face.dot(s.cross[f]);
  }
}

int advance_scalar(const Stencil& s, const FluidStep& step, const ScalarInput& in,
                   std::span<const Vector3> gradient_coefficients, Convection scheme,
                   double tolerance, const char* name, ScalarWork& w, std::span<double> value,
                   std::span<double> boundary_flux) {
  assemble_transport(s, step, in, w);
  std::ranges::fill(w.flux, 0.0);
  if (scheme != Convection::upwind || !s.orthogonal)
    correct(s, step, in, gradient_coefficients, scheme, value, w);
  evaluate_residual(s, step, in, value, value, w, w.residual);
  double size = 0;
  for (int cell = 0; cell < s.cells; ++cell) size += std::pow(w.diagonal[cell] * value[cell], 2);
  const int iterations = solve(s, tolerance, size, name, w);
  for (int cell = 0; cell < s.cells; ++cell) w.solved[cell] = value[cell] + w.change[cell];
  evaluate_residual(s, step, in, value, w.solved, w, w.residual);
  // The boundary's part belongs to the solved field: before the residual moves it.
  sum_boundary(s, step, in, w, boundary_flux);
  const double rate = step.density / step.length;
  for (int cell = 0; cell < s.cells; ++cell) {
    const double capacity = rate * s.volume[cell] * step.voidage[cell];
    value[cell] = w.solved[cell] + w.residual[cell] / capacity;
  }
  return iterations;
}

}  // namespace fluxpact
