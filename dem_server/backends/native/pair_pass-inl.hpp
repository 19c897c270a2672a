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
inline constexpr int fetch_ahead = width == 8 ? 128 : 32;

/// Which of the pairs of a block: inner ones act on both partners, the others on the holder only.
enum class Kind { inner, outer, image };

/// The partners of each lane.
template <class Real, bool turning>
struct Partners {
  const Body<Real, turning>* a[width];
  const Body<Real, turning>* b[width];
};

/// What the places of the partners of a kind of pairs count from.
template <class Real, bool turning, Kind kind>
HWY_INLINE const Body<Real, turning>* theirs(const BlockPass<Real, turning>& pass) {
  return kind == Kind::inner ? pass.bodies + pass.first : pass.bodies;
}

/// Fills in the partners of a batch: pair(lane) has their places. (Not a constructor, nor by value:
/// that would copy through memory.)
template <class Real, bool turning, Kind kind, class Mine, class Other>
HWY_INLINE void find_partners(const BlockPass<Real, turning>& pass, const Mine& mine,
                              const Other& other, Partners<Real, turning>& partners) {
  for (int k = 0; k < width; ++k) {
    partners.a[k] = pass.bodies + pass.first + mine(k);
    partners.b[k] = theirs<Real, turning, kind>(pass) + other(k);
  }
}

