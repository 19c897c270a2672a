// The contacts of pairs of particles: the loop in which the program spends most of its time.
#if defined(FLUXPACT_PAIR_PASS_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef FLUXPACT_PAIR_PASS_INL_
#undef FLUXPACT_PAIR_PASS_INL_
#else
#define FLUXPACT_PAIR_PASS_INL_
#endif

#include <hwy/cache_control.h>

#include <bit>

#include "dem_server/backends/native/batch-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace fluxpact::HWY_NAMESPACE {

/// Partners are fetched this many pairs ahead: their rows lie anywhere in the block, or beyond it.
inline constexpr int fetch_ahead = 64;

/// Which of the pairs of a block: inner ones act on both partners, the others on the holder only.
enum class Kind { inner, outer, image };

/// The partners of each lane.
template <class Real, bool turning>
struct Partners {
  const Body<Real, turning>* a[width];
  const Body<Real, turning>* b[width];
};

/// Fills in the partners of a batch. (Not a constructor, nor by value: that would copy through
/// memory.)
template <class Real, bool turning, Kind kind>
HWY_INLINE void find_partners(const BlockPass<Real, turning>& pass, const Pair* const* pairs,
                              Partners<Real, turning>& partners) {
  const Body<Real, turning>* mine = pass.bodies + pass.first;
  const Body<Real, turning>* theirs = kind == Kind::inner ? mine : pass.bodies;
  for (int k = 0; k < width; ++k) {
    partners.a[k] = mine + pairs[k]->mine;
    partners.b[k] = theirs + pairs[k]->other;
  }
}

/// The partners to where their images are.
template <class Real, bool turning>
HWY_INLINE void shift(const BlockPass<Real, turning>& pass, const Pair* const* pairs,
                      Quad<hn::Vec<Positions>>& apart) {
  const auto by = gather_rows(Positions(), [&](int k) { return pass.shifts[pairs[k]->shift]; });
  apart.a = hn::Sub(apart.a, by.a);
  apart.b = hn::Sub(apart.b, by.b);
  apart.c = hn::Sub(apart.c, by.c);
}

/// How the partners stand and move to each other: differences from partner to holder, and the sums
/// of radii and of inverse masses.
template <class Real>
struct Relative {
  Quad<hn::Vec<Positions>> apart;       // [m]
  Quad<hn::Vec<Lanes<Real>>> velocity;  // [m/s]
};

template <class Real, bool turning, Kind kind>
HWY_INLINE Relative<Real> between(const BlockPass<Real, turning>& pass, const Pair* const* pairs,
                                  const Partners<Real, turning>& partners) {
  const Positions d;
  const auto first = [&](int k) { return partners.a[k]->position; };
  const auto second = [&](int k) { return partners.b[k]->position; };
  Relative<Real> relative;
  if constexpr (sizeof(Real) == sizeof(double)) {  // velocities follow positions in one row
    const auto both = combine_long_rows(d, first, second, Flip<double>::difference);
    relative = {both.low, both.high};
  } else {
    relative.apart = combine_rows(d, first, second, Flip<double>::difference);
  }
  if constexpr (kind == Kind::image) shift(pass, pairs, relative.apart);
  return relative;
}

/// Velocities, where they do not come with the positions, and spins.
template <class Real, bool turning>
HWY_INLINE void add_motion(const Partners<Real, turning>& partners, Quad<hn::Vec<Lanes<Real>>>& v,
                           TouchLanes<hn::Vec<Lanes<Real>>>& touch) {
  const Lanes<Real> d;
  const auto row_a = [&](int k) { return partners.a[k]->velocity; };
  const auto row_b = [&](int k) { return partners.b[k]->velocity; };
  if constexpr (sizeof(Real) == sizeof(double)) {
    if constexpr (turning) {
      const auto spin_a = [&](int k) { return partners.a[k]->radius_spin; };
      const auto spin_b = [&](int k) { return partners.b[k]->radius_spin; };
      const auto w = combine_rows(d, spin_a, spin_b, Flip<Real>::sum);
      touch.radius_spin = {w.a, w.b, w.c};
    }
  } else {
    if constexpr (turning) {
      const auto both = combine_long_rows(d, row_a, row_b, Flip<Real>::motion);
      v = both.low;
      touch.radius_spin = {both.high.a, both.high.b, both.high.c};
    } else {
      v = combine_rows(d, row_a, row_b, Flip<Real>::difference);
    }
  }
  touch.velocity = {v.a, v.b, v.c};
}

