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

/// Contacts go through the registers in batches of as many numbers as one holds.
template <class Real>
using Lanes = hn::CappedTag<Real, 64 / sizeof(Real)>;
template <class Real>
inline constexpr int width = lanes_of<Lanes<Real>>;

/// Positions are doubles, whatever the rest is.
using Positions = Lanes<double>;
inline constexpr int positions = width<double>;

/// Where the other numbers of a batch are Real, its positions need two registers: so it is with
/// floats, unless vectors have one lane.
template <class Real>
inline constexpr bool in_two_parts = width<Real> == 2 * positions;

/// What is found from the positions of a batch: of all lanes, or of the first `positions` lanes and
/// the others.
template <class Real, class T, bool two = in_two_parts<Real>>
struct Parts {
  T low;
};
template <class Real, class T>
struct Parts<Real, T, true> {
  T low, high;
};

/// of(first lane) of each part.
template <class Real, class Of>
HWY_INLINE auto parts_of(const Of& of) -> Parts<Real, decltype(of(0))> {
  if constexpr (in_two_parts<Real>) {
    return {of(0), of(positions)};
  } else {
    return {of(0)};
  }
}

/// of(part) of all parts, in one register.
template <class Real, class T, class Of>
HWY_INLINE hn::Vec<Lanes<Real>> to_real(const Parts<Real, T>& parts, const Of& of) {
  const Lanes<Real> d;
  if constexpr (sizeof(Real) == sizeof(double)) {
    return of(parts.low);
  } else if constexpr (!in_two_parts<Real>) {
    return hn::DemoteTo(d, of(parts.low));
  } else {
#if HWY_MAX_BYTES >= 16
    const hn::Half<Lanes<Real>> half;
    return hn::Combine(d, hn::DemoteTo(half, of(parts.high)), hn::DemoteTo(half, of(parts.low)));
#endif
  }
}
template <class Real>
HWY_INLINE hn::Vec<Lanes<Real>> to_real(const Parts<Real, hn::Vec<Positions>>& parts) {
  return to_real(parts, [](hn::Vec<Positions> part) HWY_ATTR { return part; });
}

/// The three components, each in one register.
template <class Real>
HWY_INLINE Lanes3<hn::Vec<Lanes<Real>>> vectors_of(
    const Parts<Real, Quad<hn::Vec<Positions>>>& parts) {
  using Part = Quad<hn::Vec<Positions>>;
  return {to_real(parts, [](const Part& part) HWY_ATTR { return part.a; }),
          to_real(parts, [](const Part& part) HWY_ATTR { return part.b; }),
          to_real(parts, [](const Part& part) HWY_ATTR { return part.c; })};
}

/// Signs for combine_rows and combine_long_rows: of each four numbers, the fourth is a sum.
template <class Real>
struct Flip {
  /// Differences.
  alignas(64) static constexpr Real difference[16] = {
      -Real(0), -Real(0), -Real(0), 0, -Real(0), -Real(0), -Real(0), 0,
      -Real(0), -Real(0), -Real(0), 0, -Real(0), -Real(0), -Real(0), 0};
  /// A difference, then a sum.
  alignas(64) static constexpr Real motion[16] = {-Real(0), -Real(0), -Real(0), 0, 0, 0, 0, 0,
                                                  -Real(0), -Real(0), -Real(0), 0, 0, 0, 0, 0};
  alignas(64) static constexpr Real sum[16] = {};
};

template <class V>
HWY_INLINE V square_of(const Quad<V>& apart) {
  return hn::MulAdd(apart.a, apart.a, hn::MulAdd(apart.b, apart.b, hn::Mul(apart.c, apart.c)));
}

/// How the surfaces of a batch stand to each other: normal and overlap, from the vector between the
/// centres and the sum R of the radii. In float the overlap is (R² - d²)/(R + d) with the numerator
/// in double, since the difference of two lengths would keep few digits.
template <class Real>
HWY_INLINE void find_gap(const Parts<Real, Quad<hn::Vec<Positions>>>& apart,
                         TouchLanes<hn::Vec<Lanes<Real>>>& touch) {
  using Part = Quad<hn::Vec<Positions>>;
  const Lanes<Real> d;
  const auto radii = to_real(apart, [](const Part& part) HWY_ATTR { return part.d; });
  const auto square = to_real(apart, [](const Part& part) HWY_ATTR { return square_of(part); });
  const auto distance = hn::Sqrt(square);
  const auto inverse = hn::Div(hn::Set(d, 1), distance);
  if constexpr (sizeof(Real) == sizeof(double)) {
    touch.overlap = hn::Sub(radii, distance);
  } else {
    const auto difference = to_real(apart, [](const Part& part) HWY_ATTR {
      return hn::MulSub(part.d, part.d, square_of(part));
    });
    touch.overlap = hn::Div(difference, hn::Add(radii, distance));
  }
  // (Number by number: a copy of all three would go through memory by halves.)
  const auto vector = vectors_of(apart);
  touch.normal.x = hn::Mul(vector.x, inverse);
  touch.normal.y = hn::Mul(vector.y, inverse);
  touch.normal.z = hn::Mul(vector.z, inverse);
}

