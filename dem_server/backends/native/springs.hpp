// What contacts remember from one sub-step to the next.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
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

/// The same seen from the partner.
template <class Real>
SpringRow<Real> mirrored_row(const SpringRow<Real>& row) {
  return {{-row.number[0], -row.number[1], -row.number[2], row.number[3]}};
}

/// Rows of a stored state, number by number.
template <class Real>
void store_rows_of(const SpringRow<Real>* rows, int count, std::vector<double>& numbers) {
  for (int r = 0; r < count; ++r) {
    for (const Real number : rows[r].number) numbers.push_back(static_cast<double>(number));
  }
}
template <class Real>
void restore_rows_of(std::span<const double> numbers, SpringRow<Real>* rows) {
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    rows[n / 4].number[n % 4] = static_cast<Real>(numbers[n]);
  }
}

/// Numbers of contacts go up and down: a little more than needed saves many a step upwards.
inline std::size_t with_room(std::size_t needed) { return needed + needed / 16 + 64; }

/// A copy that grows by little.
template <class Values, class From>
void assign_with_room(const From& from, Values& values) {
  if (from.size() > values.capacity()) {
    Values().swap(values);  // first away with the old one: both at once would be the peak
    values.reserve(with_room(from.size()));
  }
  values.assign(from.begin(), from.end());
}

/// Springs of contacts with walls, which are few: `spring_rows` of the contact law for each that is
/// listed.
template <class Real>
struct Springs {
  HugeVector<SpringRow<Real>> rows;
  int rows_each = 0;
  int contacts = 0;

  /// All zero, for so many contacts with so many rows each.
  void reset(int count, int each) {
    contacts = count;
    rows_each = each;
    const auto numbers = static_cast<std::size_t>(count) * static_cast<std::size_t>(each);
    if (numbers > rows.capacity()) rows.reserve(with_room(numbers));
    rows.assign(numbers, {});
  }
  /// A copy, for later.
  void keep(const Springs& other) {
    contacts = other.contacts;
    rows_each = other.rows_each;
    assign_with_room(other.rows, rows);
  }
  void store(std::vector<double>& numbers) const {
    store_rows_of(rows.data(), static_cast<int>(rows.size()), numbers);
  }
  void restore(int count, int each, std::span<const double> numbers) {
    reset(count, each);
    restore_rows_of(numbers, rows.data());
  }
  SpringRow<Real>* of(std::int64_t contact) { return rows.data() + contact * rows_each; }
  const SpringRow<Real>* of(std::int64_t contact) const {
    return rows.data() + contact * rows_each;
  }
  /// What the contact `from` of other springs remembers.
  void carry(const Springs& other, int from, int contact) {
    std::copy_n(other.of(from), rows_each, of(contact));
  }
};

/// Springs of the pairs of one list, of those that touch only: in the order of the pairs, in a
/// ring. A sub-step goes through the pairs in order; it takes the springs of the sub-step before
/// from the front and puts its own behind the last, so that the ring needs hardly more room than
/// there are.
template <class Real>
class PairSprings {
 public:
  int rows_each() const { return rows_each_; }

  // ---- a sub-step ----

  /// Bits of those that have springs, by pair.
  std::uint8_t& held(int pair) { return held_[pair / 8]; }
  /// Springs n = 0, 1 ... of the sub-step before.
  const SpringRow<Real>* before(int n) const { return slot(first_ + n); }
  /// Those of a pair that touches for the first time.
  const SpringRow<Real>* unstretched() const { return unstretched_; }
  /// Room for `more` springs of this sub-step; of the one before those from `oldest` on stay.
  void make_room(int more, int oldest) {
    if (fresh_ + more + count_ - oldest > slots_) grow(more, oldest);
  }
  /// Where the next `count` of this sub-step go.
  void put(int count, SpringRow<Real>** rows) {
    const int place = wrapped(wrapped(first_ + count_) + fresh_);
    fresh_ += count;
    if (place + count <= slots_) {  // nearly always
      SpringRow<Real>* const first = slot(place);
      for (int n = 0; n < count; ++n) rows[n] = first + std::ptrdiff_t{n} * rows_each_;
      return;
    }
    for (int n = 0; n < count; ++n) rows[n] = slot(place + n);
  }
  /// The springs of this sub-step are now those before.
  void turn() {
    first_ = wrapped(first_ + count_);
    count_ = fresh_;
    fresh_ = 0;
  }

  // ---- a new list ----