/// 1/R* from the radii of the holders and the sums.
template <class Real, bool turning>
HWY_INLINE hn::Vec<Lanes<Real>> curvature(const Body<Real, turning>* const* a,
                                          hn::Vec<Positions> sum) {
  const Positions d;
  alignas(64) double radius[width];
  for (int k = 0; k < width; ++k) radius[k] = a[k]->radius;
  const auto own = hn::Load(d, radius);
  return to_real<Real>(hn::Div(sum, hn::Mul(own, hn::Sub(sum, own))));
}

/// A batch of near pairs on its way through the three steps.
template <class Real, bool turning>
struct PairBatch {
  using V = hn::Vec<Lanes<Real>>;
  int count;  // of pairs; the other lanes repeat the last
  const Pair* pairs[width];
  const SpringRow<Real>* before[width];  // springs of the sub-step before
  TouchLanes<V> touch;
  RollLanes<Real> roll_a, roll_b;  // with a rolling law
  ForceLanes<V> out;
};

/// Many batches go through each step before the next: the chain of operations in one batch is long,
/// and the processor can only look ahead into another if the steps are short.
inline constexpr int batches_at_once = 4;

/// Pairs of a list that touch or are within the reach of the law, on their way to their forces.
inline constexpr int near_enough = batches_at_once * width;
inline constexpr int near_room = near_enough + 2 * width;
struct NearPairs {
  alignas(64) std::int32_t place[near_room] = {};   // in the list
  alignas(64) std::int32_t spring[near_room] = {};  // of the sub-step before; -1: none
  int count = 0;
  int springs_passed = 0;  // of the sub-step before

  /// The first spring that is still to be read.
  HWY_INLINE int oldest_spring() const {
    for (int n = 0; n < count; ++n) {
      if (spring[n] >= 0) return spring[n];
    }
    return springs_passed;
  }
};
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

/// (Iota would go through memory.)
alignas(32) inline constexpr std::int32_t lane_numbers[8] = {0, 1, 2, 3, 4, 5, 6, 7};

/// Which springs of the sub-step before are those of the pairs that are `touching` (bits from place
/// `at` on). Those of pairs that have come apart are left behind.
template <class Real>
HWY_INLINE void match_springs(int at, unsigned touching, PairSprings<Real>& springs,
                              NearPairs& near) {
  constexpr unsigned all = (1U << width) - 1;
  const int shift = at % 8;
  std::uint8_t& byte = springs.held(at);
  const unsigned held = byte >> shift & all;
  byte = static_cast<std::uint8_t>((byte & ~(all << shift)) | touching << shift);
  const int first = near.springs_passed;
  near.springs_passed += std::popcount(held);
  std::int32_t* spring = near.spring + near.count;
  if (held == touching) {  // nearly always
    const Places places;
    const auto next = hn::Add(hn::Set(places, first), hn::Load(places, lane_numbers));
    hn::StoreU(next, places, spring);
    return;
  }
  for (unsigned rest = touching; rest != 0; rest &= rest - 1) {
    const unsigned bit = rest & (0 - rest);
    *spring++ = (held & bit) != 0 ? first + std::popcount(held & (bit - 1)) : -1;
  }
}

/// Adds to `near` which of `count` pairs from place `at` on are near.
template <class Real, bool turning, Kind kind>
HWY_INLINE void sift(const BlockPass<Real, turning>& pass, const Pair* const* pairs, int count,
                     int at, PairSprings<Real>& springs, NearPairs& near) {
  const Positions d;
  Partners<Real, turning> partners;
  find_partners<Real, turning, kind>(pass, pairs, partners);
  const auto first = [&](int k) { return partners.a[k]->position; };
  const auto second = [&](int k) { return partners.b[k]->position; };
  auto apart = combine_rows(d, first, second, Flip<double>::difference);
  if constexpr (kind == Kind::image) shift(pass, pairs, apart);
  const auto square =
      hn::MulAdd(apart.a, apart.a, hn::MulAdd(apart.b, apart.b, hn::Mul(apart.c, apart.c)));
  const auto reach = hn::Add(apart.d, hn::Set(d, pass.beyond_contact));
  const auto are_near = hn::And(hn::Lt(square, hn::Mul(reach, reach)), hn::FirstN(d, count));
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, are_near, bytes);
  const unsigned bits = bytes[0];
  // (Compress would do, but copies its table to the stack each time.)
  const Places places;
  const auto set = hn::LoadU(hn::Rebind<std::uint8_t, Places>(), bit_places.of[bits]);
  hn::StoreU(hn::Add(hn::PromoteTo(places, set), hn::Set(places, at)), places,
             near.place + near.count);
  if (springs.rows_each() > 0) match_springs(at, bits, springs, near);
  near.count += std::popcount(bits);
}

