// The committed state of a particle engine as named arrays, so that it can be kept in a file or
// sent, and taken back by another engine of the same scene, which then goes on with the same bits.
//
// All numbers are doubles, which hold what the engines hold (floats, and whole numbers below 2^53)
// exactly.
#pragma once

#include <deque>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dem_server/backends/particle_engine.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {

/// The arrays, whose owner it is.
class EngineState {
 public:
  EngineState() = default;
  EngineState(const EngineState&) = delete;  // `fields` has views of what we hold
  EngineState& operator=(const EngineState&) = delete;

  /// An empty array of scalars or vectors, to be filled before `fields` is asked for.
  std::vector<double>& add_scalars(std::string name);
  std::vector<Vector3>& add_vectors(std::string name);
  void add_number(std::string name, double value) { numbers_[std::move(name)] = value; }

  /// As it goes into a message or a file; valid until this changes.
  Fields fields() const;

 private:
  template <class T>
  struct Named {
    std::string name;
    std::vector<T> values;
  };
  std::deque<Named<double>> scalars_;
  std::deque<Named<Vector3>> vectors_;
  std::map<std::string, double> numbers_;
};

/// Reads what `EngineState` wrote. Every function throws ConfigError that names what is missing,
/// has another size, or is not what it can be.
class StateReader {
 public:
  /// `kind`: the number that tells whose state this is, and in which form.
  StateReader(const Fields& fields, const std::string& kind, int version);

  double number(std::string_view name) const;
  /// A whole number in [0, end).
  int count(std::string_view name, double end) const;
  /// Throws if a number is not what the engine has: `what` says what it counts.
  void require(std::string_view name, double own, std::string_view what) const;

  std::span<const double> scalars(std::string_view name, std::size_t rows) const;
  std::span<const Vector3> vectors(std::string_view name, std::size_t rows) const;
  /// Whole numbers in [0, end).
  template <class Whole>
  std::vector<Whole> wholes(std::string_view name, std::size_t rows, double end) const {
    std::vector<Whole> result(rows);
    const auto values = scalars(name, rows);
    for (std::size_t row = 0; row < rows; ++row) {
      result[row] = static_cast<Whole>(whole(name, row, values[row], end));
    }
    return result;
  }
  /// The value, if it is whole and in [0, end).
  static double whole(std::string_view name, std::size_t row, double value, double end);

 private:
  const FieldView& find(std::string_view name, int components, std::size_t rows) const;
  const Fields& fields_;
};

/// What never changes of each particle: id, radius, density, material, and if it is fixed.
void store_rows(const ParticleState& particles, EngineState& state);

/// The same, with positions, velocities and spins zero. With `flow` (particles come and go) they
/// may be others than `own`. Throws ConfigError for rows that are not sound (checked_rows), not in
/// order, or of other particles.
ParticleState restored_rows(const StateReader& state, int materials, const ParticleState& own,
                            bool flow);

}  // namespace fluxpact
