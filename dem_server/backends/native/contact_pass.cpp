#include "dem_server/backends/native/contact_pass.hpp"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dem_server/backends/native/contact_pass.cpp"
#include <hwy/foreach_target.h>
#include <hwy/cache_control.h>
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

/// How the surfaces of a batch stand to each other; lanes without contact hold nothing of use.
template <class Real>
struct Gap {
  using V = hn::Vec<Lanes<Real>>;
  Lanes3<V> normal;
  V overlap;
  hn::Mask<Lanes<Real>> touching;
};

/// From the vector between the centres and the sum of the radii. In float the overlap is
/// (R² - d²)/(R + d) with the numerator in double, since the difference of two lengths would keep
/// few digits.
template <class Real>
HWY_INLINE Gap<Real> gap_between(hn::Vec<Positions> x, hn::Vec<Positions> y,
                                 hn::Vec<Positions> z, hn::Vec<Positions> radii, int count) {
  const Lanes<Real> d;
  const auto square = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
  const auto difference = to_real<Real>(hn::MulSub(radii, radii, square));
  const auto touching = hn::And(hn::Gt(difference, hn::Zero(d)), hn::FirstN(d, count));
  const auto square_real = to_real<Real>(square);
  const auto distance = hn::Sqrt(square_real);
  const auto inverse = hn::Div(hn::Set(d, 1), distance);
  hn::Vec<Lanes<Real>> overlap;
  if constexpr (sizeof(Real) == sizeof(double)) {
    overlap = hn::Sub(radii, distance);
  } else {
    overlap = hn::Div(difference, hn::Add(to_real<Real>(radii), distance));
  }
  return {{hn::Mul(to_real<Real>(x), inverse), hn::Mul(to_real<Real>(y), inverse),
           hn::Mul(to_real<Real>(z), inverse)},
          overlap, touching};
}

template <class Real>
HWY_INLINE LawLanes<hn::Vec<Lanes<Real>>> law_of(const LawTable<Real>& table) {
  const Lanes<Real> d;
  const auto& law = table.rows.front();
  return {hn::Set(d, law.normal_stiffness), hn::Set(d, law.tangential_stiffness),
          hn::Set(d, law.inverse_tangential_stiffness),
          hn::Set(d, law.damping), hn::Set(d, law.friction)};
}

/// Root of the effective mass [kg^0.5]: what holds for all contacts, if that is known, else from the
/// sum of the inverse masses.
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

