// YADE (Šmilauer et al., Yade Documentation, 2021, doi 10.5281/zenodo.5705394) as an engine: a
// process of its own, driven by adapter.py.
#pragma once

#include <memory>

#include "dem_server/backends/particle_engine.hpp"
#include "proto/mesh/mesh.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// Contact law: Law2_ScGeom_ViscElPhys_Basic with the stiffness, dashpots and friction of the
/// linear law; a contact never pulls, and dashpots act while the contact sticks. Walls: the sides
/// of the domain. Motion: YADE's leapfrog. The velocities that it is given and gives differ by half
/// a kick of gravity and of the window's force from those presented, so that a free particle flies
/// exactly and gains exactly F Δt / m; contact forces see, and change, the velocity half a sub-step
/// late, as in the native engine.
///
/// One thread. The same bits after `rollback`; `store` has YADE build its lists anew from what is
/// stored, as `restore` does, so that both go on with the same bits (which differ by round-off
/// from those of a run that stores nothing).
///
/// Throws ConfigError for particles that are not sound (checked_rows), of which none is free, or
/// whose free ones are not all alike, for periodic sides, a sub-step too long for the contacts
/// (step_limit.hpp); SystemError or ProtocolError if YADE does not start. Its `advance` throws
/// NumericsError for a particle that got lost, is not finite or moves by more than its radius in a
/// sub-step, as it is at the end of the window; every call may throw the ProtocolError of a YADE
/// that ended or is silent.
std::unique_ptr<ParticleEngine> make_yade_engine(const Scene& scene, const Mesh& mesh,
                                                 ParticleState initial);

}  // namespace fluxpact
