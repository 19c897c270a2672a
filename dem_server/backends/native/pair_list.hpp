// The pairs of a contact list.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dem_server/backends/native/springs.hpp"

namespace fluxpact {

/// A pair of neighbours, held by one of the two.
struct Pair {
  std::int32_t other = 0;   ///< the partner's place; in its block for an inner pair
  std::uint16_t mine = 0;   ///< place of the holder in its block
  std::uint8_t shift = 13;  ///< periods to add to the partner's position (Shift)
  std::uint8_t law = 0;     ///< row of the table of laws
};

/// Which pairs differ in more than their partners.
struct PairColumns {
  bool shift = false;  ///< those across a periodic side
  bool law = false;    ///< where there are several laws
};

/// The pairs of one kind that a block holds, ascending by the holder, in columns. Every particle
/// has some four pairs in each of two lists: so what all pairs have alike has no column, and a
/// `Place` is no wider than it must be.
template <class Place>
struct PairList {
  std::vector<std::uint16_t> mine;
  std::vector<Place> other;
  std::vector<std::uint8_t> shift;  ///< empty: none
  std::vector<std::uint8_t> law;    ///< empty: all contacts have the same

  int size() const { return static_cast<int>(mine.size()); }

  void assign(std::span<const Pair> pairs, const PairColumns& columns) {
    fill(pairs, &Pair::mine, mine);
    fill(pairs, &Pair::other, other);
    if (columns.shift) fill(pairs, &Pair::shift, shift);
    if (columns.law) fill(pairs, &Pair::law, law);
  }

 private:
  template <class Member, class Value>
  static void fill(std::span<const Pair> pairs, Member member, std::vector<Value>& column) {
    resize_with_room(pairs.size(), column);
    for (std::size_t n = 0; n < pairs.size(); ++n) {
      column[n] = static_cast<Value>(pairs[n].*member);
    }
  }
};

/// Partners in the own block, and others.
using InnerList = PairList<std::uint16_t>;
using OuterList = PairList<std::int32_t>;

}  // namespace fluxpact
