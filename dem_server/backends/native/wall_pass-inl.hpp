// The contacts with the sides of the domain and with surfaces.
#if defined(FLUXPACT_WALL_PASS_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef FLUXPACT_WALL_PASS_INL_
#undef FLUXPACT_WALL_PASS_INL_
#else
#define FLUXPACT_WALL_PASS_INL_
#endif

#include "dem_server/backends/native/batch-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace fluxpact::HWY_NAMESPACE {

/// A batch of contacts with walls, one a lane, whose normals, overlaps and wall velocities are
/// known: forces on the particles `place` (in the block).
template <class Real, bool turning, class Contact>
FLUXPACT_CONTACT_STEP void pass_walls(const BlockPass<Real, turning>& pass,
                                      TouchLanes<hn::Vec<Lanes<Real>>>& touch,
                                      const Lanes3<hn::Vec<Lanes<Real>>>& wall_velocity,
                                      const Contact* contacts, int count, int at,
                                      Springs<Real>& springs) {
  const Lanes<Real> d;
  using V = hn::Vec<Lanes<Real>>;
  const ContactModel& model = pass.laws->model;
  const Body<Real, turning>* body[width];
  for (int k = 0; k < width; ++k) body[k] = pass.bodies + pass.first + contacts[k].mine;
  const auto v = gather_rows(d, [&](int k) { return body[k]->velocity; });
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
    const auto w = gather_rows(d, [&](int k) { return body[k]->radius_spin; });
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
  SpringRow<Real>* row_of_springs[width];
  for (int k = 0; k < width; ++k) row_of_springs[k] = springs.of(at + std::min(k, count - 1));
  SpringLanes<V> spring = load_springs<Real>(model, row_of_springs);
  ForceLanes<V> out = no_force<Real>();
  contact_force<turning>(d, model, law_of(*pass.laws, [&](int k) { return contacts[k].law; }),
                         touch, hn::Set(d, static_cast<Real>(pass.spring_step)), spring, near, out);
  store_springs<Real>(model, spring, count, row_of_springs);
  if constexpr (turning) {
    if (model.rolling != RollingLaw::none) {
      out.lever = plus_scaled(out.lever, roll.inverse_radius, out.torque);
    }
  }
  const LoadRows<Real, turning> loads(out);
  loads.add_to(pass.sum, [&](int k) { return contacts[k].mine; });
}

/// Contacts with the plane sides of the domain.
template <class Real, bool turning>
HWY_INLINE void pass_planes(const BlockPass<Real, turning>& pass, const NearPlane* near, int count,
                            int at, Springs<Real>& springs) {
  const Positions dd;
  const Lanes<Real> d;
  const Body<Real, turning>* mine = pass.bodies + pass.first;
  const auto x = gather_rows(dd, [&](int k) { return mine[near[k].mine].position; });
  const auto plane = gather_rows(dd, [&](int k) { return pass.planes[near[k].side]; });
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
  const auto normal = gather_rows(d, [&](int k) { return touches[k].normal; });
  const auto velocity = gather_rows(d, [&](int k) { return touches[k].velocity; });
  alignas(64) double radius[width];
  for (int k = 0; k < width; ++k) radius[k] = pass.bodies[pass.first + touches[k].mine].radius;
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

}  // namespace fluxpact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
