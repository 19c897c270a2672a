// A batch of contacts in the vector registers: how surfaces stand to each other, which law and
// springs each lane has, and the way of the forces to the particles. For the loops over pairs and
// walls.
#if defined(FLUXPACT_BATCH_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef FLUXPACT_BATCH_INL_
#undef FLUXPACT_BATCH_INL_
#else
#define FLUXPACT_BATCH_INL_
#endif

#include <type_traits>

#include "dem_server/backends/native/contact_force-inl.hpp"
#include "dem_server/backends/native/contact_pass.hpp"
#include "dem_server/backends/native/row_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace fluxpact::HWY_NAMESPACE {

/// Contacts go through the registers in batches of as many as a register holds positions.
using Positions = hn::CappedTag<double, 8>;
inline constexpr int width = lanes_of<Positions>;

template <class Real>
using Lanes = hn::Rebind<Real, Positions>;

/// Signs for combine_rows and combine_long_rows: of each four numbers, the fourth is a sum.
template <class Real>
struct Flip {
  /// Differences.
  alignas(64) static constexpr Real difference[8] = {-Real(0), -Real(0), -Real(0), 0,
                                                     -Real(0), -Real(0), -Real(0), 0};
  /// A difference, then a sum.
  alignas(64) static constexpr Real motion[8] = {-Real(0), -Real(0), -Real(0), 0, 0, 0, 0, 0};
  alignas(64) static constexpr Real sum[8] = {0, 0, 0, 0, 0, 0, 0, 0};
};

template <class Real>
HWY_INLINE auto to_real(hn::Vec<Positions> v) {
  if constexpr (sizeof(Real) == sizeof(double)) {
    return v;
  } else {
    return hn::DemoteTo(Lanes<Real>(), v);
  }
}

/// How the surfaces of a batch stand to each other: normal and overlap, from the vector between the
/// centres and the sum R of the radii. In float the overlap is (R² - d²)/(R + d) with the numerator
/// in double, since the difference of two lengths would keep few digits.
template <class Real>
HWY_INLINE void find_gap(const Quad<hn::Vec<Positions>>& apart,
                         TouchLanes<hn::Vec<Lanes<Real>>>& touch) {
  const Lanes<Real> d;
  const auto radii = apart.d;
  const auto square =
      hn::MulAdd(apart.a, apart.a, hn::MulAdd(apart.b, apart.b, hn::Mul(apart.c, apart.c)));
  const auto distance = hn::Sqrt(to_real<Real>(square));
  const auto inverse = hn::Div(hn::Set(d, 1), distance);
  if constexpr (sizeof(Real) == sizeof(double)) {
    touch.overlap = hn::Sub(radii, distance);
  } else {
    const auto difference = to_real<Real>(hn::MulSub(radii, radii, square));
    touch.overlap = hn::Div(difference, hn::Add(to_real<Real>(radii), distance));
  }
  // (Number by number: a copy of all three would go through memory by halves.)
  touch.normal.x = hn::Mul(to_real<Real>(apart.a), inverse);
  touch.normal.y = hn::Mul(to_real<Real>(apart.b), inverse);
  touch.normal.z = hn::Mul(to_real<Real>(apart.c), inverse);
}

/// The law of each lane, by index_of(lane).
template <class Real, class IndexOf>
HWY_INLINE LawLanes<hn::Vec<Lanes<Real>>> law_of(const LawTable<Real>& table,
                                                 const IndexOf& index_of) {
  const Lanes<Real> d;
  if (table.one_law) return load_law(d, table, table.any);
  const hn::RebindToSigned<decltype(d)> integers;
  alignas(64) hn::TFromD<decltype(integers)> index[width];
  for (int k = 0; k < width; ++k) index[k] = index_of(k);
  return load_law(d, table, hn::Load(integers, index));
}

/// Root of the effective mass [kg^0.5]: what holds for all contacts, if that is known, else from
/// the sum of the inverse masses.
template <class Real>
HWY_INLINE hn::Vec<Lanes<Real>> root_mass(double known, hn::Vec<Lanes<Real>> inverse_mass) {
  const Lanes<Real> d;
  if (known > 0) return hn::Set(d, static_cast<Real>(known));
  return hn::Sqrt(hn::Div(hn::Set(d, 1), inverse_mass));
}

