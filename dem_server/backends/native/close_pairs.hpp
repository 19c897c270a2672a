// The pairs of a list that touch or may do so within the next sub-steps, with their springs in
// place.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "dem_server/backends/native/pair_list.hpp"
#include "dem_server/backends/native/springs.hpp"

namespace fluxpact {

/// Those of one list that were `close` when it was last gone through, in its order and in batches
/// of as many as the widest vector register holds; the last batch is filled up with the last pair.
/// All others are apart for sure for some sub-steps
/// (CloseBudget), which need not look at them; a close pair that does not touch has no force and no
/// springs.
template <class Real>
class ClosePairs {
 public:
  static constexpr int batch_size = 64 / sizeof(Real);

  int count() const { return count_; }
  /// The places of the partners, and of the pairs in the list.
  const std::uint16_t* mine() const { return mine_.data(); }
  const std::int32_t* other() const { return other_.data(); }
  const std::int32_t* places() const { return places_.data(); }
  /// The first number (SpringNumbers) of a pair, that of the next one in its batch beside it; the
  /// next number is `batch_size` further.
  Real* springs(int n) { return springs_.data() + first_number(n); }

  /// The springs of all pairs of the list that have some.
  void take_springs(PairSprings<Real>& to) const {
    int some = 0;
    for (int first = 0; first < count_; first += batch_size) some += find_springs(first).count;
    to.reset(pairs_, each_, some);
    for (int first = 0; first < count_; first += batch_size) {
      const WithSprings found = find_springs(first);
      for (int k = 0; k < found.count; ++k) {
        const int n = first + found.lane[k];
        to.append(places_[n], springs_of(n), batch_size, false);
      }
    }
  }
  /// The pairs at `places` (ascending) of the list, with the springs that they have in `before`,
  /// which is of the same list.
  template <class List>
  void renew(const List& list, std::span<const std::int32_t> places, const ClosePairs& before) {
    each_ = before.each_;
    assign(list, places);
    int old = 0;
    for (int n = 0; n < count_ && each_.count > 0; ++n) {
      while (old < before.count_ && before.places_[old] < places_[n]) ++old;
      if (old == before.count_) break;
      if (before.places_[old] == places_[n]) put(n, before.springs_of(old), batch_size);
    }
  }
  /// A copy in the room that is there.
  void copy(const ClosePairs& other) {
    count_ = other.count_;
    pairs_ = other.pairs_;
    each_ = other.each_;
    assign_with_room(other.mine_, mine_);
    assign_with_room(other.other_, other_);
    assign_with_room(other.places_, places_);
    assign_with_room(other.springs_, springs_);
  }
  /// Springs kept earlier: only the pairs that have some are here then, until the list is gone
  /// through. `places`: room.
  template <class List>
  void bring_back(const List& list, const PairSprings<Real>& from,
                  std::vector<std::int32_t>& places) {
    places.clear();
    from.visit([&](int place, const Real*) { places.push_back(place); });
    each_ = from.each();
    assign(list, places);
    int n = 0;
    from.visit([&](int, const Real* numbers) { put(n++, numbers, 1); });
  }

 private:
  /// Pairs without springs.
  template <class List>
  void assign(const List& list, std::span<const std::int32_t> places) {
    count_ = static_cast<int>(places.size());
    pairs_ = list.size();
    const std::size_t lanes = (places.size() + batch_size - 1) / batch_size * batch_size;
    resize_with_room(lanes, mine_);
    resize_with_room(lanes, other_);
    resize_with_room(lanes, places_);
    resize_with_room(lanes * static_cast<std::size_t>(each_.count), springs_);
    std::fill(springs_.begin(), springs_.end(), Real{0});
    for (int n = 0; n < static_cast<int>(lanes); ++n) {
      const std::int32_t place = places[std::min(n, count_ - 1)];
      places_[n] = place;
      mine_[n] = list.mine[place];
      other_[n] = list.other[place];
    }
  }
  void put(int n, const Real* numbers, int stride) {
    Real* const to = springs(n);
    for (int k = 0; k < each_.count; ++k) {
      to[std::ptrdiff_t{k} * batch_size] = numbers[std::ptrdiff_t{k} * stride];
    }
  }
  const Real* springs_of(int n) const { return springs_.data() + first_number(n); }
  std::ptrdiff_t first_number(int n) const {
    const int lane = n & (batch_size - 1);  // (the compiler does not know that n is not negative)
    return std::ptrdiff_t{n - lane} * each_.count + lane;
  }
  /// The pairs of a batch that have springs.
  struct WithSprings {
    std::array<std::uint8_t, batch_size> lane;
    int count = 0;
  };
  /// Of the batch that begins with pair `first`. Which have some cannot be foretold: so there is no
  /// branch.
  WithSprings find_springs(int first) const {
    std::array<std::uint8_t, batch_size> has{};
    for (int k = 0; k < each_.count; ++k) {
      const Real* const numbers = springs_of(first) + std::ptrdiff_t{k} * batch_size;
      for (int n = 0; n < batch_size; ++n) has[n] |= numbers[n] != 0 ? 1 : 0;
    }
    WithSprings found;
    for (int n = 0; n < std::min(batch_size, count_ - first); ++n) {
      found.lane[found.count] = static_cast<std::uint8_t>(n);
      found.count += has[n];
    }
    return found;
  }

  std::vector<std::uint16_t> mine_;
  std::vector<std::int32_t> other_;
  std::vector<std::int32_t> places_;
  HugeVector<Real> springs_;
  SpringNumbers each_;
  int count_ = 0;
  int pairs_ = 0;  // of the list
};

/// For how long the close pairs of a block will do. Those that are not close would be apart after
/// `flight` if all went on as they were going, with `room` to spare between the surfaces; and kicks
/// can take particles from such a flight by so much only.
struct CloseBudget {
  double flight = -1;  ///< [s] of what is left of it; below 0: the list must be gone through
  double room = 0;     ///< [m]
  double speed = 0;    ///< [m/s] by which partners may differ from that flight
  double way = 0;      ///< [m] the same

  /// In a new list, and wherever particles were put elsewhere.
  void forget() { flight = -1; }
  /// After a kick of both partners together of at most `kick` [m/s], and a drift. False if the list
  /// must be gone through.
  bool spend(double kick, double time_step) {
    speed += kick;
    way += speed * time_step;
    flight -= time_step;
    // (The millionth of the room is for the rounding of time and positions.)
    return flight > -1e-9 * time_step && way < (1 - 1e-6) * room;
  }
  /// For as many sub-steps with kicks like the last as `usual_room` [m] lasts, if that is neither
  /// too often nor so long that kicks will have changed.
  void renew(double kick, double time_step, double usual_room) {
    constexpr double fewest = 6;
    constexpr double most = 32;
    const double fall = kick * time_step;  // after n sub-steps n (n + 1)/2 of it
    const double steps = std::floor(std::sqrt(2 * usual_room / std::max(fall, 1e-300)));
    const double n = std::clamp(steps, fewest, most);
    flight = n * time_step;
    room = std::max(usual_room, 1.2 * fall * n * (n + 1) / 2);
    speed = 0;
    way = 0;
  }
};

/// What going through a list needs; kept, so that it needs no memory of its own each time.
template <class Real>
struct CloseSearch {
  ClosePairs<Real> renewed;
  std::vector<std::int32_t> places;
};

}  // namespace fluxpact
