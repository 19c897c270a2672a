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
  const Body<Real, turning>* body[width<Real>];
  for (int k = 0; k < width<Real>; ++k) body[k] = pass.own + contacts[k].mine;
  const auto v = gather_rows(d, [&](int k) { return body[k]->velocity; });
  touch.velocity = {hn::Sub(v.a, wall_velocity.x), hn::Sub(v.b, wall_velocity.y),
                    hn::Sub(v.c, wall_velocity.z)};
  touch.root_mass = root_mass<Real>(pass.root_masses.wall, v.d);
  touch.inverse_radius = hn::Zero(d);
  if (needs_curvature(model)) {
    alignas(64) Real radius[width<Real>];
    for (int k = 0; k < width<Real>; ++k) radius[k] = static_cast<Real>(body[k]->radius);
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
  const auto near = near_lanes<Real>(touch.overlap, pass.beyond_contact, count);
  SpringRow<Real>* row_of_springs[width<Real>];
  for (int k = 0; k < width<Real>; ++k) row_of_springs[k] = springs.of(at + std::min(k, count - 1));
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
  using Part = Quad<hn::Vec<Positions>>;
  const Positions d;
  const auto gap = parts_of<Real>([&](int first) HWY_ATTR {
    const auto x = gather_rows(d, [&](int k) { return pass.own[near[first + k].mine].position; });
    const auto side = gather_rows(d, [&](int k) { return pass.planes[near[first + k].side]; });
    const auto height =
        hn::MulAdd(x.a, side.a, hn::MulAdd(x.b, side.b, hn::MulSub(x.c, side.c, side.d)));
    return Part{side.a, side.b, side.c, hn::Sub(x.d, height)};
  });
  auto touch = no_touch<Real>();
  touch.overlap = to_real(gap, [](const Part& part) HWY_ATTR { return part.d; });
  touch.normal = vectors_of(gap);
  const auto zero = hn::Zero(Lanes<Real>());
  pass_walls<Real, turning>(pass, touch, {zero, zero, zero}, near, count, at, springs);
}

template <class Real, bool turning>
HWY_INLINE void pass_plane_list(const BlockPass<Real, turning>& pass,
                                const std::vector<NearPlane>& list, Springs<Real>& springs) {
  constexpr int lanes = width<Real>;
  const int size = static_cast<int>(list.size());
  for (int at = 0; at < size; at += lanes) {
    NearPlane batch[lanes];
    for (int k = 0; k < lanes; ++k) batch[k] = list[std::min(at + k, size - 1)];
    pass_planes(pass, batch, std::min(lanes, size - at), at, springs);
  }
}

/// Contacts with the surfaces, where they have just been found.
template <class Real, bool turning>
HWY_INLINE void pass_touches(const BlockPass<Real, turning>& pass, const SurfaceTouch* touches,
                             int count, int at, Springs<Real>& springs) {
  const Positions d;
  const auto normal = parts_of<Real>([&](int first) HWY_ATTR {
    return gather_rows(d, [&](int k) { return touches[first + k].normal; });
  });
  const auto velocity = parts_of<Real>([&](int first) HWY_ATTR {
    return gather_rows(d, [&](int k) { return touches[first + k].velocity; });
  });
  const auto overlap = parts_of<Real>([&](int first) HWY_ATTR {
    alignas(64) double gap[positions];
    for (int k = 0; k < positions; ++k) {
      const SurfaceTouch& touch = touches[first + k];
      gap[k] = pass.own[touch.mine].radius - touch.normal[3];
    }
    return hn::Load(d, gap);
  });
  auto touch = no_touch<Real>();
  touch.overlap = to_real(overlap);
  touch.normal = vectors_of(normal);
  pass_walls<Real, turning>(pass, touch, vectors_of(velocity), touches, count, at, springs);
}

template <class Real, bool turning>
HWY_INLINE void pass_touch_list(const BlockPass<Real, turning>& pass,
                                const std::vector<SurfaceTouch>& list, Springs<Real>& springs) {
  constexpr int lanes = width<Real>;
  const int size = static_cast<int>(list.size());
  for (int at = 0; at < size; at += lanes) {
    SurfaceTouch batch[lanes];
    for (int k = 0; k < lanes; ++k) batch[k] = list[std::min(at + k, size - 1)];
    pass_touches(pass, batch, std::min(lanes, size - at), at, springs);
  }
}

}  // namespace fluxpact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