/// Loads of a batch, one row of `Load` a lane, on their way to the sums of the particles.
///
/// What the partner gets (`mirrored`) is the opposite force, but an equal lever force, since the
/// arm points the other way as well.
template <class Real, bool turning>
class StoredRows {
 public:
  HWY_INLINE explicit StoredRows(const ForceLanes<hn::Vec<Lanes<Real>>>& from) {
    const Lanes<Real> d;
    const auto zero = hn::Zero(d);
    using Rows = Quad<hn::Vec<Lanes<Real>>>;
    scatter_rows(d, Rows{from.force.x, from.force.y, from.force.z, zero}, width,
                 [&](int k) { return row_[k]; });
    if constexpr (turning) {
      scatter_rows(d, Rows{from.lever.x, from.lever.y, from.lever.z, zero}, width,
                   [&](int k) { return row_[k] + 4; });
    }
  }
  /// To the places of all lanes, one after the other.
  template <class Place>
  HWY_INLINE void add_to(Load<Real, turning>* sum, const Place& place) const {
    for (int k = 0; k < width; ++k) add_lane<false>(k, sum[place(k)]);
  }
  /// The same to the holders of pairs, and `theirs` to their partners: pair after pair, so that
  /// the order of the sums does not hang on which pairs are in a batch.
  template <class Holder, class Partner>
  HWY_INLINE void add_to(Load<Real, turning>* sum, const Holder& holder, const StoredRows& theirs,
                         const Partner& partner) const {
    for (int k = 0; k < width; ++k) {
      add_lane<false>(k, sum[holder(k)]);
      theirs.template add_lane<true>(k, sum[partner(k)]);
    }
  }

 private:
  template <bool mirrored>
  HWY_INLINE void add_lane(int k, Load<Real, turning>& to) const {
    add_row<mirrored>(row_[k], to.force);
    if constexpr (turning) add_row<false>(row_[k] + 4, to.lever);
  }

  static constexpr int numbers = turning ? 8 : 4;
  alignas(64) Real row_[width][numbers];
};

/// The same where a register holds a whole row: the rows never go through memory.
template <class Real>
class RegisterRows {
 public:
  HWY_INLINE explicit RegisterRows(const ForceLanes<hn::Vec<Lanes<Real>>>& from) {
    const Lanes<Real> d;
    const auto zero = hn::Zero(d);
    rows_ = transpose(d, Eight<V>{{from.force.x, from.force.y, from.force.z, zero},
                                  {from.lever.x, from.lever.y, from.lever.z, zero}});
  }
  template <class Place>
  HWY_INLINE void add_to(Load<Real, true>* sum, const Place& place) const {
    visit([&](auto row, int k) HWY_ATTR { add(row(*this), sum[place(k)]); });
  }
  template <class Holder, class Partner>
  HWY_INLINE void add_to(Load<Real, true>* sum, const Holder& holder, const RegisterRows& theirs,
                         const Partner& partner) const {
    const auto mirror = hn::Load(Lanes<Real>(), Flip<Real>::motion);
    visit([&](auto row, int k) HWY_ATTR {
      add(row(*this), sum[holder(k)]);
      add(hn::Xor(row(theirs), mirror), sum[partner(k)]);
    });
  }

 private:
  using V = hn::Vec<Lanes<Real>>;
  static HWY_INLINE void add(V row, Load<Real, true>& to) {
    const Lanes<Real> d;
    hn::Store(hn::Add(hn::Load(d, to.force), row), d, to.force);
  }
  /// visit(row of some rows, lane)
  template <class Visit>
  static HWY_INLINE void visit(const Visit& visit) {
    visit([](const RegisterRows& r) HWY_ATTR { return r.rows_.low.a; }, 0);
    visit([](const RegisterRows& r) HWY_ATTR { return r.rows_.low.b; }, 1);
    visit([](const RegisterRows& r) HWY_ATTR { return r.rows_.low.c; }, 2);
    visit([](const RegisterRows& r) HWY_ATTR { return r.rows_.low.d; }, 3);
    visit([](const RegisterRows& r) HWY_ATTR { return r.rows_.high.a; }, 4);
    visit([](const RegisterRows& r) HWY_ATTR { return r.rows_.high.b; }, 5);
    visit([](const RegisterRows& r) HWY_ATTR { return r.rows_.high.c; }, 6);
    visit([](const RegisterRows& r) HWY_ATTR { return r.rows_.high.d; }, 7);
  }
  Eight<V> rows_;
};

