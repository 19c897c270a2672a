// The checks and the order that every engine wants of the particles it is given, and the exchange
// of rows when some leave and others enter.
#pragma once

#include <span>
#include <vector>

#include "dem_server/backends/particle_engine.hpp"

namespace fluxpact {

/// The same particles, ascending by id. Throws ConfigError that names the particle if an id stands
/// twice, a radius or density is not positive, a material is not among `materials`, a number is
/// not finite, or a fixed one has a speed; and if the arrays differ in length.
ParticleState checked_rows(ParticleState particles, int materials);

/// Takes the rows `leaving` out of `particles`, in place, and appends `entering`. Throws
/// ConfigError if an id that enters is not larger than all others: rows ascend by id.
void exchange_rows(std::span<const int> leaving, const ParticleState& entering,
                   ParticleState& particles);

/// `values` without the rows `leaving` (ascending), in place.
template <class T>
void remove_rows(std::span<const int> leaving, std::vector<T>& values) {
  if (leaving.empty()) return;
  std::size_t next = 0;
  auto kept = static_cast<std::size_t>(leaving.front());
  for (std::size_t row = kept; row < values.size(); ++row) {
    if (next < leaving.size() && static_cast<std::size_t>(leaving[next]) == row) {
      ++next;
    } else {
      values[kept++] = values[row];
    }
  }
  values.resize(kept);
}

}  // namespace fluxpact