/// The partners to where their images are; code(lane) tells where.
template <class Real, bool turning, class Code>
HWY_INLINE void shift(const BlockPass<Real, turning>& pass, const Code& code,
                      Quad<hn::Vec<Positions>>& apart) {
  const auto by = gather_rows(Positions(), [&](int k) { return pass.shifts[code(k)]; });
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

template <class Real, bool turning>
HWY_INLINE Relative<Real> between(const Partners<Real, turning>& partners) {
  const Positions d;
  const auto first = [&](int k) { return partners.a[k]->position; };
  const auto second = [&](int k) { return partners.b[k]->position; };
  if constexpr (sizeof(Real) == sizeof(double)) {  // velocities follow positions in one row
    const auto both = combine_long_rows(d, first, second, Flip<double>::difference);
    return {both.low, both.high};
  } else {
    Relative<Real> relative;
    relative.apart = combine_rows(d, first, second, Flip<double>::difference);
    return relative;
  }
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

template <class V>
HWY_INLINE V square_of(const Quad<V>& apart) {
  return hn::MulAdd(apart.a, apart.a, hn::MulAdd(apart.b, apart.b, hn::Mul(apart.c, apart.c)));
}

/// Bits of the first `count` lanes where it holds.
template <class M>
HWY_INLINE unsigned bits_of(M holds, int count) {
  const Positions d;
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, hn::And(holds, hn::FirstN(d, count)), bytes);
  return bytes[0];
}

// ---- forces ----

/// A batch of close pairs on its way through the three steps.
template <class Real, bool turning>
struct PairBatch {
  using V = hn::Vec<Lanes<Real>>;
  int count;                  // of pairs; the other lanes repeat the last
  unsigned near;              // bits of those that touch or are within the reach of the law
  const std::uint16_t* mine;  // places of the partners
  const std::int32_t* other;
  const std::int32_t* place;  // in the list
  Real* springs;
  TouchLanes<V> touch;
  RollLanes<Real> roll_a, roll_b;  // with a rolling law
  ForceLanes<V> out;
};

/// Many batches go through each step before the next: the chain of operations in one batch is long,
/// and the processor can only look ahead into another if the steps are short.
inline constexpr int batches_at_once = 4;

/// The springs of a batch, number by number (SpringNumbers).
template <class Real>
HWY_INLINE SpringLanes<hn::Vec<Lanes<Real>>> load_pair_springs(const ContactModel& model,
                                                               const Real* springs) {
  constexpr int apart = ClosePairs<Real>::batch_size;
  const Lanes<Real> d;
  const auto zero = hn::Zero(d);
  SpringLanes<hn::Vec<Lanes<Real>>> lanes{{zero, zero, zero}, {zero, zero, zero}, zero};
  const auto next = [&]() HWY_ATTR {
    const Real* number = springs;
    springs += apart;
    return hn::Load(d, number);
  };
  if (model.friction) lanes.tangential = {next(), next(), next()};
  if (outlasts_touch(model.cohesion)) lanes.bridge = next();
  if (model.rolling == RollingLaw::spring_dashpot) lanes.rolling = {next(), next(), next()};
  return lanes;
}
template <class Real>
HWY_INLINE void store_pair_springs(const ContactModel& model,
                                   const SpringLanes<hn::Vec<Lanes<Real>>>& lanes, Real* springs) {
  constexpr int apart = ClosePairs<Real>::batch_size;
  const Lanes<Real> d;
  const auto put = [&](hn::Vec<Lanes<Real>> number) HWY_ATTR {
    hn::Store(number, d, springs);
    springs += apart;
  };
  const auto put_vector = [&](const Lanes3<hn::Vec<Lanes<Real>>>& vector) HWY_ATTR {
    put(vector.x);
    put(vector.y);
    put(vector.z);
  };
  if (model.friction) put_vector(lanes.tangential);
  if (outlasts_touch(model.cohesion)) put(lanes.bridge);
  if (model.rolling == RollingLaw::spring_dashpot) put_vector(lanes.rolling);
}

/// The commonest law, known to the compiler (`plain`): linear springs and dashpots with friction,
/// the same for all pairs, and one effective mass. The branches that other laws need are not there.
inline constexpr ContactModel plain_model{ContactLaw::linear, RollingLaw::none, CohesionLaw::none,
                                          false, true};

template <class Real>
HWY_INLINE bool is_plain(const BlockPass<Real, true>& pass) {
  const ContactModel& model = pass.laws->model;
  return model.law == ContactLaw::linear && model.rolling == RollingLaw::none &&
         model.cohesion == CohesionLaw::none && !model.film && model.friction &&
         pass.laws->one_law && pass.root_masses.pair > 0;
}

template <bool plain, class Real, bool turning>
HWY_INLINE const ContactModel& model_of(const BlockPass<Real, turning>& pass) {
  if constexpr (plain) {
    return plain_model;
  } else {
    return pass.laws->model;
  }
}

/// First step: how the partners stand and move to each other. `shifts`: of the pairs of the list.
template <bool plain, class Real, bool turning, Kind kind>
FLUXPACT_CONTACT_STEP void approach(const BlockPass<Real, turning>& pass,
                                    const std::uint8_t* shifts, PairBatch<Real, turning>& batch) {
  const ContactModel& model = model_of<plain>(pass);
  Partners<Real, turning> partners;
  find_partners<Real, turning, kind>(
      pass, [&](int k) { return batch.mine[k]; }, [&](int k) { return batch.other[k]; }, partners);
  auto relative = between<Real, turning>(partners);
  if constexpr (kind == Kind::image) {
    shift(
        pass, [&](int k) { return shifts[batch.place[k]]; }, relative.apart);
  }
  const Positions dp;
  const auto reach = hn::Add(relative.apart.d, hn::Set(dp, pass.beyond_contact));
  batch.near = bits_of(hn::Lt(square_of(relative.apart), hn::Mul(reach, reach)), batch.count);
  auto& touch = batch.touch;
  find_gap<Real>(relative.apart, touch);
  add_motion(partners, relative.velocity, touch);
  if constexpr (!plain) {
    touch.root_mass = root_mass<Real>(pass.root_masses.pair, relative.velocity.d);
  }
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

/// Second step: springs and forces. `laws`: of the pairs of the list, unless all have the same.
template <bool plain, class Real, bool turning>
FLUXPACT_CONTACT_STEP void respond(const BlockPass<Real, turning>& pass, const std::uint8_t* laws,
                                   PairBatch<Real, turning>& batch) {
  const Lanes<Real> d;
  const ContactModel& model = model_of<plain>(pass);
  auto spring = load_pair_springs<Real>(model, batch.springs);
  auto out = no_force<Real>();
  const std::uint8_t bits[8] = {static_cast<std::uint8_t>(batch.near)};
  LawLanes<hn::Vec<Lanes<Real>>> law;
  if constexpr (plain) {
    law = load_columns(d, model, [&](LawColumn name) HWY_ATTR {
      return hn::Set(d, pass.laws->column(name)[pass.laws->any]);
    });
    batch.touch.root_mass = hn::Set(d, static_cast<Real>(pass.root_masses.pair));
  } else {
    law = law_of(*pass.laws, [&](int k) { return laws[batch.place[k]]; });
  }
  contact_force<turning>(d, model, law, batch.touch,
                         hn::Set(d, static_cast<Real>(pass.spring_step)), spring,
                         hn::LoadMaskBits(d, bits), out);
  store_pair_springs<Real>(model, spring, batch.springs);
  batch.out.force = out.force;
  if constexpr (turning) {
    batch.out.lever = out.lever;
    if (model.rolling != RollingLaw::none) batch.out.torque = out.torque;
  }
}

/// Third step: to the sums of the particles.
template <bool plain, class Real, bool turning, Kind kind>
FLUXPACT_CONTACT_STEP void hand_over(const BlockPass<Real, turning>& pass,
                                     const PairBatch<Real, turning>& batch) {
  const auto holder = [&](int k) { return batch.mine[k]; };
  const auto partner = [&](int k) { return batch.other[k]; };
  if constexpr (turning) {
    if (model_of<plain>(pass).rolling != RollingLaw::none) {
      ForceLanes<hn::Vec<Lanes<Real>>> own = batch.out;
      own.lever = plus_scaled(own.lever, batch.roll_a.inverse_radius, own.torque);
      const LoadRows<Real, turning> rows(own);
      if constexpr (kind == Kind::inner) {
        own.lever = minus_scaled(batch.out.lever, batch.roll_b.inverse_radius, own.torque);
        rows.add_to(pass.sum, holder, LoadRows<Real, turning>(own), partner);
      } else {
        rows.add_to(pass.sum, holder);
      }
      return;
    }
  }
  const LoadRows<Real, turning> rows(batch.out);
  if constexpr (kind == Kind::inner) {
    rows.add_to(pass.sum, holder, rows, partner);
  } else {
    rows.add_to(pass.sum, holder);
  }
}

/// Partners of a batch that comes later.
template <class Real, bool turning, class Other>
HWY_INLINE void fetch(const Body<Real, turning>* from, const Other& other) {
  for (int k = 0; k < width; ++k) {
    const Body<Real, turning>* partner = from + other(k);
    hwy::Prefetch(partner);
    if constexpr (sizeof(*partner) > 64) hwy::Prefetch(partner->radius_spin);
  }
}

/// The forces of all close pairs of one kind.
template <bool plain, class Real, bool turning, Kind kind, class Place>
HWY_INLINE void pass_pairs(const BlockPass<Real, turning>& pass, const PairList<Place>& pairs,
                           ClosePairs<Real>& close) {
  constexpr int batch_size = ClosePairs<Real>::batch_size;
  const std::uint8_t* const shifts = pairs.shift.data();
  const std::uint8_t* const laws = pairs.law.data();
  const int count = close.count();
  const int ahead_most = std::max(0, count - 1) / width * width;
  PairBatch<Real, turning> batches[batches_at_once];
  for (int at = 0; at < count;) {
    int full = 0;
    for (; full < batches_at_once && at < count; ++full, at += width) {
      PairBatch<Real, turning>& batch = batches[full];
      const int b = at / batch_size;
      const int lane = at % batch_size;
      batch.count = std::min(width, count - at);
      batch.mine = close.batch(b).mine + lane;
      batch.other = close.batch(b).other + lane;
      batch.place = close.places(b) + lane;
      batch.springs = close.springs(b) + lane;
      const int ahead = std::min(at + fetch_ahead, ahead_most);
      const std::int32_t* later = close.batch(ahead / batch_size).other + ahead % batch_size;
      fetch(theirs<Real, turning, kind>(pass), [&](int k) { return later[k]; });
      // (With fewer lanes the instructions cost more than the fetching gains.)
      if constexpr (kind == Kind::inner && width == 8) {
        for (int k = 0; k < width; ++k) hwy::Prefetch(pass.sum + later[k]);
      }
    }
    for (int b = 0; b < full; ++b) approach<plain, Real, turning, kind>(pass, shifts, batches[b]);
    for (int b = 0; b < full; ++b) respond<plain, Real, turning>(pass, laws, batches[b]);
    for (int b = 0; b < full; ++b) hand_over<plain, Real, turning, kind>(pass, batches[b]);
  }
}

}  // namespace fluxpact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