/// The first `count` lanes whose surfaces touch or are no further apart than the law reaches,
/// `beyond_contact` [m].
template <class Real>
HWY_INLINE auto near_lanes(hn::Vec<Lanes<Real>> overlap, double beyond_contact, int count) {
  const Lanes<Real> d;
  return hn::And(hn::FirstN(d, count),
                 hn::Gt(overlap, hn::Set(d, static_cast<Real>(-beyond_contact))));
}

/// The law of each lane, by index_of(lane).
template <class Real, class IndexOf>
HWY_INLINE LawLanes<hn::Vec<Lanes<Real>>> law_of(const LawTable<Real>& table,
                                                 const IndexOf& index_of) {
  const Lanes<Real> d;
  if (table.one_law) return load_law(d, table, table.any);
  const hn::RebindToSigned<decltype(d)> integers;
  alignas(64) hn::TFromD<decltype(integers)> index[width<Real>];
  for (int k = 0; k < width<Real>; ++k) index[k] = index_of(k);
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
    scatter_rows(d, Rows{from.force.x, from.force.y, from.force.z, zero}, width<Real>,
                 [&](int k) { return row_[k]; });
    if constexpr (turning) {
      scatter_rows(d, Rows{from.lever.x, from.lever.y, from.lever.z, zero}, width<Real>,
                   [&](int k) { return row_[k] + 4; });
    }
  }
  /// To the places of all lanes, one after the other.
  template <class Place>
  HWY_INLINE void add_to(Load<Real, turning>* sum, const Place& place) const {
    for (int k = 0; k < width<Real>; ++k) add_lane<false>(k, sum[place(k)]);
  }
  /// The same to the holders of pairs, and `theirs` to their partners: pair after pair, so that
  /// the order of the sums does not hang on which pairs are in a batch.
  template <class Holder, class Partner>
  HWY_INLINE void add_to(Load<Real, turning>* sum, const Holder& holder, const StoredRows& theirs,
                         const Partner& partner) const {
    for (int k = 0; k < width<Real>; ++k) {
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
  alignas(64) Real row_[width<Real>][numbers];
};

#if HWY_MAX_BYTES >= 32

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
    const auto mirror = hn::Load(Row(), Flip<Real>::motion);
    visit([&](auto row, int k) HWY_ATTR {
      add(row(*this), sum[holder(k)]);
      add(hn::Xor(row(theirs), mirror), sum[partner(k)]);
    });
  }

 private:
  using V = hn::Vec<Lanes<Real>>;
  using Row = hn::CappedTag<Real, 8>;  // a row of Load
  static HWY_INLINE void add(hn::Vec<Row> row, Load<Real, true>& to) {
    const Row d;
    hn::Store(hn::Add(hn::Load(d, to.force), row), d, to.force);
  }
  /// Of the one or two rows of a register.
  template <bool second>
  static HWY_INLINE hn::Vec<Row> row_of(V rows) {
    if constexpr (width<Real> == 8) {
      return rows;
    } else if constexpr (second) {
      return hn::UpperHalf(Row(), rows);
    } else {
      return hn::LowerHalf(Row(), rows);
    }
  }
  /// visit(row of some rows, lane), lane by lane.
  template <class Visit>
  static HWY_INLINE void visit(const Visit& visit) {
    visit_eight<false>(visit);
    if constexpr (width<Real> == 16) visit_eight<true>(visit);
  }
  template <bool second, class Visit>
  static HWY_INLINE void visit_eight(const Visit& visit) {
    constexpr int from = second ? 8 : 0;
    visit([](const RegisterRows& r) HWY_ATTR { return row_of<second>(r.rows_.low.a); }, from);
    visit([](const RegisterRows& r) HWY_ATTR { return row_of<second>(r.rows_.low.b); }, from + 1);
    visit([](const RegisterRows& r) HWY_ATTR { return row_of<second>(r.rows_.low.c); }, from + 2);
    visit([](const RegisterRows& r) HWY_ATTR { return row_of<second>(r.rows_.low.d); }, from + 3);
    visit([](const RegisterRows& r) HWY_ATTR { return row_of<second>(r.rows_.high.a); }, from + 4);
    visit([](const RegisterRows& r) HWY_ATTR { return row_of<second>(r.rows_.high.b); }, from + 5);
    visit([](const RegisterRows& r) HWY_ATTR { return row_of<second>(r.rows_.high.c); }, from + 6);
    visit([](const RegisterRows& r) HWY_ATTR { return row_of<second>(r.rows_.high.d); }, from + 7);
  }
  Eight<V> rows_;
};

#else
template <class Real>
using RegisterRows = StoredRows<Real, true>;
#endif

template <class Real, bool turning>
using LoadRows = std::conditional_t<turning && holds_long_rows<Lanes<Real>>, RegisterRows<Real>,
                                    StoredRows<Real, turning>>;

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
