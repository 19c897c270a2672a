#include "proto/scene/engine_abilities.hpp"

namespace fluxpact {

EngineAbilities abilities_of(ParticleBackend backend) {
  switch (backend) {
    case ParticleBackend::native:
      return {.hertz = true,
              .rolling = true,
              .cohesion = true,
              .lubrication = true,
              .mixed_precision = true,
              .surfaces = true,
              .any_mesh = true,
              .any_size = true,
              .spread_sizes = true,
              .fixed = true,
              .flow = true};
    case ParticleBackend::kinematic:
      // No contact is followed at all: their laws are of no account.
      return {.hertz = true,
              .rolling = true,
              .cohesion = true,
              .any_size = true,
              .spread_sizes = true,
              .fixed = true,
              .flow = true};
    case ParticleBackend::hard_sphere:
      return {.any_size = true, .spread_sizes = true, .fixed = true, .flow = true};
    case ParticleBackend::lammps:
      return {.hertz = true,
              .any_size = true,
              .spread_sizes = true,
              .fixed = true,
              .flow = true,
              .ranks = true};
    case ParticleBackend::liggghts:
      return {.any_size = true, .fixed = true, .flow = true, .ranks = true};
    case ParticleBackend::yade:
      return {.any_size = true, .fixed = true, .flow = true};
    case ParticleBackend::custom:
      return {.hertz = true,
              .rolling = true,
              .cohesion = true,
              .lubrication = true,
              .mixed_precision = true,
              .surfaces = true,
              .any_mesh = true,
              .any_size = true,
              .spread_sizes = true,
              .fixed = true,
              .flow = true};
  }
  return {};
}

}  // namespace fluxpact
