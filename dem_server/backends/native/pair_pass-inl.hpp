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
inline constexpr int fetch_ahead = positions == 8 ? 128 : 32;

/// Which of the pairs of a block: inner ones act on both partners, the others on the holder only.
enum class Kind { inner, outer, image };

/// The partners of each lane.
template <class Real, bool turning, int lanes = width<Real>>
struct Partners {
  const Body<Real, turning>* a[lanes];
  const Body<Real, turning>* b[lanes];
};

/// What the places of the partners of a kind of pairs count from.
template <class Real, bool turning, Kind kind>
HWY_INLINE const Body<Real, turning>* theirs(const BlockPass<Real, turning>& pass) {
  return kind == Kind::inner ? pass.own : pass.bodies;
}

/// Fills in the partners of a batch: pair(lane) has their places. (Not a constructor, nor by value:
/// that would copy through memory.)
template <Kind kind, class Real, bool turning, int lanes, class Mine, class Other>
HWY_INLINE void find_partners(const BlockPass<Real, turning>& pass, const Mine& mine,
                              const Other& other, Partners<Real, turning, lanes>& partners) {
  for (int k = 0; k < lanes; ++k) {
    partners.a[k] = pass.own + mine(k);
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

// How the partners stand and move to each other: differences from partner to holder, and in the
// fourth component the sums of radii [m] or of inverse masses [1/kg].

/// Positions and velocities, which follow them in one row if both are doubles.
template <bool turning>
HWY_INLINE Eight<hn::Vec<Positions>> between(const Partners<double, turning>& partners) {
  return combine_long_rows(
      Positions(), [&](int k) { return partners.a[k]->position; },
      [&](int k) { return partners.b[k]->position; }, Flip<double>::difference);
}

/// Positions, of the lanes from `first` on.
template <bool turning, int lanes>
HWY_INLINE Quad<hn::Vec<Positions>> offsets(const Partners<float, turning, lanes>& partners,
                                            int first) {
  return combine_rows(
      Positions(), [&](int k) { return partners.a[first + k]->position; },
      [&](int k) { return partners.b[first + k]->position; }, Flip<double>::difference);
}

/// Sums of the spins.
template <bool turning>
HWY_INLINE void add_spins(const Partners<double, turning>& partners,
                          TouchLanes<hn::Vec<Lanes<double>>>& touch) {
  if constexpr (turning) {
    const auto w = combine_rows(
        Lanes<double>(), [&](int k) { return partners.a[k]->radius_spin; },
        [&](int k) { return partners.b[k]->radius_spin; }, Flip<double>::sum);
    touch.radius_spin = {w.a, w.b, w.c};
  }
}

/// Velocities, and the sums of the spins, which follow them in one row.
template <bool turning>
HWY_INLINE Quad<hn::Vec<Lanes<float>>> add_motion(const Partners<float, turning>& partners,
                                                  TouchLanes<hn::Vec<Lanes<float>>>& touch) {
  const Lanes<float> d;
  const auto first = [&](int k) { return partners.a[k]->velocity; };
  const auto second = [&](int k) { return partners.b[k]->velocity; };
  if constexpr (turning) {
    const auto both = combine_long_rows(d, first, second, Flip<float>::motion);
    touch.radius_spin = {both.high.a, both.high.b, both.high.c};
    return both.low;
  } else {
    return combine_rows(d, first, second, Flip<float>::difference);
  }
}

/// 1/R* from the radii of the holders and the sums.
template <class Real, bool turning>
HWY_INLINE hn::Vec<Lanes<Real>> curvature(const Body<Real, turning>* const* a,
                                          hn::Vec<Lanes<Real>> sum) {
  const Lanes<Real> d;
  alignas(64) Real radius[width<Real>];
  for (int k = 0; k < width<Real>; ++k) radius[k] = static_cast<Real>(a[k]->radius);
  const auto own = hn::Load(d, radius);
  return hn::Div(sum, hn::Mul(own, hn::Sub(sum, own)));
}

// ---- forces ----

/// A batch of close pairs on its way through the three steps.
template <class Real, bool turning>
struct PairBatch {
  using V = hn::Vec<Lanes<Real>>;
  int count;                  // of pairs; the other lanes repeat the last
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
  find_partners<kind>(
      pass, [&](int k) { return batch.mine[k]; }, [&](int k) { return batch.other[k]; }, partners);
  auto& touch = batch.touch;
  Parts<Real, Quad<hn::Vec<Positions>>> apart;
  Quad<hn::Vec<Lanes<Real>>> velocity;
  if constexpr (sizeof(Real) == sizeof(double)) {
    const auto both = between(partners);
    assign(both.low, apart.low);
    assign(both.high, velocity);
    add_spins(partners, touch);
  } else {
    assign(offsets(partners, 0), apart.low);
    if constexpr (in_two_parts<Real>) assign(offsets(partners, positions), apart.high);
    assign(add_motion(partners, touch), velocity);
  }
  touch.velocity = {velocity.a, velocity.b, velocity.c};
  if constexpr (kind == Kind::image) {
    shift(
        pass, [&](int k) { return shifts[batch.place[k]]; }, apart.low);
    if constexpr (in_two_parts<Real>) {
      shift(
          pass, [&](int k) { return shifts[batch.place[positions + k]]; }, apart.high);
    }
  }
  find_gap<Real>(apart, touch);
  if constexpr (!plain) {
    touch.root_mass = root_mass<Real>(pass.root_masses.pair, velocity.d);
  }
  if (needs_curvature(model)) {
    touch.inverse_radius = curvature<Real>(
        partners.a, to_real(apart, [](const auto& part) HWY_ATTR { return part.d; }));
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
  const auto near =
      near_lanes<Real>(batch.touch.overlap, plain ? 0 : pass.beyond_contact, batch.count);
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
                         hn::Set(d, static_cast<Real>(pass.spring_step)), spring, near, out);
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
template <int lanes, class Real, bool turning, class Other>
HWY_INLINE void fetch(const Body<Real, turning>* from, const Other& other) {
  for (int k = 0; k < lanes; ++k) {
    const Body<Real, turning>* partner = from + other(k);
    hwy::Prefetch(partner);
    if constexpr (sizeof(*partner) > 64) hwy::Prefetch(partner->radius_spin);
  }
}

/// The forces of all close pairs of one kind.
template <bool plain, class Real, bool turning, Kind kind, class Place>
HWY_INLINE void pass_pairs(const BlockPass<Real, turning>& pass, const PairList<Place>& pairs,
                           ClosePairs<Real>& close) {
  constexpr int lanes = width<Real>;
  const std::uint8_t* const shifts = pairs.shift.data();
  const std::uint8_t* const laws = pairs.law.data();
  const int count = close.count();
  const int last = std::max(0, count - 1) / lanes * lanes;  // batch
  PairBatch<Real, turning> batches[batches_at_once];
  for (int at = 0; at < count;) {
    int full = 0;
    for (; full < batches_at_once && at < count; ++full, at += lanes) {
      PairBatch<Real, turning>& batch = batches[full];
      batch.count = std::min(lanes, count - at);
      batch.mine = close.mine() + at;
      batch.other = close.other() + at;
      batch.place = close.places() + at;
      batch.springs = close.springs(at);
      const std::int32_t* later = close.other() + std::min(at + fetch_ahead, last);
      fetch<lanes>(theirs<Real, turning, kind>(pass), [&](int k) { return later[k]; });
      // (With fewer lanes the instructions cost more than the fetching gains.)
      if constexpr (kind == Kind::inner && positions == 8) {
        for (int k = 0; k < lanes; ++k) hwy::Prefetch(pass.sum + later[k]);
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
