// What every particle engine offers to the code between the phases: state by id, and one way
// forward.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "proto/base/vector.hpp"
#include "proto/participant/participant.hpp"

namespace fluxpact {

/// Spheres, one row each, ascending by id.
struct ParticleState {
  std::vector<std::int64_t> id;
  std::vector<Vector3> position;  ///< [m]
  std::vector<Vector3> velocity;  ///< [m/s]
  std::vector<Vector3> spin;      ///< [rad/s]
  std::vector<double> radius;     ///< [m]
  std::vector<double> density;    ///< [kg/m³]
  std::vector<int> material;      ///< index into the engine's materials
  std::vector<std::uint8_t>
      fixed{};  ///< 1: nothing moves it, as if infinitely heavy; empty: none is

  int size() const { return static_cast<int>(id.size()); }
  bool is_fixed(int row) const { return !fixed.empty() && fixed[row] != 0; }
};

/// What an engine tells of its own work.
struct EngineCounters {
  std::int64_t sub_steps = 0;   ///< since it was made
  std::int64_t rebuilds = 0;    ///< of the list of neighbours, since it was made
  std::int64_t list_pairs = 0;  ///< in the list now
  std::int64_t collisions = 0;  ///< of an event-driven engine, since it was made
  std::int64_t events = 0;      ///< likewise, whatever they are
};

class EngineState;

class ParticleEngine {
 public:
  virtual ~ParticleEngine() = default;

  /// The newest state: the candidate after `advance`, else the committed one.
  virtual const ParticleState& particles() const = 0;

  /// False if forces move none of the particles (a frozen bed): all then count as infinitely heavy,
  /// as else those that are `fixed`.
  virtual bool mobile() const = 0;

  /// Advance by `window` [s] in `sub_steps` equal steps under gravity, contact, and a force [N] on
  /// each particle (row by row of `particles()`) that stays constant over the window.
  virtual void advance(double window, int sub_steps, std::span<const Vector3> force,
                       const Progress& progress) = 0;
  virtual EngineCounters counters() const { return {}; }

  // Several processes may share the particles: then `particles()` are those of this one, all
  // functions are called in each of them alike, and these two tell of the whole.

  /// The newest state of all particles; need not be asked for in all processes.
  virtual const ParticleState& all_particles() const { return particles(); }
  /// Adds up the values of all processes, in place, in each of them.
  virtual void add_up(std::span<double> /*values*/) const {}

  /// After `advance`, before `commit`: take the rows `leaving` (ascending, of the candidate state)
  /// out and add the spheres `entering`, whose ids ascend and are larger than any before. Rows that
  /// stay keep their order. Undone by `rollback` with the rest of the window. Throws ConfigError
  /// for spheres that are not sound (checked_rows), or too light for the time step.
  virtual void exchange(std::span<const int> leaving, const ParticleState& entering) = 0;
  virtual void commit() = 0;
  virtual void rollback() = 0;

  /// Adds the whole committed state to `state`: what `restore` needs to go on with the same bits.
  /// Throws ProtocolError while a candidate is neither committed nor rolled back.
  virtual void store(EngineState& state) const = 0;
  /// Take a stored state in place of the own one, in an engine made for the same scene, whatever
  /// particles it was made with. Throws ConfigError that says what does not fit: another engine,
  /// precision or scene, other particles where none come or go, an array that is missing, of
  /// another size, or damaged; the own state is unharmed then.
  virtual void restore(const Fields& state) = 0;
};

}  // namespace fluxpact
