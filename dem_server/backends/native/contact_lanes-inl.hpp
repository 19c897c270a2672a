// What goes into the force of a contact and comes out of it, one contact a lane; the parameters of
// the pairs of materials in lanes; vectors in space. For contact_force-inl.hpp.
#if defined(FLUXPACT_CONTACT_LANES_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef FLUXPACT_CONTACT_LANES_INL_
#undef FLUXPACT_CONTACT_LANES_INL_
#else
#define FLUXPACT_CONTACT_LANES_INL_
#endif

#include "dem_server/backends/native/contact_law.hpp"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace fluxpact::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class V>
struct Lanes3 {
  V x, y, z;
};

/// A contact seen from the particle on which the force is wanted.
template <class V>
struct TouchLanes {
  Lanes3<V> normal;       ///< unit vector from the partner to the particle
  V overlap;              ///< [m]; negative where the surfaces are apart
  Lanes3<V> velocity;     ///< [m/s] of the particle's centre relative to the partner's
  Lanes3<V> radius_spin;  ///< [m/s] Σ radius × spin rate over both; a wall has none. With friction
  Lanes3<V> spin;         ///< [rad/s] relative to the partner's; only with a rolling law
  V root_mass;            ///< [sqrt(kg)] sqrt(m*), 1/m* = Σ 1/m; a wall has 0
  V inverse_radius;       ///< [1/m] Σ 1/r; a wall has 0
  V inverse_inertia;      ///< [1/(kg m²)] Σ 1/(m r²); a wall has 0. Only with a rolling law
};

/// The parameters of the pair of materials in each lane (LawColumn); those that the model does not
/// use are zero.
template <class V>
struct LawLanes {
  V normal, tangential, tangential_softness, damping, tangential_damping, friction;
  V rolling_friction, rolling_stiffness, rolling_damping;
  V attraction, bridge_shape, bridge_rupture;
  V film_viscosity, film_thinnest, film_closeness;
};

/// What a contact remembers (spring_rows); parts that the model does not have are neither read
/// nor written.
template <class V>
struct SpringLanes {
  Lanes3<V> tangential;  ///< [m] with friction
  Lanes3<V> rolling;     ///< [rad] spring_dashpot
  V bridge;              ///< liquid_bridge, jkr: 1 where the contact holds, else 0
};

template <class V>
struct ForceLanes {
  Lanes3<V> force;  ///< [N] on the particle; the opposite acts on the partner
  Lanes3<V>
      lever;  ///< [N] −n × F_t: times its own radius the torque on each of the two. With friction
  Lanes3<V>
      torque;  ///< [N m] against rolling, the opposite acts on the partner. With a rolling law
};

// ---- parameters ----

/// Fills the lanes that `model` uses with `load(column)`.
template <class D, class Load>
HWY_INLINE LawLanes<hn::Vec<D>> load_columns(D d, const ContactModel& model, const Load& load) {
  const auto zero = hn::Zero(d);
  LawLanes<hn::Vec<D>> law{zero, zero, zero, zero, zero, zero, zero, zero,
                           zero, zero, zero, zero, zero, zero, zero};
  law.normal = load(LawColumn::normal);
  law.damping = load(LawColumn::damping);
  if (model.friction) {
    law.tangential = load(LawColumn::tangential);
    law.tangential_softness = load(LawColumn::tangential_softness);
    law.tangential_damping = load(LawColumn::tangential_damping);
    law.friction = load(LawColumn::friction);
  }
  if (model.rolling != RollingLaw::none) {
    law.rolling_friction = load(LawColumn::rolling_friction);
    law.rolling_stiffness = load(LawColumn::rolling_stiffness);
    law.rolling_damping = load(LawColumn::rolling_damping);
  }
  if (model.cohesion != CohesionLaw::none) {
    law.attraction = load(LawColumn::attraction);
    law.bridge_shape = load(LawColumn::bridge_shape);
    law.bridge_rupture = load(LawColumn::bridge_rupture);
  }
  if (model.film) {
    law.film_viscosity = load(LawColumn::film_viscosity);
    law.film_thinnest = load(LawColumn::film_thinnest);
    law.film_closeness = load(LawColumn::film_closeness);
  }
  return law;
}

/// The pair of materials `pair` (ContactLaws::index) in all lanes.
template <class D>
HWY_INLINE LawLanes<hn::Vec<D>> load_law(D d, const LawTable<hn::TFromD<D>>& table, int pair) {
  return load_columns(d, table.model, [&](LawColumn name) HWY_ATTR {
    return hn::Set(d, table.column(name)[pair]);
  });
}

/// A pair of materials a lane. Every lane must hold a valid index, whether it touches or not.
template <class D>
HWY_INLINE LawLanes<hn::Vec<D>> load_law(D d, const LawTable<hn::TFromD<D>>& table,
                                         hn::Vec<hn::RebindToSigned<D>> pairs) {
  return load_columns(d, table.model, [&](LawColumn name) HWY_ATTR {
    return hn::GatherIndex(d, table.column(name), pairs);
  });
}

// ---- vectors ----

template <class V>
HWY_INLINE V dot(const Lanes3<V>& a, const Lanes3<V>& b) {
  return hn::MulAdd(a.z, b.z, hn::MulAdd(a.y, b.y, hn::Mul(a.x, b.x)));
}

template <class V>
HWY_INLINE Lanes3<V> scaled(const Lanes3<V>& a, V factor) {
  return {hn::Mul(a.x, factor), hn::Mul(a.y, factor), hn::Mul(a.z, factor)};
}

/// a + factor b
template <class V>
HWY_INLINE Lanes3<V> plus_scaled(const Lanes3<V>& a, V factor, const Lanes3<V>& b) {
  return {hn::MulAdd(factor, b.x, a.x), hn::MulAdd(factor, b.y, a.y), hn::MulAdd(factor, b.z, a.z)};
}

/// a − factor b
template <class V>
HWY_INLINE Lanes3<V> minus_scaled(const Lanes3<V>& a, V factor, const Lanes3<V>& b) {
  return {hn::NegMulAdd(factor, b.x, a.x), hn::NegMulAdd(factor, b.y, a.y),
          hn::NegMulAdd(factor, b.z, a.z)};
}

/// a × b
template <class V>
HWY_INLINE Lanes3<V> cross(const Lanes3<V>& a, const Lanes3<V>& b) {
  return {hn::NegMulAdd(a.z, b.y, hn::Mul(a.y, b.z)), hn::NegMulAdd(a.x, b.z, hn::Mul(a.z, b.x)),
          hn::NegMulAdd(a.y, b.x, hn::Mul(a.x, b.y))};
}

template <class M, class V>
HWY_INLINE Lanes3<V> or_zero(M keep, const Lanes3<V>& a) {
  return {hn::IfThenElseZero(keep, a.x), hn::IfThenElseZero(keep, a.y),
          hn::IfThenElseZero(keep, a.z)};
}

template <class M, class V>
HWY_INLINE Lanes3<V> select(M which, const Lanes3<V>& yes, const Lanes3<V>& no) {
  return {hn::IfThenElse(which, yes.x, no.x), hn::IfThenElse(which, yes.y, no.y),
          hn::IfThenElse(which, yes.z, no.z)};
}

}  // namespace fluxpact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
