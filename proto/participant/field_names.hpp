// The fields that cross between the processes: names, shapes, units, and who gives them.
#pragma once

#include <string>

namespace fluxpact::field {

// From the particle side, one row a cell.
inline constexpr auto voidage = "voidage";  ///< ε^{n+1} [-]
inline constexpr auto drag_coefficient =
    "drag_coefficient";  ///< B = Σ w k [kg/s]: force on the fluid is S − B u
inline constexpr auto drag_source = "drag_source";      ///< S = Σ w (k q − E) [N], vector
inline constexpr auto impulse_given = "impulse_given";  ///< Σ w I: impulse that the fluid gave the
                                                        ///< particles in this window [N s], vector
inline constexpr auto particle_velocity =
    "particle_velocity";  ///< volume-weighted mean velocity of the particles [m/s], vector

// From the particle side, numbers.
inline constexpr auto particle_volume = "particle_volume";  ///< Σ V_p inside the domain [m³]
inline constexpr auto particle_count = "particle_count";
inline constexpr auto particle_mass = "particle_mass";  ///< [kg]
inline constexpr auto excess_moved =
    "excess_moved";  ///< solids that over-full cells have passed to others [m³]
/// Particles beyond the range of the drag law; may be missing.
inline constexpr auto particles_beyond_drag = "particles_beyond_drag";

// From the particle side if particles can come in or leave (particles_flow): of the window; none at
// time 0. Those that leave or come in do so at its end.
inline constexpr auto particles_entered = "particles_entered";
inline constexpr auto particles_left = "particles_left";
inline constexpr auto particles_waiting =
    "particles_waiting";  ///< that were due so far and found no room
inline constexpr auto particle_mass_entered = "particle_mass_entered";  ///< [kg]
inline constexpr auto particle_mass_left = "particle_mass_left";        ///< [kg]
inline constexpr auto particle_momentum_entered =
    "particle_momentum_entered";  ///< Σ m v [N s], vector, one row
inline constexpr auto particle_momentum_left =
    "particle_momentum_left";  ///< Σ m v [N s], vector, one row

// From the particle side about a run in mixed precision, after its last window: differences to
// double precision after one more window, root mean square and largest.
inline constexpr auto precision_velocity_rms =
    "precision_velocity_rms";  ///< of the velocities over the rms of their gains in the window [-]
inline constexpr auto precision_velocity_max = "precision_velocity_max";
inline constexpr auto precision_overlap_rms =
    "precision_overlap_rms";  ///< of the overlaps of spheres over their mean [-]
inline constexpr auto precision_overlap_max = "precision_overlap_max";
inline constexpr auto precision_position_rms =
    "precision_position_rms";  ///< of the positions over the radius [-]
inline constexpr auto precision_position_max = "precision_position_max";

// From the fluid side. One row a face, or a cell.
inline constexpr auto face_flux =
    "face_flux";  ///< Φ: superficial mass flux of the window [kg/s], out of the owner
inline constexpr auto velocity =
    "velocity";  ///< u on which drag acted: at the window's end, or its mean over inner steps;
                 ///< interstitial [m/s], vector
inline constexpr auto pressure = "pressure";                    ///< p_d = p − ρ g·x [Pa]
inline constexpr auto pressure_gradient = "pressure_gradient";  ///< ∇p_d [Pa/m], vector
inline constexpr auto impulse_taken =
    "impulse_taken";  ///< Δt (S − B u^{n+1} − A ∇p_d): impulse that drag and the other forces of
                      ///< the particles gave the fluid [N s], vector

// From the fluid side, only if the scene's forces ask for it (asked_of_fluid). One row a cell.
inline constexpr auto viscous_force =
    "viscous_force";  ///< ∇·[ε μ (∇u + ∇uᵀ − 2/3 ∇·u)] [N/m³], molecular viscosity; vector
inline constexpr auto convective_acceleration =
    "convective_acceleration";                                ///< (u·∇)u [m/s²], vector
inline constexpr auto vorticity = "vorticity";                ///< ∇×u [1/s], vector
inline constexpr auto turbulent_energy = "turbulent_energy";  ///< k [m²/s²]
inline constexpr auto turbulent_dissipation = "turbulent_dissipation";  ///< [m²/s³]

// From the particle side, only if the scene's forces ask for it (asked_of_particles). One row a
// cell.
inline constexpr auto pressure_return =
    "pressure_return";  ///< A [m³]: force on the fluid is S − B u − A ∇p_d. What the pressure
                        ///< gradient adds to the particles' velocity within the window, and so
                        ///< to their drag

// From the fluid side, numbers.
inline constexpr auto solver_iterations = "solver_iterations";
inline constexpr auto closure_correction =
    "closure_correction";  ///< largest flux change by the closure over the largest flux [-]

// From the fluid side, for each scalar of the scene (fluid.scalars).
/// c^{n+1}, one row a cell: [-], or [K] of a temperature.
inline std::string scalar(const std::string& name) { return "scalar:" + name; }
/// What left through each boundary face in the window over its length [kg/s], [W] of a temperature.
inline std::string scalar_flux(const std::string& name) { return "scalar_flux:" + name; }
/// A number: what sources of the fluid added in the window over its length [kg/s], [W].
inline std::string scalar_source(const std::string& name) { return "scalar_source:" + name; }

// From both.
inline constexpr auto wall_seconds = "wall_seconds";  ///< time spent in advance [s]

}  // namespace fluxpact::field
