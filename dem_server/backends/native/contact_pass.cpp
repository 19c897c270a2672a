#include "dem_server/backends/native/contact_pass.hpp"

#include <cmath>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dem_server/backends/native/contact_pass.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "dem_server/backends/native/close_search-inl.hpp"
#include "dem_server/backends/native/pair_pass-inl.hpp"
#include "dem_server/backends/native/wall_pass-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace fluxpact::HWY_NAMESPACE {

/// The pairs that do not go through a periodic side.
template <bool plain, class Real, bool turning>
HWY_INLINE void pass_direct_pairs(const BlockPass<Real, turning>& pass) {
  ContactBlock<Real>& contacts = *pass.contacts;
  pass_pairs<plain, Real, turning, Kind::inner>(pass, contacts.inner, contacts.inner_close);
  pass_pairs<plain, Real, turning, Kind::outer>(pass, contacts.outer, contacts.outer_close);
}

template <class Real, bool turning>
HWY_INLINE void pass_all_pairs(const BlockPass<Real, turning>& pass) {
  bool plain = false;
  if constexpr (turning) {
    plain = is_plain(pass);
    if (plain) pass_direct_pairs<true>(pass);
  }
  if (!plain) pass_direct_pairs<false>(pass);
  ContactBlock<Real>& contacts = *pass.contacts;
  pass_pairs<false, Real, turning, Kind::image>(pass, contacts.image, contacts.image_close);
}

template <class Real, bool turning>
HWY_INLINE void add_contacts(const BlockPass<Real, turning>& pass) {
  std::memset(pass.sum, 0, sizeof(*pass.sum) * (pass.last - pass.first));
  ContactBlock<Real>& contacts = *pass.contacts;
  if (!contacts.budget.spend(pass.kick, pass.time_step)) {
    contacts.budget.renew(pass.kick, pass.time_step, pass.usual_room);
    go_through<Real, turning, Kind::inner>(pass, contacts.inner, contacts.inner_close);
    go_through<Real, turning, Kind::outer>(pass, contacts.outer, contacts.outer_close);
    go_through<Real, turning, Kind::image>(pass, contacts.image, contacts.image_close);
  }
  pass_all_pairs(pass);
  pass_plane_list(pass, contacts.planes, contacts.plane_springs);
  pass_touch_list(pass, contacts.surfaces.touches, contacts.surfaces.springs);
}

/// The kick of one particle; `largest` is that of all so far, squared. Masses and radii, the last
/// numbers of their rows, stay as they are, since those of loads and drives are 0. `drive`: three
/// numbers [m/s²].
template <class Real, bool turning>
HWY_INLINE Row<Real> kick(const Load<Real, turning>& load, const Real* drive, Real time_step,
                          Body<Real, turning>& body, double& largest) {
  const Row<Real> acceleration =
      multiply_add(load_row(load.force), same_row(body.inverse_mass), load_vector(drive));
  if constexpr (turning) {
    // d(r ω)/dt = r² F/I, I = 2/5 m r²
    const Row<Real> turn = same_row(Real(2.5) * time_step * body.inverse_mass);
    store_row(multiply_add(load_row(load.lever), turn, load_row(body.radius_spin)),
              body.radius_spin);
  }
  const Row<Real> before = load_row(body.velocity);
  const Row<Real> velocity = multiply_add(acceleration, same_row(time_step), before);
  largest = std::max(largest, square_norm(widened<Real>(subtract(velocity, before))));
  store_row(velocity, body.velocity);
  return velocity;
}

/// Kick and drift of the block.
template <class Real, bool turning>
HWY_INLINE Moved kick_and_drift(const BlockPass<Real, turning>& pass, double kick_step) {
  alignas(32) const double steps[4] = {pass.time_step, pass.time_step, pass.time_step, 0};
  alignas(32) const double origins[4] = {pass.origin[0], pass.origin[1], pass.origin[2], 0};
  const Row<double> step = load_row(steps);  // 0 for the radius
  const Row<double> origin = load_row(origins);
  const double limit = pass.reach * pass.reach;
  bool beyond = false;
  double largest = 0;  // kick, squared
  for (int i = pass.first; i < pass.last; ++i) {
    Body<Real, turning>& body = pass.bodies[i];
    const Row<Real> velocity = kick(pass.sum[i - pass.first], pass.loads[i].force,
                                    static_cast<Real>(kick_step), body, largest);
    const Row<double> position =
        multiply_add(widened<Real>(velocity), step, load_row(body.position));
    store_row(position, body.position);
    const Row<double> listed = widened<float>(load_row(pass.listed_at[i].offset));
    const double square = square_norm(subtract(subtract(position, origin), listed));
    beyond |= !(square <= limit);  // this way round it is true for NaN
  }
  return {beyond, std::sqrt(largest)};
}

template <class Real, bool turning>
HWY_INLINE Moved move_any(const BlockPass<Real, turning>& pass) {
  if (pass.phase == Phase::drift) return kick_and_drift(pass, pass.time_step);
  if (pass.phase == Phase::start) {
    for (int i = pass.first; i < pass.last; ++i) {
      pass.sum[i - pass.first] = full(pass.kept_loads[i]);
    }
    return kick_and_drift(pass, 0.5 * pass.time_step);
  }
  double largest = 0;
  for (int i = pass.first; i < pass.last; ++i) {
    const Load<Real, turning>& load = pass.sum[i - pass.first];
    kick(load, pass.loads[i].force, static_cast<Real>(0.5 * pass.time_step), pass.bodies[i],
         largest);
    pass.loads[i] = kept(load);
  }
  return {false, std::sqrt(largest)};
}

void sum_double_gliding(const BlockPass<double, false>& pass) { add_contacts(pass); }
void sum_double_turning(const BlockPass<double, true>& pass) { add_contacts(pass); }
void sum_mixed_gliding(const BlockPass<float, false>& pass) { add_contacts(pass); }
void sum_mixed_turning(const BlockPass<float, true>& pass) { add_contacts(pass); }
Moved move_double_gliding(const BlockPass<double, false>& pass) { return move_any(pass); }
Moved move_double_turning(const BlockPass<double, true>& pass) { return move_any(pass); }
Moved move_mixed_gliding(const BlockPass<float, false>& pass) { return move_any(pass); }
Moved move_mixed_turning(const BlockPass<float, true>& pass) { return move_any(pass); }

}  // namespace fluxpact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fluxpact {

#define FLUXPACT_DISPATCH(name, Real, turning)              \
  HWY_EXPORT(sum_##name);                                   \
  HWY_EXPORT(move_##name);                                  \
  void sum_contacts(const BlockPass<Real, turning>& pass) { \
    HWY_DYNAMIC_DISPATCH(sum_##name)(pass);                 \
  }                                                         \
  Moved move_block(const BlockPass<Real, turning>& pass) {  \
    return HWY_DYNAMIC_DISPATCH(move_##name)(pass);         \
  }
FLUXPACT_DISPATCH(double_gliding, double, false)
FLUXPACT_DISPATCH(double_turning, double, true)
FLUXPACT_DISPATCH(mixed_gliding, float, false)
FLUXPACT_DISPATCH(mixed_turning, float, true)
#undef FLUXPACT_DISPATCH

}  // namespace fluxpact
#endif