/// First step: how the partners stand and move to each other.
template <class Real, bool turning, Kind kind>
FLUXPACT_CONTACT_STEP void approach(const BlockPass<Real, turning>& pass,
                                    PairBatch<Real, turning>& batch) {
  const ContactModel& model = pass.laws->model;
  Partners<Real, turning> partners;
  find_partners<Real, turning, kind>(pass, batch.pairs, partners);
  auto relative = between<Real, turning, kind>(pass, batch.pairs, partners);
  const Gap<Real> gap = gap_between<Real>(relative.apart);
  auto& touch = batch.touch;
  touch.normal = gap.normal;
  touch.overlap = gap.overlap;
  add_motion(partners, relative.velocity, touch);
  touch.root_mass = root_mass<Real>(pass.root_masses.pair, relative.velocity.d);
  if (needs_curvature(model)) {
    touch.inverse_radius = curvature<Real>(partners.a, relative.apart.d);
  }
  if constexpr (turning) {
    if (model.rolling != RollingLaw::none) {
      const hn::Vec<Lanes<Real>> minus = hn::Set(Lanes<Real>(), Real(-1));
      batch.roll_a = gather_roll(partners.a);
      batch.roll_b = gather_roll(partners.b);
      touch.spin = plus_scaled(batch.roll_a.spin, minus, batch.roll_b.spin);
      touch.inverse_inertia = hn::Add(batch.roll_a.inverse_inertia, batch.roll_b.inverse_inertia);
    }
  }
}

/// Second step: springs and forces.
template <class Real, bool turning>
FLUXPACT_CONTACT_STEP void respond(const BlockPass<Real, turning>& pass, PairSprings<Real>& springs,
                                   PairBatch<Real, turning>& batch) {
  const Lanes<Real> d;
  const ContactModel& model = pass.laws->model;
  auto spring = load_springs<Real>(model, batch.before);
  auto out = no_force<Real>();
  contact_force<turning>(d, model, law_of(*pass.laws, [&](int k) { return batch.pairs[k]->law; }),
                         batch.touch, hn::Set(d, static_cast<Real>(pass.spring_step)), spring,
                         hn::FirstN(d, batch.count), out);
  if (springs.rows_each() > 0) {
    SpringRow<Real>* after[width] = {};
    springs.put(batch.count, after);
    store_springs<Real>(model, spring, batch.count, after);
  }
  batch.out.force = out.force;
  if constexpr (turning) {
    batch.out.lever = out.lever;
    if (model.rolling != RollingLaw::none) batch.out.torque = out.torque;
  }
}

/// Third step: to the sums of the particles.
template <class Real, bool turning, Kind kind>
FLUXPACT_CONTACT_STEP void hand_over(const BlockPass<Real, turning>& pass,
                                     const PairBatch<Real, turning>& batch) {
  const Pair* const* pairs = batch.pairs;
  const auto holder = [&](int k) { return pairs[k]->mine; };
  const auto partner = [&](int k) { return pairs[k]->other; };
  if constexpr (turning) {
    if (pass.laws->model.rolling != RollingLaw::none) {
      ForceLanes<hn::Vec<Lanes<Real>>> own = batch.out;
      own.lever = plus_scaled(own.lever, batch.roll_a.inverse_radius, own.torque);
      LoadRows<Real, turning>(own).template add_to<false>(pass.sum, holder);
      if constexpr (kind == Kind::inner) {
        own.lever = minus_scaled(batch.out.lever, batch.roll_b.inverse_radius, own.torque);
        LoadRows<Real, turning>(own).template add_to<true>(pass.sum, partner);
      }
      return;
    }
  }
  const LoadRows<Real, turning> loads(batch.out);
  loads.template add_to<false>(pass.sum, holder);
  if constexpr (kind == Kind::inner) loads.template add_to<true>(pass.sum, partner);
}

