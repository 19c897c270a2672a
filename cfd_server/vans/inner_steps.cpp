#include "cfd_server/vans/inner_steps.hpp"

#include <algorithm>
#include <cmath>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

constexpr int most_inner_steps = 1000;

/// Whether a front of the voidage crosses half a cell or more: a cell changes by more than half the
/// difference to its neighbours, and by more than noise of moving particles.
bool has_fast_front(const Stencil& s, std::span<const double> old_voidage,
                    std::span<const double> voidage) {
  constexpr double noise = 0.1;
  for (int cell = 0; cell < s.cells; ++cell) {
    const double change = std::abs(voidage[cell] - old_voidage[cell]);
    if (change <= noise) continue;
    double jump = 0;
    for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
      const int other = s.side_other[side];
      if (other < 0) continue;
      jump = std::max({jump, std::abs(old_voidage[other] - old_voidage[cell]),
                       std::abs(voidage[other] - voidage[cell])});
    }
    if (change > 0.5 * jump) return true;
  }
  return false;
}

/// How often a second the fluid in a cell is replaced [1/s].
double renewal_rate(const FluidProblem& problem, const FluidState& state,
                    const BoundaryValues& boundary, std::span<const double> voidage, int cell) {
  const Stencil& s = problem.stencil;
  double out = 0;
  double in = 0;
  for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
    const int f = s.side_face[side];
    double flux = s.side_sign[side] * state.face_flux[f];
    if (f >= s.internal_faces &&
        problem.conditions.kind[f - s.internal_faces] != FaceKind::pressure) {
      flux = problem.fluid.density * boundary.flux[f - s.internal_faces];
    }
    (flux > 0 ? out : in) += std::abs(flux);
  }
  const double held =
      problem.fluid.density * s.volume[cell] * std::min(voidage[cell], state.voidage[cell]);
  return std::max(in, out) / held;
}

}  // namespace

double courant_number(const FluidProblem& problem, const FluidState& state,
                      const BoundaryValues& boundary, std::span<const double> voidage,
                      double window) {
  const Stencil& s = problem.stencil;
  double largest = 0;
#pragma omp parallel for schedule(static) num_threads(s.threads) reduction(max : largest)
  for (int cell = 0; cell < s.cells; ++cell) {
    largest = std::max(largest, renewal_rate(problem, state, boundary, voidage, cell));
  }
  return largest * window;
}

double stiffness_number(const FluidProblem& problem, const SolidsInput& solids, double window) {
  const Stencil& s = problem.stencil;
  if (s.few_faces.empty()) return 0;
  double largest = 0;
#pragma omp parallel for schedule(static) num_threads(s.threads) reduction(max : largest)
  for (int cell = 0; cell < s.cells; ++cell) {
    if (s.few_faces[cell] == 0) continue;
    double viscous = 0;
    for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side)
      viscous += problem.fluid.viscosity * s.conductance[s.side_face[side]];
    const double held = problem.fluid.density * s.volume[cell];
    largest =
        std::max(largest, (solids.drag_coefficient[cell] / solids.voidage[cell] + viscous) / held);
  }
  return largest * window;
}

int count_inner_steps(double courant, double limit, const Window& window) {
  const double count = std::ceil(courant / limit);
  if (count > most_inner_steps || !std::isfinite(count)) {
    throw NumericsError(
        "fluid, step {}: the Courant number of the window is {:.3g}; with "
        "fluid.numerics.courant_limit {:.3g} it would need more than {} inner steps; a "
        "coupling.window of {:.2g} s would need one",
        window.step, courant, limit, most_inner_steps, window.length * limit / courant);
  }
  return std::max(1, static_cast<int>(count));
}

void check_courant(const FluidProblem& problem, const FluidState& state,
                   const BoundaryValues& boundary, const Window& window) {
  const double limit = problem.numerics.courant_limit;
  const double courant = courant_number(problem, state, boundary, state.voidage, window.length);
  if (courant <= most_inner_steps * limit) return;
  const auto rate = [&](int cell) {
    return renewal_rate(problem, state, boundary, state.voidage, cell);
  };
  int fastest = 0;
  for (int cell = 1; cell < problem.stencil.cells; ++cell) {
    if (rate(cell) > rate(fastest)) fastest = cell;
  }
  const Vector3& at = problem.stencil.centre[fastest];
  throw NumericsError(
      "fluid, step {}: velocity is {:.3g} m/s in cell {} at ({:.6g}, {:.6g}, {:.6g}), a Courant "
      "number of {:.3g} over the window; with fluid.numerics.courant_limit {:.3g} the next window "
      "could start from {:.3g} at most, in {} inner steps: the window diverged; shorten "
      "coupling.window, or look at the drag and the shape of this cell",
      window.step, state.velocity[fastest].norm(), fastest, at.x(), at.y(), at.z(), courant, limit,
      most_inner_steps * limit, most_inner_steps);
}

TimeCoefficients choose_time_scheme(const FluidProblem& problem, const FluidState& old_state,
                                    std::span<const double> voidage, double step) {
  const bool has_two_levels = problem.numerics.time == TimeScheme::bdf2 && old_state.step > 0;
  if (!has_two_levels || has_fast_front(problem.stencil, old_state.voidage, voidage)) {
    return euler(step);
  }
  const TimeCoefficients time = backward_two_steps(step, old_state.step);
  for (std::size_t cell = 0; cell < voidage.size(); ++cell) {
    const double inertia =
        time.last * old_state.voidage[cell] - time.before * old_state.before.voidage[cell];
    if (inertia < 0.1 * old_state.voidage[cell]) return euler(step);
  }
  return time;
}

Window inner_window(const Window& window, int number, int count) {
  if (count == 1) return window;
  const double length = window.length / count;
  return {window.step, window.start + (number - 1) * length, length};
}

void interpolate_voidage(std::span<const double> start, std::span<const double> end, int number,
                         int count, std::span<double> voidage) {
  const double share = static_cast<double>(number) / count;
  for (std::size_t cell = 0; cell < end.size(); ++cell) {
    voidage[cell] = number == count ? end[cell] : (1 - share) * start[cell] + share * end[cell];
  }
}

void keep_level(const FluidState& old_state, const TimeCoefficients& time, FluidState& state) {
  LevelBefore& before = state.before;
  before.voidage = old_state.voidage;
  before.face_flux = old_state.face_flux;
  before.velocity = old_state.velocity;
  before.passed = state.face_flux;
  if (!time.two_steps()) return;
  const double r = time.ratio;
  for (std::size_t f = 0; f < state.face_flux.size(); ++f) {
    before.passed[f] =
        ((1 + r) * state.face_flux[f] + r * old_state.before.passed[f]) / (1 + 2 * r);
  }
}

void add_to_means(const FluidState& state, int number, int count, WindowMeans& means) {
  if (number == 1) {
    means.face_flux.assign(state.face_flux.size(), 0.0);
    means.velocity.assign(state.velocity.size(), Vector3::Zero());
    means.pressure_gradient.assign(state.velocity.size(), Vector3::Zero());
  }
  const std::vector<double>& passed =
      state.before.passed.empty() ? state.face_flux : state.before.passed;
  for (std::size_t f = 0; f < passed.size(); ++f) means.face_flux[f] += passed[f] / count;
  for (std::size_t cell = 0; cell < state.velocity.size(); ++cell) {
    means.velocity[cell] += state.velocity[cell] / count;
    means.pressure_gradient[cell] += state.pressure_gradient[cell] / count;
  }
}

}  // namespace fluxpact
