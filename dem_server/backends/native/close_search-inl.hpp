// Which pairs of a list are close: all are looked at, now and then, before the forces.
#if defined(FLUXPACT_CLOSE_SEARCH_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef FLUXPACT_CLOSE_SEARCH_INL_
#undef FLUXPACT_CLOSE_SEARCH_INL_
#else
#define FLUXPACT_CLOSE_SEARCH_INL_
#endif

#include <bit>

#include "dem_server/backends/native/pair_pass-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace fluxpact::HWY_NAMESPACE {

using Places = hn::Rebind<std::int32_t, Positions>;

/// For each pattern of bits the places of those that are set, in order.
struct BitPlaces {
  alignas(8) std::uint8_t of[1 << positions][8];
};
inline constexpr BitPlaces bit_places = [] {
  BitPlaces places{};
  for (int bits = 0; bits < 1 << positions; ++bits) {
    int next = 0;
    for (int place = 0; place < positions; ++place) {
      if ((bits >> place & 1) != 0) places.of[bits][next++] = static_cast<std::uint8_t>(place);
    }
  }
  return places;
}();

/// Bits of the first `count` lanes where it holds.
template <class M>
HWY_INLINE unsigned bits_of(M holds, int count) {
  const Positions d;
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, hn::And(holds, hn::FirstN(d, count)), bytes);
  return bytes[0];
}

/// Bits of those of `count` pairs of a list, from `first` on, that are close: as near as the room,
/// or so within the flight, in which the distance grows by no less than its first rate times the
/// time.
template <class Real, bool turning, Kind kind, class Place>
HWY_INLINE unsigned sift(const BlockPass<Real, turning>& pass, const PairList<Place>& list,
                         int first, int count) {
  const Positions d;
  const auto pair = [&](int k) { return first + std::min(k, count - 1); };
  Partners<Real, turning, positions> partners;
  find_partners<kind>(
      pass, [&](int k) { return list.mine[pair(k)]; }, [&](int k) { return list.other[pair(k)]; },
      partners);
  Quad<hn::Vec<Positions>> apart, velocity;
  if constexpr (sizeof(Real) == sizeof(double)) {
    const auto both = between(partners);
    assign(both.low, apart);
    assign(both.high, velocity);
  } else {
    assign(offsets(partners, 0), apart);
    const auto v = combine_rows(
        hn::Rebind<Real, Positions>(), [&](int k) { return partners.a[k]->velocity; },
        [&](int k) { return partners.b[k]->velocity; }, Flip<Real>::difference);
    velocity.a = hn::PromoteTo(d, v.a);
    velocity.b = hn::PromoteTo(d, v.b);
    velocity.c = hn::PromoteTo(d, v.c);
    velocity.d = hn::PromoteTo(d, v.d);
  }
  if constexpr (kind == Kind::image) {
    shift(
        pass, [&](int k) { return list.shift[pair(k)]; }, apart);
  }
  const CloseBudget& budget = pass.contacts->budget;
  const auto square = square_of(apart);
  const auto distance = hn::Sqrt(square);
  const auto along = hn::MulAdd(apart.a, velocity.a,
                                hn::MulAdd(apart.b, velocity.b, hn::Mul(apart.c, velocity.c)));
  const auto later = hn::MulAdd(hn::Div(along, distance), hn::Set(d, budget.flight), distance);
  const auto reach = hn::Add(apart.d, hn::Set(d, pass.beyond_contact + budget.room));
  return bits_of(hn::Or(hn::Lt(square, hn::Mul(reach, reach)), hn::Lt(later, reach)), count);
}

/// All pairs of a list: which of them are close now. Springs stay with those that have some.
template <class Real, bool turning, Kind kind, class Place>
HWY_INLINE void go_through(const BlockPass<Real, turning>& pass, const PairList<Place>& pairs,
                           ClosePairs<Real>& close) {
  const int size = pairs.size();
  const int whole = size / positions * positions;
  std::vector<std::int32_t>& found = pass.search->places;
  found.resize(std::max(found.size(), static_cast<std::size_t>(size + positions)));
  int count = 0;
  const Places d;
  const auto add = [&](int at, unsigned bits) HWY_ATTR {
    // (Compress would do, but copies its table to the stack each time.)
    const auto set = hn::LoadU(hn::Rebind<std::uint8_t, Places>(), bit_places.of[bits]);
    hn::StoreU(hn::Add(hn::PromoteTo(d, set), hn::Set(d, at)), d, found.data() + count);
    count += std::popcount(bits);
  };
  for (int at = 0; at < whole; at += positions) {
    const Place* later = pairs.other.data() + std::min(at + fetch_ahead, whole - positions);
    fetch<positions>(theirs<Real, turning, kind>(pass), [&](int k) { return later[k]; });
    add(at, sift<Real, turning, kind>(pass, pairs, at, positions));
  }
  if (whole < size) add(whole, sift<Real, turning, kind>(pass, pairs, whole, size - whole));
  ClosePairs<Real>& renewed = pass.search->renewed;
  renewed.renew(pairs, {found.data(), static_cast<std::size_t>(count)}, close);
  close.copy(renewed);
}

}  // namespace fluxpact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