/// Those that the next pairs to pass will need.
template <class Real>
HWY_INLINE void fetch_springs(const PairSprings<Real>& springs, int first) {
  constexpr int springs_a_line = std::max(1, 64 / static_cast<int>(sizeof(SpringRow<Real>)));
  for (int n = 0; n < near_enough; n += springs_a_line) hwy::Prefetch(springs.before(first + n));
}

/// The forces of near pairs, in whole batches; a rest stays, unless it is the `last`.
template <class Real, bool turning, Kind kind>
HWY_INLINE void pass_near(const BlockPass<Real, turning>& pass, const std::vector<Pair>& list,
                          bool last, PairSprings<Real>& springs, NearPairs& near) {
  PairBatch<Real, turning> batches[near_room / width];
  const bool remembers = springs.rows_each() > 0;
  if (remembers) springs.make_room(near.count, near.oldest_spring());
  int full = 0;
  int at = 0;
  for (; at + (last ? 1 : width) <= near.count; at += width) {
    PairBatch<Real, turning>& batch = batches[full++];
    batch.count = std::min(width, near.count - at);
    for (int k = 0; k < width; ++k) {
      const int n = at + std::min(k, batch.count - 1);
      batch.pairs[k] = list.data() + near.place[n];
      const int spring = near.spring[n];
      batch.before[k] = remembers && spring >= 0 ? springs.before(spring) : springs.unstretched();
    }
  }
  if (remembers) fetch_springs(springs, near.springs_passed);
  for (int b = 0; b < full; ++b) approach<Real, turning, kind>(pass, batches[b]);
  for (int b = 0; b < full; ++b) respond<Real, turning>(pass, springs, batches[b]);
  for (int b = 0; b < full; ++b) hand_over<Real, turning, kind>(pass, batches[b]);
  near.count = std::max(near.count - at, 0);
  const Places places;  // the rest is less than a batch
  hn::StoreU(hn::LoadU(places, near.place + at), places, near.place);
  hn::StoreU(hn::LoadU(places, near.spring + at), places, near.spring);
}

/// Partners of a batch that comes later.
template <class Real, bool turning>
HWY_INLINE void fetch(const Body<Real, turning>* theirs, const std::vector<Pair>& list, int at) {
  for (int k = 0; k < width; ++k) {
    const Body<Real, turning>* partner = theirs + list[at + k].other;
    hwy::Prefetch(partner);
    if constexpr (sizeof(*partner) > 64) hwy::Prefetch(partner->radius_spin);
  }
}

/// All pairs of one kind: which of them touch, then their forces. Much of a list does not touch,
/// the more so the livelier the bed; so registers are full of what does.
template <class Real, bool turning, Kind kind>
HWY_INLINE void pass_list(const BlockPass<Real, turning>& pass, const std::vector<Pair>& list,
                          PairSprings<Real>& springs) {
  const Body<Real, turning>* theirs = kind == Kind::inner ? pass.bodies + pass.first : pass.bodies;
  const int size = static_cast<int>(list.size());
  const int whole = size / width * width;
  NearPairs near;
  const Pair* pairs[width];
  for (int at = 0; at < whole; at += width) {
    fetch(theirs, list, std::min(at + fetch_ahead, whole - width));
    for (int k = 0; k < width; ++k) pairs[k] = list.data() + at + k;
    sift<Real, turning, kind>(pass, pairs, width, at, springs, near);
    if (near.count >= near_enough) {
      pass_near<Real, turning, kind>(pass, list, false, springs, near);
    }
  }
  if (whole < size) {  // the last pair again where there is none
    for (int k = 0; k < width; ++k) pairs[k] = list.data() + std::min(whole + k, size - 1);
    sift<Real, turning, kind>(pass, pairs, size - whole, whole, springs, near);
  }
  pass_near<Real, turning, kind>(pass, list, true, springs, near);
  springs.turn();
}

}  // namespace fluxpact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
