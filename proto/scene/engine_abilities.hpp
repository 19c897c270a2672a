// What each engine of the particles can do: one row an engine. What a scene asks for beyond that is
// refused before anything starts (check_backend.cpp).
#pragma once

#include "proto/scene/scene.hpp"

namespace fluxpact {

struct EngineAbilities {
  bool hertz = false;            ///< contact.law: hertz
  bool rolling = false;          ///< contact.rolling
  bool cohesion = false;         ///< contact.cohesion
  bool lubrication = false;      ///< interphase.forces: lubrication
  bool mixed_precision = false;  ///< numerics.precision: mixed
  bool surfaces = false;         ///< walls beside those of the mesh, at rest or moving, of any kind
  bool any_mesh = false;         ///< walls of meshes that are no boxes
  bool any_size = false;         ///< particles of different diameters
  bool fixed = false;            ///< particles that nothing moves
  bool flow = false;             ///< particles that come in or leave
  bool ranks = false;            ///< several MPI processes
};

/// A custom engine says itself, when it is configured, what it cannot do: all are true.
EngineAbilities abilities_of(ParticleBackend backend);

}  // namespace fluxpact
