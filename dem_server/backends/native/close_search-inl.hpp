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
  alignas(8) std::uint8_t of[1 << width][8];
};
inline constexpr BitPlaces bit_places = [] {
  BitPlaces places{};
  for (int bits = 0; bits < 1 << width; ++bits) {
    int next = 0;
    for (int place = 0; place < width; ++place) {
      if ((bits >> place & 1) != 0) places.of[bits][next++] = static_cast<std::uint8_t>(place);
    }
  }
  return places;
}();

/// Bits of those of `count` pairs of a list, from `first` on, that are close: as near as the room,
/// or so within the flight, in which the distance grows by no less than its first rate times the
/// time.
template <class Real, bool turning, Kind kind, class Place>
HWY_INLINE unsigned sift(const BlockPass<Real, turning>& pass, const PairList<Place>& list,
                         int first, int count) {
  const Positions d;
  const auto pair = [&](int k) { return first + std::min(k, count - 1); };
  Partners<Real, turning> partners;
  find_partners<Real, turning, kind>(
      pass, [&](int k) { return list.mine[pair(k)]; }, [&](int k) { return list.other[pair(k)]; },
      partners);
  auto relative = between<Real, turning>(partners);
  auto& apart = relative.apart;
  if constexpr (kind == Kind::image) {
    shift(
        pass, [&](int k) { return list.shift[pair(k)]; }, apart);
  }
  Quad<hn::Vec<Positions>> velocity;
  if constexpr (sizeof(Real) == sizeof(double)) {
    velocity = relative.velocity;
  } else {
    const Lanes<Real> dr;
    const auto v = combine_rows(
        dr, [&](int k) { return partners.a[k]->velocity; },
        [&](int k) { return partners.b[k]->velocity; }, Flip<Real>::difference);
    velocity = {hn::PromoteTo(d, v.a), hn::PromoteTo(d, v.b), hn::PromoteTo(d, v.c),
                hn::PromoteTo(d, v.d)};
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
  const int whole = size / width * width;
  std::vector<std::int32_t>& found = pass.search->places;
  found.resize(std::max(found.size(), static_cast<std::size_t>(size + width)));
  int count = 0;
  const Places d;
  const auto add = [&](int at, unsigned bits) HWY_ATTR {
    // (Compress would do, but copies its table to the stack each time.)
    const auto set = hn::LoadU(hn::Rebind<std::uint8_t, Places>(), bit_places.of[bits]);
    hn::StoreU(hn::Add(hn::PromoteTo(d, set), hn::Set(d, at)), d, found.data() + count);
    count += std::popcount(bits);
  };
  for (int at = 0; at < whole; at += width) {
    const Place* later = pairs.other.data() + std::min(at + fetch_ahead, whole - width);
    fetch(theirs<Real, turning, kind>(pass), [&](int k) { return later[k]; });
    add(at, sift<Real, turning, kind>(pass, pairs, at, width));
  }
  if (whole < size) add(whole, sift<Real, turning, kind>(pass, pairs, whole, size - whole));
  ClosePairs<Real>& renewed = pass.search->renewed;
  renewed.renew(pairs, {found.data(), static_cast<std::size_t>(count)}, close);
  close.copy(renewed);
}

}  // namespace fluxpact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
