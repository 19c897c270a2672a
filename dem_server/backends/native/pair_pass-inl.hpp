// The contacts of pairs of particles: the loop in which the program spends most of its time.
#if defined(FLUXPACT_PAIR_PASS_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef FLUXPACT_PAIR_PASS_INL_
#undef FLUXPACT_PAIR_PASS_INL_
#else
#define FLUXPACT_PAIR_PASS_INL_
#endif

#include <hwy/cache_control.h>

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

  /// Rows of them, from numbers that are `first` of each body.
  template <class Number>
  HWY_INLINE void rows(Number (Body<Real, turning>::*first)[3], const Number** row_a,
                       const Number** row_b) const {
    for (int k = 0; k < width; ++k) {
      row_a[k] = a[k]->*first;
      row_b[k] = b[k]->*first;
    }
  }
};

/// How the partners stand and move to each other: differences from partner to holder, and the sums
/// of radii and of inverse masses.
template <class Real>
struct Relative {
  Quad<hn::Vec<Positions>> apart;       // [m]
  Quad<hn::Vec<Lanes<Real>>> velocity;  // [m/s]
};

template <class Real, bool turning, Kind kind>
HWY_INLINE Relative<Real> between(const BlockPass<Real, turning>& pass, const Pair* pairs,
                                  const Partners<Real, turning>& partners) {
  const Positions d;
  const double* first[width];
  const double* second[width];
  partners.rows(&Body<Real, turning>::position, first, second);
  Relative<Real> relative;
  if constexpr (sizeof(Real) == sizeof(double)) {  // velocities follow positions in one row
    const auto both = combine_long_rows(d, first, second, Flip<double>::difference);
    relative = {both.low, both.high};
  } else {
    relative.apart = combine_rows(d, first, second, Flip<double>::difference);
  }
  if constexpr (kind == Kind::image) {
    for (int k = 0; k < width; ++k) first[k] = pass.shifts[pairs[k].shift];
    const auto shift = gather_rows(d, first);
    auto& apart = relative.apart;
    apart.a = hn::Sub(apart.a, shift.a);
    apart.b = hn::Sub(apart.b, shift.b);
    apart.c = hn::Sub(apart.c, shift.c);
  }
  return relative;
}