template <class Real, bool turning>
using LoadRows =
    std::conditional_t<turning && width == 8, RegisterRows<Real>, StoredRows<Real, turning>>;

/// The springs of a batch, those of each lane at `springs`.
template <class Real>
HWY_INLINE SpringLanes<hn::Vec<Lanes<Real>>> load_springs(const ContactModel& model,
                                                          const SpringRow<Real>* const* springs) {
  const Lanes<Real> d;
  const auto zero = hn::Zero(d);
  const int rows = spring_rows(model);
  SpringLanes<hn::Vec<Lanes<Real>>> lanes{{zero, zero, zero}, {zero, zero, zero}, zero};
  if (rows == 0) return lanes;
  const auto first = gather_rows(d, [&](int k) { return springs[k][0].number; });
  lanes.tangential = {first.a, first.b, first.c};
  lanes.bridge = first.d;
  if (rows == 1) return lanes;
  const auto second = gather_rows(d, [&](int k) { return springs[k][1].number; });
  lanes.rolling = {second.a, second.b, second.c};
  return lanes;
}

/// Back to the rows of the first `count` lanes.
template <class Real>
HWY_INLINE void store_springs(const ContactModel& model,
                              const SpringLanes<hn::Vec<Lanes<Real>>>& lanes, int count,
                              SpringRow<Real>* const* springs) {
  using V = hn::Vec<Lanes<Real>>;
  const Lanes<Real> d;
  const int rows = spring_rows(model);
  if (rows == 0) return;
  const Lanes3<V>& t = lanes.tangential;
  scatter_rows(d, Quad<V>{t.x, t.y, t.z, lanes.bridge}, count,
               [&](int k) { return springs[k][0].number; });
  if (rows == 1) return;
  const Lanes3<V>& r = lanes.rolling;
  scatter_rows(d, Quad<V>{r.x, r.y, r.z, hn::Zero(d)}, count,
               [&](int k) { return springs[k][1].number; });
}

/// True if the force depends on the radii apart from the overlap.
HWY_INLINE bool needs_curvature(const ContactModel& model) {
  return model.law != ContactLaw::linear || model.rolling != RollingLaw::none ||
         model.cohesion != CohesionLaw::none || model.film;
}

/// Spin and moment of inertia, which only rolling asks for: of the particle, and of its partner.
template <class Real>
struct RollLanes {
  using V = hn::Vec<Lanes<Real>>;
  Lanes3<V> spin;     // [rad/s]
  V inverse_radius;   // [1/m]
  V inverse_inertia;  // [1/(kg m²)] 1/(m r²)
};

// Nothing yet: what the model does not ask for stays so, at no cost.
template <class Real>
HWY_INLINE TouchLanes<hn::Vec<Lanes<Real>>> no_touch() {
  const auto zero = hn::Zero(Lanes<Real>());
  const Lanes3<hn::Vec<Lanes<Real>>> none{zero, zero, zero};
  return {none, zero, none, none, none, zero, zero, zero};
}
template <class Real>
HWY_INLINE ForceLanes<hn::Vec<Lanes<Real>>> no_force() {
  const auto zero = hn::Zero(Lanes<Real>());
  const Lanes3<hn::Vec<Lanes<Real>>> none{zero, zero, zero};
  return {none, none, none};
}
template <class Real>
HWY_INLINE RollLanes<Real> no_roll() {
  const auto zero = hn::Zero(Lanes<Real>());
  return {{zero, zero, zero}, zero, zero};
}

template <class Real>
HWY_INLINE RollLanes<Real> gather_roll(const Body<Real, true>* const* bodies) {
  const Lanes<Real> d;
  const auto w = gather_rows(d, [&](int k) { return bodies[k]->radius_spin; });
  const auto v = gather_rows(d, [&](int k) { return bodies[k]->velocity; });
  return {scaled(Lanes3<hn::Vec<Lanes<Real>>>{w.a, w.b, w.c}, w.d), w.d,
          hn::Mul(v.d, hn::Mul(w.d, w.d))};
}

}  // namespace fluxpact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
