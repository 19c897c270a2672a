// The particles as the native engine holds them: rows in cell order, sized for the cache lines that
// a contact touches.
#pragma once

#include <cstdint>
#include <vector>

#include "proto/base/vector.hpp"

namespace fluxpact {

/// What a contact reads of each partner, in one cache line. Between sub-steps of a window the
/// velocity is half a step behind the position.
struct alignas(64) Body {
  double position[3];   ///< [m]
  double radius;        ///< [m]
  double velocity[3];   ///< [m/s]
  double inverse_mass;  ///< [1/kg]
};

struct alignas(32) Spin {
  double rate[3];          ///< [rad/s]
  double inverse_inertia;  ///< [1/(kg m²)]
};

/// Sum over the contacts of a particle. The lever arm is the same for all of them, its radius, so
/// the torque is the radius times `lever_force`.
struct alignas(64) Load {
  double force[3];        ///< [N]
  double lever_force[3];  ///< [N] Σ (arm direction) × (tangential force)
};

/// All that a window changes for each particle. Rows of all arrays are in the same (cell) order.
struct Spheres {
  std::vector<Body> body;
  std::vector<Spin> spin;
  std::vector<Load> load;          ///< of the newest positions, complete at the ends of a window
  std::vector<Vector3> listed_at;  ///< [m] position when the contact list was made
  std::vector<int> row;            ///< row of the presented state, which is ascending by id

  int size() const { return static_cast<int>(body.size()); }
};

/// Equal ranges of particles: the unit of work. They depend on the number of particles only, and
/// each sum runs in the order of the blocks, so that any number of threads gives the same bits.
struct Blocks {
  int particles = 0;
  int block_size = 1;

  int count() const { return (particles + block_size - 1) / block_size; }
  int first(int block) const { return block * block_size; }
  int last(int block) const {
    return first(block) + block_size < particles ? first(block) + block_size : particles;
  }
  int holding(int particle) const { return particle / block_size; }
};

}  // namespace fluxpact
