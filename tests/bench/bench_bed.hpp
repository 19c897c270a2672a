// The beds on which the particle engine is measured: read from a file, or settled here and repeated
// sideways to any size; at rest, or in motion as in a fluidised bed.
#pragma once

#include <string>

#include "dem_server/backends/particle_engine.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// Glass spheres of 2 mm under gravity, in a box [0, upper].
struct BenchBed {
  ParticleState particles;
  Vector3 upper = Vector3::Zero();  ///< [m]
  std::vector<Axis> periodic;       ///< else walls
};

inline constexpr double bench_time_step = 5e-6;      ///< [s]
inline constexpr double bench_diameter = 2e-3;       ///< [m]
inline constexpr double bench_density = 2250;        ///< [kg/m³]
inline constexpr double bench_stiffness = 1000;      ///< [N/m]
inline constexpr double bench_restitution = 0.9;     ///< [-]
inline constexpr double bench_friction = 0.3;        ///< [-]
inline constexpr int bench_steps_per_window = 20;    ///< as between two exchanges with a fluid
inline constexpr int bench_block_particles = 10000;  ///< of the block that is repeated

/// A scene whose native engine runs this bed: k_t = 2/7 k_n, springs and dashpots.
Scene bench_scene(const BenchBed& bed, int threads, Precision precision);

/// A bed between walls from HDF5 (datasets x, y, z, vx, vy, vz, radius) or CSV
/// (x,y,z,vx,vy,vz,diameter) in the box [0, upper]. Throws ConfigError or SystemError.
BenchBed read_bed(const std::string& path, const Vector3& upper);

/// About `count` spheres: a block of 10,000 (or fewer, if so few are wanted), periodic sideways,
/// packed and settled for 0.05 s, repeated in x and y.
BenchBed settled_bed(int count);

/// The bed in motion: heights times 1.02, two rolls of up to 0.45 m/s that rise in the middle and
/// sink at the sides as in a bubbling bed, and Gaussian velocities of 0.02 m/s in each direction.
/// A settled bed then has 0.9 contacts a particle instead of 2.4, and with a skin of 0.3 mm its
/// contact list is remade about once in 50 steps of 5 µs.
void fluidise(BenchBed& bed);

/// A CSV file that `read_bed` reads, every number to its last bit.
void write_bed(const BenchBed& bed, const std::string& path);

/// Pairs of a bed, counted once each; those across periodic sides are left out.
struct PairCount {
  double contacts = 0;  ///< a particle, those with walls left out
  double near = 0;      ///< a particle: surfaces closer than 0.3 mm
};
PairCount count_pairs(const BenchBed& bed, const ParticleState& particles);

}  // namespace fluxpact
