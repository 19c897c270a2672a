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

/// One batch of pairs.
template <class Real, bool turning, Kind kind>
HWY_INLINE void pass_pairs(const BlockPass<Real, turning>& pass, const Pair* pairs, int count,
                           int at, Springs<Real>& springs) {
  const Lanes<Real> d;
  using V = hn::Vec<Lanes<Real>>;
  const ContactModel& model = pass.laws->model;
  const Body<Real, turning>* mine = pass.now + pass.first;
  const Body<Real, turning>* theirs = kind == Kind::inner ? mine : pass.now;
  Partners<Real, turning> partners;
  for (int k = 0; k < width; ++k) {
    partners.a[k] = mine + pairs[k].mine;
    partners.b[k] = theirs + pairs[k].other;
  }
  auto relative = between<Real, turning, kind>(pass, pairs, partners);
  const Gap<Real> gap = gap_between<Real>(relative.apart, pass.beyond_contact, count);
  const V zero = hn::Zero(d);
  if (hn::AllFalse(d, gap.near)) {
    store_springs<Real, turning>(model, {{zero, zero, zero}, {zero, zero, zero}, zero}, at,
                                 springs);
    return;
  }
  auto touch = no_touch<Real>();
  touch.normal = gap.normal;
  touch.overlap = gap.overlap;
  add_motion(partners, relative.velocity, touch);
  touch.root_mass = root_mass<Real>(pass.root_masses.pair, relative.velocity.d);
  touch.inverse_radius =
      needs_curvature(model) ? curvature<Real>(partners.a, relative.apart.d) : zero;
  RollLanes<Real> roll_a = no_roll<Real>();
  RollLanes<Real> roll_b = no_roll<Real>();
  const bool rolls = turning && model.rolling != RollingLaw::none;
  if constexpr (turning) {
    if (rolls) {
      roll_a = gather_roll(partners.a);
      roll_b = gather_roll(partners.b);
      touch.spin = plus_scaled(roll_a.spin, hn::Set(d, Real(-1)), roll_b.spin);
      touch.inverse_inertia = hn::Add(roll_a.inverse_inertia, roll_b.inverse_inertia);
    }
  }
  SpringLanes<V> spring = load_springs<Real, turning>(model, springs, at);
  ForceLanes<V> out = no_force<Real>();
  contact_force<turning>(d, model, law_of(*pass.laws, pairs), touch,
                         hn::Set(d, static_cast<Real>(pass.spring_step)), spring, gap.near, out);
  store_springs<Real, turning>(model, spring, at, springs);
  const auto holder = [&](int k) { return pairs[k].mine; };
  const auto partner = [&](int k) { return pairs[k].other; };
  if (!rolls) {
    const LoadRows<Real, turning> loads(out);
    loads.template add_to<false>(pass.sum, holder);
    if constexpr (kind == Kind::inner) loads.template add_to<true>(pass.sum, partner);
    return;
  }
  ForceLanes<V> mirrored = out;
  out.lever = plus_scaled(out.lever, roll_a.inverse_radius, out.torque);
  LoadRows<Real, turning>(out).template add_to<false>(pass.sum, holder);
  if constexpr (kind == Kind::inner) {
    mirrored.lever = minus_scaled(mirrored.lever, roll_b.inverse_radius, out.torque);
    LoadRows<Real, turning>(mirrored).template add_to<true>(pass.sum, partner);
  }
}

template <class Real, bool turning, Kind kind>
HWY_INLINE void pass_list(const BlockPass<Real, turning>& pass, const std::vector<Pair>& list,
                          Springs<Real>& springs) {
  const Body<Real, turning>* theirs = kind == Kind::inner ? pass.now + pass.first : pass.now;
  const int size = static_cast<int>(list.size());
  const int whole = size / width * width;
  for (int at = 0; at < whole; at += width) {
    const int ahead = std::min(at + fetch_ahead, whole - width);
    for (int k = 0; k < width; ++k) {
      const Body<Real, turning>* partner = theirs + list[ahead + k].other;
      hwy::Prefetch(partner);
      if constexpr (sizeof(*partner) > 64) hwy::Prefetch(partner->radius_spin);
    }
    pass_pairs<Real, turning, kind>(pass, list.data() + at, width, at, springs);
  }
  if (whole == size) return;
  Pair rest[width];  // the last pair again where there is none; FirstN masks it
  for (int k = 0; k < width; ++k) rest[k] = list[std::min(whole + k, size - 1)];
  pass_pairs<Real, turning, kind>(pass, rest, size - whole, whole, springs);
}

}  // namespace fluxpact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