/// Velocities, where they do not come with the positions, and spins.
template <class Real, bool turning>
HWY_INLINE void add_motion(const Partners<Real, turning>& partners, Quad<hn::Vec<Lanes<Real>>>& v,
                           TouchLanes<hn::Vec<Lanes<Real>>>& touch) {
  const Lanes<Real> d;
  const Real* row_a[width];
  const Real* row_b[width];
  if constexpr (sizeof(Real) == sizeof(double)) {
    if constexpr (turning) {
      partners.rows(&Body<Real, turning>::radius_spin, row_a, row_b);
      const auto w = combine_rows(d, row_a, row_b, Flip<Real>::sum);
      touch.radius_spin = {w.a, w.b, w.c};
    }
  } else {
    partners.rows(&Body<Real, turning>::velocity, row_a, row_b);
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

/// A batch of pairs on its way through the three steps.
template <class Real>
struct PairBatch {
  using V = hn::Vec<Lanes<Real>>;
  const Pair* pairs = nullptr;
  int at = 0;     // of the first in the list
  int count = 0;  // of pairs; the other lanes repeat one
  bool near = false;
  TouchLanes<V> touch;
  RollLanes<Real> roll_a, roll_b;  // with a rolling law
  ForceLanes<V> out;
};

/// Many batches go through each step before the next: the chain of operations in one batch is long,
/// and the processor can only look ahead into another if the steps are short.
inline constexpr int batches_at_once = 8;

template <class Real>
HWY_INLINE hn::Mask<Lanes<Real>> near_lanes(const PairBatch<Real>& batch, double beyond_contact) {
  const Lanes<Real> d;
  const auto reach = hn::Set(d, static_cast<Real>(-beyond_contact));
  return hn::And(hn::FirstN(d, batch.count), hn::Gt(batch.touch.overlap, reach));
}

/// First step: how the partners stand and move to each other.
template <class Real, bool turning, Kind kind>
HWY_INLINE void approach(const BlockPass<Real, turning>& pass, PairBatch<Real>& batch) {
  const ContactModel& model = pass.laws->model;
  const Body<Real, turning>* mine = pass.now + pass.first;
  const Body<Real, turning>* theirs = kind == Kind::inner ? mine : pass.now;
  Partners<Real, turning> partners;
  for (int k = 0; k < width; ++k) {
    partners.a[k] = mine + batch.pairs[k].mine;
    partners.b[k] = theirs + batch.pairs[k].other;
  }
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
HWY_INLINE void respond(const BlockPass<Real, turning>& pass, PairBatch<Real>& batch,
                        Springs<Real>& springs) {
  const Lanes<Real> d;
  const ContactModel& model = pass.laws->model;
  const auto near = near_lanes(batch, pass.beyond_contact);
  batch.near = !hn::AllFalse(d, near);
  if (!batch.near) {
    const auto zero = hn::Zero(d);
    store_springs<Real, turning>(model, {{zero, zero, zero}, {zero, zero, zero}, zero}, batch.at,
                                 springs);
    return;
  }
  auto spring = load_springs<Real, turning>(model, springs, batch.at);
  auto out = no_force<Real>();
  contact_force<turning>(d, model, law_of(*pass.laws, batch.pairs), batch.touch,
                         hn::Set(d, static_cast<Real>(pass.spring_step)), spring, near, out);
  store_springs<Real, turning>(model, spring, batch.at, springs);
  batch.out.force = out.force;
  if constexpr (turning) {
    batch.out.lever = out.lever;
    if (model.rolling != RollingLaw::none) batch.out.torque = out.torque;
  }
}

/// Third step: to the sums of the particles.
template <class Real, bool turning, Kind kind>
HWY_INLINE void hand_over(const BlockPass<Real, turning>& pass, const PairBatch<Real>& batch) {
  if (!batch.near) return;
  const Pair* pairs = batch.pairs;
  const auto holder = [&](int k) { return pairs[k].mine; };
  const auto partner = [&](int k) { return pairs[k].other; };
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

template <class Real, bool turning, Kind kind>
HWY_INLINE void pass_batches(const BlockPass<Real, turning>& pass, PairBatch<Real>* batches,
                             int count, Springs<Real>& springs) {
  for (int b = 0; b < count; ++b) approach<Real, turning, kind>(pass, batches[b]);
  for (int b = 0; b < count; ++b) respond<Real, turning>(pass, batches[b], springs);
  for (int b = 0; b < count; ++b) hand_over<Real, turning, kind>(pass, batches[b]);
}

template <class Real, bool turning, Kind kind>
HWY_INLINE void pass_list(const BlockPass<Real, turning>& pass, const std::vector<Pair>& list,
                          Springs<Real>& springs) {
  const Body<Real, turning>* theirs = kind == Kind::inner ? pass.now + pass.first : pass.now;
  const int size = static_cast<int>(list.size());
  PairBatch<Real> batches[batches_at_once];
  Pair rest[width];
  for (int at = 0; at < size;) {
    int count = 0;
    for (; count < batches_at_once && at < size; ++count, at += width) {
      PairBatch<Real>& batch = batches[count];
      batch.at = at;
      batch.count = std::min(width, size - at);
      batch.pairs = list.data() + at;
      if (batch.count < width) {  // the last pair again where there is none
        for (int k = 0; k < width; ++k) rest[k] = list[std::min(at + k, size - 1)];
        batch.pairs = rest;
      }
      const int ahead = std::max(std::min(at + fetch_ahead, size - width), 0);
      for (int k = 0; k < std::min(width, size); ++k) {
        const Body<Real, turning>* partner = theirs + list[ahead + k].other;
        hwy::Prefetch(partner);
        if constexpr (sizeof(*partner) > 64) hwy::Prefetch(partner->radius_spin);
      }
    }
    pass_batches<Real, turning, kind>(pass, batches, count, springs);
  }
}

}  // namespace fluxpact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