  /// None has springs yet; room for as many as are `expected`.
  void reset(int pairs, int rows_each, int expected) {
    pairs_ = pairs;
    rows_each_ = rows_each;
    first_ = count_ = fresh_ = 0;
    if (rows_each == 0) return;
    const std::size_t bytes = (static_cast<std::size_t>(pairs) / 64 + 1) * 8;
    if (bytes > held_.capacity()) held_.reserve(with_room(bytes));
    held_.assign(bytes, 0);
    if (expected > slots_) reserve(expected);
  }
  /// Springs of a pair behind those that have some; `mirrored`: its partner held them.
  void append(int pair, const SpringRow<Real>* rows, bool mirrored) {
    make_room(1, 0);
    SpringRow<Real>* to = nullptr;
    put(1, &to);
    for (int r = 0; r < rows_each_; ++r) to[r] = mirrored ? mirrored_row(rows[r]) : rows[r];
    held_[pair / 8] = static_cast<std::uint8_t>(held_[pair / 8] | 1U << (pair % 8));
  }
  /// Call before `find`.
  void number() {
    ranks_.clear();
    int rank = 0;
    for (std::size_t word = 0; word < held_.size() / 8; ++word) {
      ranks_.push_back(rank);
      rank += std::popcount(bits_of(word));
    }
  }
  /// The springs of a pair; nullptr if it has none.
  const SpringRow<Real>* find(int pair) const {
    const std::uint64_t bits = bits_of(pair / 64);
    const std::uint64_t bit = std::uint64_t{1} << (pair % 64);
    if ((bits & bit) == 0) return nullptr;
    return before(ranks_[pair / 64] + std::popcount(bits & (bit - 1)));
  }

  // ---- copies ----

  /// A copy, for later.
  void keep(const PairSprings& other) {
    reset(other.pairs_, other.rows_each_, other.count_);
    if (rows_each_ == 0) return;
    held_ = other.held_;
    for (int n = 0; n < other.count_; ++n) {
      std::copy_n(other.before(n), rows_each_, ring_.data() + std::ptrdiff_t{n} * rows_each_);
    }
    count_ = other.count_;
  }
  /// Of all pairs; zeros where there are none.
  void store(std::vector<double>& numbers) const {
    int n = 0;
    for (int pair = 0; rows_each_ > 0 && pair < pairs_; ++pair) {
      const bool has = (held_[pair / 8] >> (pair % 8) & 1) != 0;
      store_rows_of(has ? before(n++) : unstretched(), rows_each_, numbers);
    }
  }
  void restore(int pairs, int rows_each, std::span<const double> numbers) {
    const auto is_none = [](double number) { return number == 0 && !std::signbit(number); };
    const std::size_t each = 4 * static_cast<std::size_t>(rows_each);
    for (const bool counting : {true, false}) {
      int count = 0;
      for (int pair = 0; rows_each > 0 && pair < pairs; ++pair) {
        const auto own = numbers.subspan(pair * each, each);
        if (std::ranges::all_of(own, is_none)) continue;
        SpringRow<Real> rows[2];
        restore_rows_of(own, rows);
        if (!counting) append(pair, rows, false);
        ++count;
      }
      if (counting) reset(pairs, rows_each, count);
    }
    turn();
  }

 private:
  std::uint64_t bits_of(std::size_t word) const {
    std::uint64_t bits = 0;
    std::memcpy(&bits, held_.data() + 8 * word, 8);
    return bits;
  }
  int wrapped(int place) const { return place < slots_ ? place : place - slots_; }
  SpringRow<Real>* slot(int place) {
    return ring_.data() + std::ptrdiff_t{wrapped(place)} * rows_each_;
  }
  const SpringRow<Real>* slot(int place) const {
    return ring_.data() + std::ptrdiff_t{wrapped(place)} * rows_each_;
  }
  /// An empty ring.
  void reserve(int springs) {
    slots_ = static_cast<int>(with_room(springs));
    HugeVector<SpringRow<Real>>().swap(ring_);
    ring_.resize(static_cast<std::size_t>(slots_) * static_cast<std::size_t>(rows_each_));
  }
  /// A larger one: the springs of this sub-step in front, those before at the end.
  void grow(int more, int oldest) {
    PairSprings larger;
    larger.rows_each_ = rows_each_;
    larger.reserve(fresh_ + more + count_ - oldest);
    larger.first_ = larger.slots_ - count_;  // below 0 if those before `oldest` take no part
    for (int n = 0; n < fresh_; ++n) {
      std::copy_n(slot(wrapped(first_ + count_) + n), rows_each_, larger.slot(n));
    }
    for (int n = oldest; n < count_; ++n) {
      std::copy_n(before(n), rows_each_, larger.slot(larger.first_ + n));
    }
    first_ = larger.first_;
    slots_ = larger.slots_;
    ring_ = std::move(larger.ring_);
  }

  HugeVector<SpringRow<Real>> ring_;
  std::vector<std::uint8_t> held_;
  std::vector<int> ranks_;  // of the first pair of each 64 bits
  SpringRow<Real> unstretched_[2] = {};
  int rows_each_ = 0;
  int pairs_ = 0;
  int slots_ = 0;
  int first_ = 0;
  int count_ = 0;  // of the sub-step before
  int fresh_ = 0;  // of this one
};

}  // namespace fluxpact
