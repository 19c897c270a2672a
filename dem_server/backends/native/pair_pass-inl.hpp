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

/// The vector from partner to holder, and the sum of the radii.
template <class Real, bool turning, Kind kind>
HWY_INLINE Quad<hn::Vec<Positions>> apart_of(const BlockPass<Real, turning>& pass,
                                             const Pair* pairs, const Body<Real, turning>* const* a,
                                             const Body<Real, turning>* const* b) {
  const Positions d;
  const double* first[width];
  const double* second[width];
  for (int k = 0; k < width; ++k) {
    first[k] = a[k]->position;
    second[k] = b[k]->position;
  }
  auto apart = combine_rows(d, first, second, Flip<double>::difference);
  if constexpr (kind == Kind::image) {
    for (int k = 0; k < width; ++k) first[k] = pass.shifts[pairs[k].shift];
    const auto shift = gather_rows(d, first);
    apart.a = hn::Sub(apart.a, shift.a);
    apart.b = hn::Sub(apart.b, shift.b);
    apart.c = hn::Sub(apart.c, shift.c);
  }
  return apart;
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
  const Body<Real, turning>* a[width];
  const Body<Real, turning>* b[width];
  for (int k = 0; k < width; ++k) {
    a[k] = mine + pairs[k].mine;
    b[k] = theirs + pairs[k].other;
  }
  const auto apart = apart_of<Real, turning, kind>(pass, pairs, a, b);
  const Gap<Real> gap = gap_between<Real>(apart, pass.beyond_contact, count);
  const V zero = hn::Zero(d);
  if (hn::AllFalse(d, gap.near)) {
    store_springs<Real, turning>(model, {{zero, zero, zero}, {zero, zero, zero}, zero}, at,
                                 springs);
    return;
  }
  const Real* row_a[width];
  const Real* row_b[width];
  for (int k = 0; k < width; ++k) {
    row_a[k] = a[k]->velocity;
    row_b[k] = b[k]->velocity;
  }
  const auto v = combine_rows(d, row_a, row_b, Flip<Real>::difference);
  auto touch = no_touch<Real>();
  touch.normal = gap.normal;
  touch.overlap = gap.overlap;
  touch.velocity = {v.a, v.b, v.c};
  touch.root_mass = root_mass<Real>(pass.root_masses.pair, v.d);
  touch.inverse_radius = needs_curvature(model) ? curvature<Real>(a, apart.d) : zero;
  RollLanes<Real> roll_a = no_roll<Real>();
  RollLanes<Real> roll_b = no_roll<Real>();
  if constexpr (turning) {
    for (int k = 0; k < width; ++k) {
      row_a[k] = a[k]->radius_spin;
      row_b[k] = b[k]->radius_spin;
    }
    const auto w = combine_rows(d, row_a, row_b, Flip<Real>::sum);
    touch.radius_spin = {w.a, w.b, w.c};
    if (model.rolling != RollingLaw::none) {
      roll_a = gather_roll(a);
      roll_b = gather_roll(b);
      touch.spin = plus_scaled(roll_a.spin, hn::Set(d, Real(-1)), roll_b.spin);
      touch.inverse_inertia = hn::Add(roll_a.inverse_inertia, roll_b.inverse_inertia);
    }
  }
  SpringLanes<V> spring = load_springs<Real, turning>(model, springs, at);
  ForceLanes<V> out = no_force<Real>();
  contact_force<turning>(d, model, law_of(*pass.laws, pairs), touch,
                         hn::Set(d, static_cast<Real>(pass.spring_step)), spring, gap.near, out);
  store_springs<Real, turning>(model, spring, at, springs);
  ForceLanes<V> partner = out;
  if constexpr (turning) {
    if (model.rolling != RollingLaw::none) {
      out.lever = plus_scaled(out.lever, roll_a.inverse_radius, out.torque);
      partner.lever = minus_scaled(partner.lever, roll_b.inverse_radius, out.torque);
    }
  }
  const LoadRows<Real, turning> loads(out);
  for (int k = 0; k < width; ++k) loads.add(k, pass.sum[pairs[k].mine]);
  if constexpr (kind == Kind::inner) {
    const LoadRows<Real, turning> others(partner);
    for (int k = 0; k < width; ++k) others.add_mirrored(k, pass.sum[pairs[k].other]);
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
