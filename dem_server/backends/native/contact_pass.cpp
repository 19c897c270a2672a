#include "dem_server/backends/native/contact_pass.hpp"

#include <cmath>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dem_server/backends/native/contact_pass.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "dem_server/backends/native/pair_pass-inl.hpp"
#include "dem_server/backends/native/wall_pass-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace fluxpact::HWY_NAMESPACE {

template <class Real, bool turning>
HWY_INLINE void add_contacts(const BlockPass<Real, turning>& pass) {
  std::memset(pass.sum, 0, sizeof(*pass.sum) * (pass.last - pass.first));
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
