// What contacts remember from one sub-step to the next.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dem_server/backends/native/huge_vector.hpp"

namespace fluxpact {

/// Four numbers: a vector seen from the holder of the contact, and one that looks the same from
/// both sides.
template <class Real>
struct alignas(4 * sizeof(Real)) SpringRow {
  Real number[4];
};

/// Springs of the contacts of one list, `spring_rows` of the contact law each. Only those of
/// contacts that touch are read or written.
template <class Real>
struct Springs {
  HugeVector<SpringRow<Real>> rows;
  std::vector<std::uint8_t> held;  ///< one bit a contact: it has touched, its rows may not be zero
  int rows_each = 0;
  int contacts = 0;

  /// All zero, for so many contacts with so many rows each.
  void reset(int count, int each) {
    contacts = count;
    rows_each = each;
    const auto numbers = static_cast<std::size_t>(count) * static_cast<std::size_t>(each);
    const auto bytes = each > 0 ? static_cast<std::size_t>(count) / 8 + 1 : 0;
    make_room(numbers, bytes);
    rows.assign(numbers, {});
    held.assign(bytes, 0);
  }
  /// A copy, for later.
  void keep(const Springs& other) {
    make_room(other.rows.size(), other.held.size());
    *this = other;
  }
  /// Numbers of contacts go up and down: a little more than needed saves many a step upwards.
  void make_room(std::size_t numbers, std::size_t bytes) {
    if (numbers > rows.capacity()) rows.reserve(numbers + numbers / 8 + 64);
    if (bytes > held.capacity()) held.reserve(bytes + bytes / 8 + 64);
  }
  void hold(int contact) {
    held[contact / 8] = static_cast<std::uint8_t>(held[contact / 8] | 1U << (contact % 8));
  }
  /// The rows of a stored state, number by number. All may be held.
  void restore(int count, int each, std::span<const double> numbers) {
    reset(count, each);
    for (std::size_t n = 0; n < numbers.size(); ++n) {
      rows[n / 4].number[n % 4] = static_cast<Real>(numbers[n]);
    }
    for (int contact = 0; each > 0 && contact < count; ++contact) hold(contact);
  }
  SpringRow<Real>* of(std::int64_t contact) { return rows.data() + contact * rows_each; }
  const SpringRow<Real>* of(std::int64_t contact) const {
    return rows.data() + contact * rows_each;
  }
  /// What the contact `from` of other springs remembers; `mirrored`: its partner held it there.
  void carry(const Springs& other, int from, bool mirrored, int contact) {
    const Real sign = mirrored ? -1 : 1;
    for (int r = 0; r < rows_each; ++r) {
      const SpringRow<Real>& old = other.of(from)[r];
      of(contact)[r] = {
          {sign * old.number[0], sign * old.number[1], sign * old.number[2], old.number[3]}};
    }
    hold(contact);
  }
};

}  // namespace fluxpact
