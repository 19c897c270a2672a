// How a window is cut into inner steps, and what their results amount to over the window.
//
// A window in which fluid crosses many cells is solved in equal parts with the voidage linear in
// time between its two ends. Every part closes mass exactly, so their mean flux does over the
// window.
#pragma once

#include <span>

#include "cfd_server/vans/solver.hpp"
#include "cfd_server/vans/time_scheme.hpp"
#include "cfd_server/vans/window_solver.hpp"

namespace fluxpact {

/// Largest Courant number of a window: what flows out of (or into) a cell over the fluid in it,
/// with the fluxes of `state` inside and those of `boundary` at the boundary.
double courant_number(const FluidProblem& problem, const FluidState& state,
                      const BoundaryValues& boundary, std::span<const double> voidage,
                      double window);

/// Largest ratio of drag and viscous stress to inertia, B Δt/(ρ ε V) + Σ μ g Δt/(ρ V), in cells
/// with few faces; 0 on other meshes. Those cells take parts of both from the corrector before,
/// which has been stable up to some 1000.
double stiffness_number(const FluidProblem& problem, const SolidsInput& solids, double window);

/// The number of inner steps for this Courant number. Throws NumericsError if more than 1000 would
/// be needed, with the window that would need one.
int count_inner_steps(double courant, double limit, const Window& window);

/// Throws NumericsError naming cell, place, value and limit if the next window, as long as this
/// one, would need more than 1000 inner steps from `state`: what diverged must not be committed.
void check_courant(const FluidProblem& problem, const FluidState& state,
                   const BoundaryValues& boundary, const Window& window);

/// Euler, or with `time: bdf2` the second-order coefficients where they can be used: not in the
/// first step, not where a front of the voidage crosses half a cell or more (the extrapolation from
/// two old levels would be of another place), and not where they would leave a cell without
/// inertia.
TimeCoefficients choose_time_scheme(const FluidProblem& problem, const FluidState& old_state,
                                    std::span<const double> voidage, double step);

/// The part of the window that ends inner step `number` (from 1) of `count`.
Window inner_window(const Window& window, int number, int count);

/// Voidage at the end of inner step `number` of `count`: linear in time, exactly `end` at the last.
void interpolate_voidage(std::span<const double> start, std::span<const double> end, int number,
                         int count, std::span<double> voidage);

/// Keep the level `old_state` in the new state, and F = [(1 + r) Φ + r F_old]/(1 + 2r): mass that
/// passed in the step over its length, which balances the step's change of storage exactly.
void keep_level(const FluidState& old_state, const TimeCoefficients& time, FluidState& state);

/// Add an inner step to the means of the window; `number` from 1 of `count`.
void add_to_means(const FluidState& state, int number, int count, WindowMeans& means);

}  // namespace fluxpact