template <class Real, bool turning>
HWY_INLINE Lanes3<hn::Vec<Lanes<Real>>> load_spring(const Springs<Real>& springs, int at) {
  const Lanes<Real> d;
  if constexpr (turning) {
    return {hn::LoadU(d, springs.row(0) + at), hn::LoadU(d, springs.row(1) + at),
            hn::LoadU(d, springs.row(2) + at)};
  } else {
    return {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  }
}

template <class Real>
HWY_INLINE void store_spring(const Lanes3<hn::Vec<Lanes<Real>>>& spring, int at,
                             Springs<Real>& springs) {
  const Lanes<Real> d;
  hn::StoreU(spring.x, d, springs.row(0) + at);
  hn::StoreU(spring.y, d, springs.row(1) + at);
  hn::StoreU(spring.z, d, springs.row(2) + at);
}

/// One batch of pairs.
template <class Real, bool turning, Kind kind>
HWY_INLINE void pass_pairs(const BlockPass<Real, turning>& pass, const Pair* pairs, int count,
                           int at, Springs<Real>& springs) {
  const Positions dd;
  const Lanes<Real> d;
  using V = hn::Vec<Lanes<Real>>;
  const Body<Real, turning>* mine = pass.now + pass.first;
  const Body<Real, turning>* theirs = kind == Kind::inner ? mine : pass.now;
  const Body<Real, turning>* a[width];
  const Body<Real, turning>* b[width];
  for (int k = 0; k < width; ++k) {
    a[k] = mine + pairs[k].mine;
    b[k] = theirs + pairs[k].other;
  }
  const double* first[width];
  const double* second[width];
  for (int k = 0; k < width; ++k) {
    first[k] = a[k]->position;
    second[k] = b[k]->position;
  }
  auto apart = combine_rows(dd, first, second, Flip<double>::difference);
  if constexpr (kind == Kind::image) {
    for (int k = 0; k < width; ++k) first[k] = pass.shifts[pairs[k].shift];
    const auto shift = gather_rows(dd, first);
    apart.a = hn::Sub(apart.a, shift.a);
    apart.b = hn::Sub(apart.b, shift.b);
    apart.c = hn::Sub(apart.c, shift.c);
  }
  const Gap<Real> gap = gap_between<Real>(apart.a, apart.b, apart.c, apart.d, count);
  if (hn::AllFalse(d, gap.touching)) {
    if constexpr (turning) store_spring<Real>({hn::Zero(d), hn::Zero(d), hn::Zero(d)}, at, springs);
    return;
  }
  const Real* row_a[width];
  const Real* row_b[width];
  for (int k = 0; k < width; ++k) {
    row_a[k] = a[k]->velocity;
    row_b[k] = b[k]->velocity;
  }
  const auto v = combine_rows(d, row_a, row_b, Flip<Real>::difference);
  TouchLanes<V> touch;
  touch.normal = gap.normal;
  touch.overlap = gap.overlap;
  touch.velocity = {v.a, v.b, v.c};
  touch.root_mass = root_mass<Real>(pass.root_masses.pair, v.d);
  if constexpr (turning) {
    for (int k = 0; k < width; ++k) {
      row_a[k] = a[k]->radius_spin;
      row_b[k] = b[k]->radius_spin;
    }
    const auto w = combine_rows(d, row_a, row_b, Flip<Real>::sum);
    touch.radius_spin = {w.a, w.b, w.c};
  }
  Lanes3<V> spring = load_spring<Real, turning>(springs, at);
  ForceLanes<V> out;
  contact_force<turning>(d, law_of(*pass.laws), touch,
                         hn::Set(d, static_cast<Real>(pass.spring_step)), spring, gap.touching,
                         out);
  if constexpr (turning) store_spring<Real>(spring, at, springs);
  const LoadRows<Real, turning> loads(out);
  for (int k = 0; k < width; ++k) {
    loads.add(k, pass.sum[pairs[k].mine]);
    if constexpr (kind == Kind::inner) loads.add_mirrored(k, pass.sum[pairs[k].other]);
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

/// Contacts with the plane sides of the domain.
template <class Real, bool turning>
HWY_INLINE void pass_planes(const BlockPass<Real, turning>& pass, const NearPlane* near, int count,
                            int at, Springs<Real>& springs) {
  const Positions dd;
  const Lanes<Real> d;
  using V = hn::Vec<Lanes<Real>>;
  const Body<Real, turning>* mine = pass.now + pass.first;
  const double* rows[width];
  for (int k = 0; k < width; ++k) rows[k] = mine[near[k].mine].position;
  const auto x = gather_rows(dd, rows);
  for (int k = 0; k < width; ++k) rows[k] = pass.planes[near[k].side];
  const auto plane = gather_rows(dd, rows);
  const auto height = hn::MulAdd(
      x.a, plane.a, hn::MulAdd(x.b, plane.b, hn::MulSub(x.c, plane.c, plane.d)));
  TouchLanes<V> touch;
  touch.overlap = to_real<Real>(hn::Sub(x.d, height));
  const auto touching = hn::And(hn::Gt(touch.overlap, hn::Zero(d)), hn::FirstN(d, count));
  touch.normal = {to_real<Real>(plane.a), to_real<Real>(plane.b), to_real<Real>(plane.c)};
  const Real* real_rows[width];
  for (int k = 0; k < width; ++k) real_rows[k] = mine[near[k].mine].velocity;
  const auto v = gather_rows(d, real_rows);
  touch.velocity = {v.a, v.b, v.c};
  touch.root_mass = root_mass<Real>(pass.root_masses.wall, v.d);
  if constexpr (turning) {
    for (int k = 0; k < width; ++k) real_rows[k] = mine[near[k].mine].radius_spin;
    const auto w = gather_rows(d, real_rows);
    touch.radius_spin = {w.a, w.b, w.c};
  }
  Lanes3<V> spring = load_spring<Real, turning>(springs, at);
  ForceLanes<V> out;
  contact_force<turning>(d, law_of(*pass.laws), touch,
                         hn::Set(d, static_cast<Real>(pass.spring_step)), spring, touching, out);
  if constexpr (turning) store_spring<Real>(spring, at, springs);
  const LoadRows<Real, turning> loads(out);
  for (int k = 0; k < count; ++k) loads.add(k, pass.sum[near[k].mine]);
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

template <class Real, bool turning>
HWY_INLINE void add_contacts(const BlockPass<Real, turning>& pass) {
  std::fill(pass.sum, pass.sum + (pass.last - pass.first), Load<Real, turning>{});
  ContactBlock<Real>& contacts = *pass.contacts;
  pass_list<Real, turning, Kind::inner>(pass, contacts.inner, contacts.inner_springs);
  pass_list<Real, turning, Kind::outer>(pass, contacts.outer, contacts.outer_springs);
  pass_list<Real, turning, Kind::image>(pass, contacts.image, contacts.image_springs);
  pass_plane_list(pass, contacts.planes, contacts.plane_springs);
}

/// The kick of one particle: `next` gets the new velocity and spin. Masses and radii, the last
/// numbers of their rows, stay as they are, since those of loads and drives are 0.
template <class Real, bool turning>
HWY_INLINE Row<Real> kick(const Body<Real, turning>& now, const Load<Real, turning>& load,
                          const Drive<Real>& drive, Real time_step, Body<Real, turning>& next) {
  const Row<Real> acceleration = multiply_add(
      load_row(load.force), same_row(now.inverse_mass), load_row(drive.acceleration));
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
