#include "dem_server/backends/native/contact_pass.hpp"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dem_server/backends/native/contact_pass.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "dem_server/backends/native/contact_force-inl.hpp"
#include "dem_server/backends/native/row_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace fluxpact::HWY_NAMESPACE {

/// Contacts go through the registers in batches of as many as a register holds positions.
using Positions = hn::CappedTag<double, 8>;
inline constexpr int width = lanes_of<Positions>;
/// Partners are fetched this many pairs ahead: their rows lie anywhere in the block, or beyond it.
inline constexpr int fetch_ahead = 64;

template <class Real>
using Lanes = hn::Rebind<Real, Positions>;

/// Which of the pairs of a block: inner ones act on both partners, the others on the holder only.
enum class Kind { inner, outer, image };

/// Signs for combine_rows: the first three numbers are differences, the fourth is a sum.
template <class Real>
struct Flip {
  alignas(64) static constexpr Real difference[8] = {-Real(0), -Real(0), -Real(0), 0,
                                                     -Real(0), -Real(0), -Real(0), 0};
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

/// How the surfaces of a batch stand to each other; lanes that are not near hold nothing of use.
template <class Real>
struct Gap {
  using V = hn::Vec<Lanes<Real>>;
  Lanes3<V> normal;
  V overlap;                   // [m]; negative where the surfaces are apart
  hn::Mask<Lanes<Real>> near;  // within the reach of the law
};

/// From the vector between the centres and the sum R of the radii. In float the overlap is
/// (R² - d²)/(R + d) with the numerator in double, since the difference of two lengths would keep
/// few digits.
template <class Real>
HWY_INLINE Gap<Real> gap_between(const Quad<hn::Vec<Positions>>& apart, double beyond_contact,
                                 int count) {
  const Lanes<Real> d;
  const auto radii = apart.d;
  const auto square =
      hn::MulAdd(apart.a, apart.a, hn::MulAdd(apart.b, apart.b, hn::Mul(apart.c, apart.c)));
  const auto difference = to_real<Real>(hn::MulSub(radii, radii, square));
  const auto distance = hn::Sqrt(to_real<Real>(square));
  const auto inverse = hn::Div(hn::Set(d, 1), distance);
  Gap<Real> gap;
  if constexpr (sizeof(Real) == sizeof(double)) {
    gap.overlap = hn::Sub(radii, distance);
  } else {
    gap.overlap = hn::Div(difference, hn::Add(to_real<Real>(radii), distance));
  }
  gap.near = hn::FirstN(d, count);
  if (beyond_contact == 0) {
    gap.near = hn::And(gap.near, hn::Gt(difference, hn::Zero(d)));
  } else {
    const auto reach = hn::Set(d, static_cast<Real>(-beyond_contact));
    gap.near = hn::And(gap.near, hn::Gt(gap.overlap, reach));
  }
  gap.normal = {hn::Mul(to_real<Real>(apart.a), inverse), hn::Mul(to_real<Real>(apart.b), inverse),
                hn::Mul(to_real<Real>(apart.c), inverse)};
  return gap;
}

/// The law of each lane.
template <class Real, class Contact>
HWY_INLINE LawLanes<hn::Vec<Lanes<Real>>> law_of(const LawTable<Real>& table,
                                                 const Contact* contacts) {
  const Lanes<Real> d;
  if (table.one_law) return load_law(d, table, table.any);
  const hn::RebindToSigned<decltype(d)> integers;
  alignas(64) hn::TFromD<decltype(integers)> index[width];
  for (int k = 0; k < width; ++k) index[k] = contacts[k].law;
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

/// Loads of a batch, one row of `Load` a lane.
template <class Real, bool turning>
struct LoadRows {
  static constexpr int numbers = turning ? 8 : 4;
  alignas(64) Real row[width][numbers];

  HWY_INLINE explicit LoadRows(const ForceLanes<hn::Vec<Lanes<Real>>>& from) {
    const Lanes<Real> d;
    store_rows<numbers>(d, from.force.x, from.force.y, from.force.z, &row[0][0]);
    if constexpr (turning) {
      store_rows<numbers>(d, from.lever.x, from.lever.y, from.lever.z, &row[0][4]);
    }
  }
  HWY_INLINE void add(int lane, Load<Real, turning>& to) const {
    add_row<numbers, false>(row[lane], to.force);
  }
  /// What the partner gets: the opposite force, but an equal lever force, since the arm points the
  /// other way as well.
  HWY_INLINE void add_mirrored(int lane, Load<Real, turning>& to) const {
    add_row<numbers, true>(row[lane], to.force);
  }
};

/// The rows of the springs that a model has: which they are.
struct SpringRows {
  int rolling = -1;
  int bridge = -1;
};

template <bool turning>
HWY_INLINE SpringRows spring_rows(const ContactModel& model) {
  SpringRows rows;
  int next = turning ? 3 : 0;
  if (model.rolling == RollingLaw::spring_dashpot) {
    rows.rolling = next;
    next += 3;
  }
  if (model.cohesion == CohesionLaw::liquid_bridge || model.cohesion == CohesionLaw::jkr) {
    rows.bridge = next;
  }
  return rows;
}

template <class Real, bool turning>
HWY_INLINE SpringLanes<hn::Vec<Lanes<Real>>> load_springs(const ContactModel& model,
                                                          const Springs<Real>& springs, int at) {
  const Lanes<Real> d;
  const auto zero = hn::Zero(d);
  SpringLanes<hn::Vec<Lanes<Real>>> lanes{{zero, zero, zero}, {zero, zero, zero}, zero};
  const auto three = [&](int row) HWY_ATTR {
    return Lanes3<hn::Vec<Lanes<Real>>>{hn::LoadU(d, springs.row(row) + at),
                                        hn::LoadU(d, springs.row(row + 1) + at),
                                        hn::LoadU(d, springs.row(row + 2) + at)};
  };
  if constexpr (turning) lanes.tangential = three(0);
  const SpringRows rows = spring_rows<turning>(model);
  if (rows.rolling >= 0) lanes.rolling = three(rows.rolling);
  if (rows.bridge >= 0) lanes.bridge = hn::LoadU(d, springs.row(rows.bridge) + at);
  return lanes;
}

template <class Real, bool turning>
HWY_INLINE void store_springs(const ContactModel& model,
                              const SpringLanes<hn::Vec<Lanes<Real>>>& lanes, int at,
                              Springs<Real>& springs) {
  const Lanes<Real> d;
  const auto three = [&](const Lanes3<hn::Vec<Lanes<Real>>>& value, int row) HWY_ATTR {
    hn::StoreU(value.x, d, springs.row(row) + at);
    hn::StoreU(value.y, d, springs.row(row + 1) + at);
    hn::StoreU(value.z, d, springs.row(row + 2) + at);
  };
  if constexpr (turning) three(lanes.tangential, 0);
  const SpringRows rows = spring_rows<turning>(model);
  if (rows.rolling >= 0) three(lanes.rolling, rows.rolling);
  if (rows.bridge >= 0) hn::StoreU(lanes.bridge, d, springs.row(rows.bridge) + at);
}

/// True if the force depends on the radii apart from the overlap.
HWY_INLINE bool needs_curvature(const ContactModel& model) {
  return model.law != ContactLaw::linear || model.rolling != RollingLaw::none ||
         model.cohesion != CohesionLaw::none;
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
  const Real* row[width];
  for (int k = 0; k < width; ++k) row[k] = bodies[k]->radius_spin;
  const auto w = gather_rows(d, row);
  for (int k = 0; k < width; ++k) row[k] = bodies[k]->velocity;
  const auto v = gather_rows(d, row);
  return {scaled(Lanes3<hn::Vec<Lanes<Real>>>{w.a, w.b, w.c}, w.d), w.d,
          hn::Mul(v.d, hn::Mul(w.d, w.d))};
}

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

/// A batch of contacts with walls, one a lane, whose normals, overlaps and wall velocities are
/// known: forces on the particles `place` (in the block).
template <class Real, bool turning, class Contact>
HWY_INLINE void pass_walls(const BlockPass<Real, turning>& pass,
                           TouchLanes<hn::Vec<Lanes<Real>>>& touch,
                           const Lanes3<hn::Vec<Lanes<Real>>>& wall_velocity,
                           const Contact* contacts, int count, int at, Springs<Real>& springs) {
  const Lanes<Real> d;
  using V = hn::Vec<Lanes<Real>>;
  const ContactModel& model = pass.laws->model;
  const Body<Real, turning>* body[width];
  for (int k = 0; k < width; ++k) body[k] = pass.now + pass.first + contacts[k].mine;
  const Real* row[width];
  for (int k = 0; k < width; ++k) row[k] = body[k]->velocity;
  const auto v = gather_rows(d, row);
  touch.velocity = {hn::Sub(v.a, wall_velocity.x), hn::Sub(v.b, wall_velocity.y),
                    hn::Sub(v.c, wall_velocity.z)};
  touch.root_mass = root_mass<Real>(pass.root_masses.wall, v.d);
  touch.inverse_radius = hn::Zero(d);
  if (needs_curvature(model)) {
    alignas(64) Real radius[width];
    for (int k = 0; k < width; ++k) radius[k] = static_cast<Real>(body[k]->radius);
    touch.inverse_radius = hn::Div(hn::Set(d, 1), hn::Load(d, radius));
  }
  RollLanes<Real> roll = no_roll<Real>();
  if constexpr (turning) {
    for (int k = 0; k < width; ++k) row[k] = body[k]->radius_spin;
    const auto w = gather_rows(d, row);
    touch.radius_spin = {w.a, w.b, w.c};
    if (model.rolling != RollingLaw::none) {
      roll = gather_roll(body);
      touch.spin = roll.spin;
      touch.inverse_inertia = roll.inverse_inertia;
    }
  }
  const auto near =
      hn::And(hn::FirstN(d, count),
              hn::Gt(touch.overlap, hn::Set(d, static_cast<Real>(-pass.beyond_contact))));
  SpringLanes<V> spring = load_springs<Real, turning>(model, springs, at);
  ForceLanes<V> out = no_force<Real>();
  contact_force<turning>(d, model, law_of(*pass.laws, contacts), touch,
                         hn::Set(d, static_cast<Real>(pass.spring_step)), spring, near, out);
  store_springs<Real, turning>(model, spring, at, springs);
  if constexpr (turning) {
    if (model.rolling != RollingLaw::none) {
      out.lever = plus_scaled(out.lever, roll.inverse_radius, out.torque);
    }
  }
  const LoadRows<Real, turning> loads(out);
  for (int k = 0; k < count; ++k) loads.add(k, pass.sum[contacts[k].mine]);
}

/// Contacts with the plane sides of the domain.
template <class Real, bool turning>
HWY_INLINE void pass_planes(const BlockPass<Real, turning>& pass, const NearPlane* near, int count,
                            int at, Springs<Real>& springs) {
  const Positions dd;
  const Lanes<Real> d;
  const double* rows[width];
  for (int k = 0; k < width; ++k) rows[k] = pass.now[pass.first + near[k].mine].position;
  const auto x = gather_rows(dd, rows);
  for (int k = 0; k < width; ++k) rows[k] = pass.planes[near[k].side];
  const auto plane = gather_rows(dd, rows);
  const auto height =
      hn::MulAdd(x.a, plane.a, hn::MulAdd(x.b, plane.b, hn::MulSub(x.c, plane.c, plane.d)));
  auto touch = no_touch<Real>();
  touch.overlap = to_real<Real>(hn::Sub(x.d, height));
  touch.normal = {to_real<Real>(plane.a), to_real<Real>(plane.b), to_real<Real>(plane.c)};
  const auto zero = hn::Zero(d);
  pass_walls<Real, turning>(pass, touch, {zero, zero, zero}, near, count, at, springs);
}

template <class Real, bool turning>
HWY_INLINE void pass_plane_list(const BlockPass<Real, turning>& pass,
                                const std::vector<NearPlane>& list, Springs<Real>& springs) {
  const int size = static_cast<int>(list.size());
  for (int at = 0; at < size; at += width) {
    NearPlane batch[width];
    for (int k = 0; k < width; ++k) batch[k] = list[std::min(at + k, size - 1)];
    pass_planes(pass, batch, std::min(width, size - at), at, springs);
  }
}

/// Contacts with the surfaces, where they have just been found.
template <class Real, bool turning>
HWY_INLINE void pass_touches(const BlockPass<Real, turning>& pass, const SurfaceTouch* touches,
                             int count, int at, Springs<Real>& springs) {
  const Positions d;
  const double* rows[width];
  for (int k = 0; k < width; ++k) rows[k] = touches[k].normal;
  const auto normal = gather_rows(d, rows);
  for (int k = 0; k < width; ++k) rows[k] = touches[k].velocity;
  const auto velocity = gather_rows(d, rows);
  alignas(64) double radius[width];
  for (int k = 0; k < width; ++k) radius[k] = pass.now[pass.first + touches[k].mine].radius;
  auto touch = no_touch<Real>();
  touch.overlap = to_real<Real>(hn::Sub(hn::Load(d, radius), normal.d));
  touch.normal = {to_real<Real>(normal.a), to_real<Real>(normal.b), to_real<Real>(normal.c)};
  pass_walls<Real, turning>(
      pass, touch,
      {to_real<Real>(velocity.a), to_real<Real>(velocity.b), to_real<Real>(velocity.c)}, touches,
      count, at, springs);
}

template <class Real, bool turning>
HWY_INLINE void pass_touch_list(const BlockPass<Real, turning>& pass,
                                const std::vector<SurfaceTouch>& list, Springs<Real>& springs) {
  const int size = static_cast<int>(list.size());
  for (int at = 0; at < size; at += width) {
    SurfaceTouch batch[width];
    for (int k = 0; k < width; ++k) batch[k] = list[std::min(at + k, size - 1)];
    pass_touches(pass, batch, std::min(width, size - at), at, springs);
  }
}

template <class Real, bool turning>
HWY_INLINE void add_contacts(const BlockPass<Real, turning>& pass) {
  std::fill(pass.sum, pass.sum + (pass.last - pass.first), Load<Real, turning>{});
  ContactBlock<Real>& contacts = *pass.contacts;
  pass_list<Real, turning, Kind::inner>(pass, contacts.inner, contacts.inner_springs);
  pass_list<Real, turning, Kind::outer>(pass, contacts.outer, contacts.outer_springs);
  pass_list<Real, turning, Kind::image>(pass, contacts.image, contacts.image_springs);
  pass_plane_list(pass, contacts.planes, contacts.plane_springs);
  pass_touch_list(pass, contacts.surfaces.touches, contacts.surfaces.springs);
}

/// The kick of one particle: `next` gets the new velocity and spin. Masses and radii, the last
/// numbers of their rows, stay as they are, since those of loads and drives are 0.
template <class Real, bool turning>
HWY_INLINE Row<Real> kick(const Body<Real, turning>& now, const Load<Real, turning>& load,
                          const Drive<Real>& drive, Real time_step, Body<Real, turning>& next) {
  const Row<Real> acceleration =
      multiply_add(load_row(load.force), same_row(now.inverse_mass), load_row(drive.acceleration));
  const Row<Real> velocity =
      multiply_add(acceleration, same_row(time_step), load_row(now.velocity));
  store_row(velocity, next.velocity);
  if constexpr (turning) {
    // d(r ω)/dt = r² F/I, I = 2/5 m r²
    const Row<Real> turn = same_row(Real(2.5) * time_step * now.inverse_mass);
    store_row(multiply_add(load_row(load.lever), turn, load_row(now.radius_spin)),
              next.radius_spin);
  }
  return velocity;
}

/// Kick and drift of the block, with its loads.
template <class Real, bool turning>
HWY_INLINE bool move(const BlockPass<Real, turning>& pass, const Load<Real, turning>* loads,
                     double kick_step) {
  alignas(32) const double steps[4] = {pass.time_step, pass.time_step, pass.time_step, 0};
  alignas(32) const double origins[4] = {pass.origin[0], pass.origin[1], pass.origin[2], 0};
  const Row<double> step = load_row(steps);  // 0 for the radius
  const Row<double> origin = load_row(origins);
  const double limit = pass.reach * pass.reach;
  bool beyond = false;
  for (int i = pass.first; i < pass.last; ++i) {
    const Body<Real, turning>& now = pass.now[i];
    Body<Real, turning>& next = pass.next[i];
    const Row<Real> velocity =
        kick(now, loads[i - pass.first], pass.drive[i], static_cast<Real>(kick_step), next);
    const Row<double> before = load_row(now.position);
    const Row<double> position = multiply_add(widened<Real>(velocity), step, before);
    store_row(position, next.position);
    const Row<double> listed = widened<float>(load_row(pass.listed_at[i].offset));
    const double square = square_norm(subtract(subtract(position, origin), listed));
    beyond |= !(square <= limit);  // this way round it is true for NaN
  }
  return beyond;
}

template <class Real, bool turning>
HWY_INLINE bool pass_any(const BlockPass<Real, turning>& pass) {
  if (pass.phase == Phase::start) return move(pass, pass.load + pass.first, 0.5 * pass.time_step);
  add_contacts(pass);
  if (pass.phase == Phase::drift) return move(pass, pass.sum, pass.time_step);
  for (int i = pass.first; i < pass.last; ++i) {
    Body<Real, turning>& next = pass.next[i];
    store_row(load_row(pass.now[i].position), next.position);
    pass.load[i] = pass.sum[i - pass.first];
    kick(pass.now[i], pass.load[i], pass.drive[i], static_cast<Real>(0.5 * pass.time_step), next);
  }
  return false;
}

bool pass_double_gliding(const BlockPass<double, false>& pass) { return pass_any(pass); }
bool pass_double_turning(const BlockPass<double, true>& pass) { return pass_any(pass); }
bool pass_mixed_gliding(const BlockPass<float, false>& pass) { return pass_any(pass); }
bool pass_mixed_turning(const BlockPass<float, true>& pass) { return pass_any(pass); }

}  // namespace fluxpact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fluxpact {

HWY_EXPORT(pass_double_gliding);
HWY_EXPORT(pass_double_turning);
HWY_EXPORT(pass_mixed_gliding);
HWY_EXPORT(pass_mixed_turning);

bool pass_block(const BlockPass<double, false>& pass) {
  return HWY_DYNAMIC_DISPATCH(pass_double_gliding)(pass);
}
bool pass_block(const BlockPass<double, true>& pass) {
  return HWY_DYNAMIC_DISPATCH(pass_double_turning)(pass);
}
bool pass_block(const BlockPass<float, false>& pass) {
  return HWY_DYNAMIC_DISPATCH(pass_mixed_gliding)(pass);
}
bool pass_block(const BlockPass<float, true>& pass) {
  return HWY_DYNAMIC_DISPATCH(pass_mixed_turning)(pass);
}

}  // namespace fluxpact
#endif
