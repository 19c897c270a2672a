// What contacts remember from one sub-step to the next.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "dem_server/backends/native/contact_law.hpp"
#include "dem_server/backends/native/huge_vector.hpp"

namespace fluxpact {

/// Four numbers: a vector seen from the holder of the contact, and one that looks the same from
/// both sides.
template <class Real>
struct alignas(4 * sizeof(Real)) SpringRow {
  Real number[4];
};

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
inline std::size_t with_room(std::size_t needed) { return needed + needed / 32 + 64; }

/// To another size, growing by little; what was there may be lost.
template <class Values>
void resize_with_room(std::size_t size, Values& values) {
  if (size > values.capacity()) {
    Values().swap(values);  // first away with the old one: both at once would be the peak
    values.reserve(with_room(size));
  }
  values.resize(size);
}
template <class Values>
void assign_with_room(const Values& from, Values& values) {
  resize_with_room(from.size(), values);
  std::copy(from.begin(), from.end(), values.begin());
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

/// Springs of the pairs of one list, of those only that have some: to be kept for later, or carried
/// to a new list.
template <class Real>
class PairSprings {
 public:
  /// None has springs yet; room for as many as are `expected`.
  void reset(int pairs, const SpringNumbers& each, int expected) {
    pairs_ = pairs;
    each_ = each;
    numbers_.clear();
    held_.clear();
    if (each.count == 0) return;
    const std::size_t words = static_cast<std::size_t>(pairs) / 64 + 1;
    if (words > held_.capacity()) held_.reserve(with_room(words));
    held_.assign(words, 0);
    const auto numbers = static_cast<std::size_t>(expected) * each_count();
    if (numbers <= numbers_.capacity()) return;
    HugeVector<Real>().swap(numbers_);  // first away with the old one
    numbers_.reserve(with_room(numbers));
  }
  /// Springs of a pair behind those that have some, its numbers `stride` apart; `mirrored`: its
  /// partner held them.
  void append(int pair, const Real* numbers, int stride, bool mirrored) {
    for (int n = 0; n < each_.count; ++n) {
      const Real number = numbers[std::ptrdiff_t{n} * stride];
      numbers_.push_back(mirrored && !each_.is_even(n) ? -number : number);
    }
    held_[pair / 64] |= std::uint64_t{1} << (pair % 64);
  }
  /// Call before `find`.
  void number() {
    ranks_.clear();
    int rank = 0;
    for (const std::uint64_t bits : held_) {
      ranks_.push_back(rank);
      rank += std::popcount(bits);
    }
  }
  /// The numbers of a pair; nullptr if it has none.
  const Real* find(int pair) const {
    if (held_.empty()) return nullptr;
    const std::uint64_t bits = held_[pair / 64];
    const std::uint64_t bit = std::uint64_t{1} << (pair % 64);
    if ((bits & bit) == 0) return nullptr;
    const int rank = ranks_[pair / 64] + std::popcount(bits & (bit - 1));
    return numbers_.data() + static_cast<std::size_t>(rank) * each_count();
  }
  const SpringNumbers& each() const { return each_; }
  /// Calls visit(pair, numbers) for all pairs that have springs, in order.
  template <class Visit>
  void visit(const Visit& visit) const {
    const Real* next = numbers_.data();
    for (std::size_t word = 0; word < held_.size(); ++word) {
      for (std::uint64_t rest = held_[word]; rest != 0; rest &= rest - 1) {
        visit(static_cast<int>(64 * word) + std::countr_zero(rest), next);
        next += each_.count;
      }
    }
  }

  // ---- in a stored state: the whole rows of all pairs, zeros where there are none ----

  void store(int rows_each, std::vector<double>& numbers) const {
    const Real* next = numbers_.data();
    for (int pair = 0; rows_each > 0 && pair < pairs_; ++pair) {
      const std::size_t first = numbers.size();
      numbers.resize(first + 4 * static_cast<std::size_t>(rows_each), 0);
      if ((held_[pair / 64] >> (pair % 64) & 1) == 0) continue;
      for (int n = 0; n < each_.count; ++n) {
        numbers[first + each_.place[n]] = static_cast<double>(*next++);
      }
    }
  }
  void restore(int pairs, const SpringNumbers& each, int rows_each,
               std::span<const double> numbers) {
    const std::size_t row = 4 * static_cast<std::size_t>(rows_each);
    const auto of = [&](int pair) { return numbers.subspan(pair * row, row); };
    const auto has_some = [](std::span<const double> own) {
      return std::ranges::any_of(own, [](double number) { return number != 0; });
    };
    int count = 0;
    for (int pair = 0; pair < pairs; ++pair) count += has_some(of(pair)) ? 1 : 0;
    reset(pairs, each, count);
    std::array<Real, 7> packed{};
    for (int pair = 0; pair < pairs; ++pair) {
      if (!has_some(of(pair))) continue;
      for (int n = 0; n < each.count; ++n) {
        packed[n] = static_cast<Real>(of(pair)[each.place[n]]);
      }
      append(pair, packed.data(), 1, false);
    }
  }

 private:
  std::size_t each_count() const { return static_cast<std::size_t>(each_.count); }

  HugeVector<Real> numbers_;
  std::vector<std::uint64_t> held_;  // bits by pair
  std::vector<int> ranks_;           // of the first pair of each 64 bits
  SpringNumbers each_;
  int pairs_ = 0;
};

}  // namespace fluxpact
