// The force of one contact, many contacts at once: one a lane, for any vector of doubles or floats
// and any target of Highway (included once for each target, between HWY_BEFORE_NAMESPACE and
// HWY_AFTER_NAMESPACE). The loops over pairs and walls call it after positions have moved; what the
// laws are and where they come from stands at each of them, their parameters are made in
// contact_law.hpp. What a scene does not ask for is behind a branch that goes the same way for all
// contacts, or left out at compile time (`friction`).
#if defined(FLUXPACT_CONTACT_FORCE_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef FLUXPACT_CONTACT_FORCE_INL_
#undef FLUXPACT_CONTACT_FORCE_INL_
#else
#define FLUXPACT_CONTACT_FORCE_INL_
#endif

#include "dem_server/backends/native/contact_lanes-inl.hpp"
#include "dem_server/backends/native/contact_stiffness-inl.hpp"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace fluxpact::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// ---- friction ----

/// The tangential spring follows the contact, and Coulomb's limit acts on spring and dashpot
/// together; where it does, the spring is set back to what gives the limit (Silbert et al., Phys.
/// Rev. E 64, 2001, 051302):
///   ξ += v_t dt, kept tangential;   F_t = −(k_t ξ + c_t v_t),   |F_t| ≤ μ |F_n|
/// The lever arms are the radii: v_t = v − v_n n − (r_i ω_i + r_j ω_j) × n. F_n is the force of
/// spring and dashpot, `pressing` its size: an attraction beside it presses the surfaces together
/// and so adds to it.
template <class D, class V, class M>
HWY_INLINE Lanes3<V> friction_force(D d, const ContactModel& model, const LawLanes<V>& law,
                                    const StiffnessLanes<V>& stiffness, const TouchLanes<V>& touch,
                                    V normal_velocity, V pressing, V time_step, M contact,
                                    Lanes3<V>& spring) {
  const Lanes3<V>& n = touch.normal;
  const Lanes3<V> rim = cross(touch.radius_spin, n);
  const Lanes3<V> off = minus_scaled(touch.velocity, normal_velocity, n);
  const Lanes3<V> slip{hn::Sub(off.x, rim.x), hn::Sub(off.y, rim.y), hn::Sub(off.z, rim.z)};
  Lanes3<V> xi = spring;
  if (model.law == ContactLaw::hertz) xi = scaled(xi, stiffness.spring_kept);
  xi = plus_scaled(xi, time_step, slip);
  xi = minus_scaled(xi, dot(xi, n), n);
  const V drag = hn::Neg(stiffness.tangential_damping);
  Lanes3<V> force = minus_scaled(scaled(slip, drag), stiffness.tangential, xi);
  const V limit = hn::Mul(law.friction, pressing);
  const V square = dot(force, force);
  const M slides = hn::And(contact, hn::Gt(square, hn::Mul(limit, limit)));
  // Whether or not some lane slides: which batches do cannot be foretold, and a branch that the
  // processor mistakes costs more than the root and the division (a tenth of the time of a step).
  const Lanes3<V> most = scaled(force, hn::Div(limit, hn::Sqrt(square)));
  V softness = hn::Neg(law.tangential_softness);
  if (model.law == ContactLaw::hertz) {
    softness = hn::Div(hn::Set(d, hn::TFromD<D>{-1}), stiffness.tangential);
  }
  const Lanes3<V> elastic = plus_scaled(most, stiffness.tangential_damping, slip);
  force = select(slides, most, force);
  xi = select(slides, scaled(elastic, softness), xi);
  spring = or_zero(contact, xi);
  return or_zero(contact, force);
}

// ---- rolling ----

/// A torque against the relative spin ω_r across the normal, at most μ_r R* |F_n| (Ai, Chen, Rotter
/// & Ooi, Powder Technol. 206, 2011, 269-282). Spin about the normal is left alone.
///  - constant_torque, their model A: the limit, against ω_r. It would make a particle that comes
///  to
///    rest turn to and fro from step to step, so it is at most what stops ω_r within the step if
///    nothing else acts.
///  - spring_dashpot, their model C without damping once it yields: θ += ω_r dt, kept across the
///    normal, M = −(k_r θ + C_r ω_r) with k_r = 2.25 k μ_r² R*² (k: normal force over overlap; the
///    factor is that of spheres) and C_r = 2 η sqrt(I k_r), 1/I = Σ 1/(7/5 m r²). Where k_r θ
///    exceeds the limit, θ is set back to it and the dashpot rests.
template <class D, class V, class M>
HWY_INLINE Lanes3<V> rolling_torque(D d, const ContactModel& model, const LawLanes<V>& law,
                                    const StiffnessLanes<V>& stiffness, const TouchLanes<V>& touch,
                                    V pressing, V time_step, M contact, Lanes3<V>& spring) {
  using T = hn::TFromD<D>;
  const Lanes3<V>& n = touch.normal;
  const Lanes3<V> spin = minus_scaled(touch.spin, dot(touch.spin, n), n);
  const V limit = hn::Div(hn::Mul(law.rolling_friction, pressing), touch.inverse_radius);
  if (model.rolling == RollingLaw::constant_torque) {
    const V square = dot(spin, spin);
    const V stopping =
        hn::Mul(hn::Set(d, static_cast<T>(2.5)), hn::Mul(touch.inverse_inertia, time_step));
    const V strength =
        hn::Min(hn::Div(limit, hn::Sqrt(square)), hn::Div(hn::Set(d, T{1}), stopping));
    return or_zero(hn::And(contact, hn::Gt(square, hn::Zero(d))), scaled(spin, hn::Neg(strength)));
  }
  Lanes3<V> theta = plus_scaled(spring, time_step, spin);
  theta = minus_scaled(theta, dot(theta, n), n);
  const V constant =
      hn::Div(hn::Div(hn::Mul(law.rolling_stiffness, stiffness.normal), touch.inverse_radius),
              touch.inverse_radius);
  const V damping = hn::Mul(
      hn::Mul(hn::Set(d, T{2}), law.rolling_damping),
      hn::Sqrt(hn::Div(hn::Mul(hn::Set(d, static_cast<T>(1.4)), constant), touch.inverse_inertia)));
  Lanes3<V> torque = scaled(theta, hn::Neg(constant));
  const V square = dot(torque, torque);
  const M yields = hn::And(contact, hn::Gt(square, hn::Mul(limit, limit)));
  const V share = hn::Div(limit, hn::Sqrt(square));
  theta = select(yields, scaled(theta, share), theta);
  torque = select(yields, scaled(torque, share), minus_scaled(torque, damping, spin));
  spring = or_zero(contact, theta);
  return or_zero(contact, torque);
}

// ---- cohesion ----

/// The attraction [N], 0 where there is none.
///  - sjkr: energy density c times the circle in which the spheres cut each other, to first order
///  in
///    δ: c 2π R* δ (the simplified model of Johnson, Kendall & Roberts of LIGGGHTS).
///  - liquid_bridge: forms where the surfaces touch, breaks at the distance (1 + θ/2) V^(1/3)
///  (Lian,
///    Thornton & Adams, J. Colloid Interface Sci. 161, 1993, 138). At the distance s of the
///    surfaces
///      F = 4π R* γ cos θ / (1 + 1.05 ŝ + 2.5 ŝ²),   ŝ = s sqrt(2 R*/V),   s = 0 while they touch
///    (Willett, Adams, Johnson & Seville, Langmuir 16, 2000, 9396, closed form for small bridges;
///    2 R* is the radius of two equal spheres).
template <class D, class V, class M>
HWY_INLINE V attraction(D d, const ContactModel& model, const LawLanes<V>& law,
                        const TouchLanes<V>& touch, M near, M contact, V& bridge) {
  using T = hn::TFromD<D>;
  const V zero = hn::Zero(d);
  const V one = hn::Set(d, T{1});
  const V strength = hn::Div(law.attraction, touch.inverse_radius);
  if (model.cohesion == CohesionLaw::sjkr) {
    return hn::IfThenElseZero(contact, hn::Mul(strength, touch.overlap));
  }
  const V distance = hn::Max(zero, hn::Neg(touch.overlap));
  const M wet = hn::And(hn::Or(contact, hn::And(near, hn::Gt(bridge, zero))),
                        hn::Lt(distance, law.bridge_rupture));
  bridge = hn::IfThenElseZero(wet, one);
  const V reach = hn::Mul(distance, hn::Sqrt(hn::Div(law.bridge_shape, touch.inverse_radius)));
  const V slope =
      hn::MulAdd(hn::Set(d, static_cast<T>(2.5)), reach, hn::Set(d, static_cast<T>(1.05)));
  return hn::IfThenElseZero(wet, hn::Div(strength, hn::MulAdd(slope, reach, one)));
}

// ---- lubrication ----

/// The force [N] along the normal with which the film between two spheres resists their approach
/// and their parting, on the particle: −6π μ R*² (1/h − 1/h_r) v_n, from the gap h_r on, with a
/// film no thinner than the roughness (the leading term of the theory of lubrication: Brenner,
/// Chem. Eng. Sci. 16, 1961, 242; O'Neill & Majumdar, Z. angew. Math. Phys. 21, 1970, 180, for
/// unequal spheres; cut off where asperities touch: Smart & Leighton, Phys. Fluids A 1, 1989, 52).
/// It ends where the surfaces touch: contacts are softened to be followed, and would dwell in the
/// film. Motion along the surfaces, whose resistance grows with ln h only, is left to the friction.
/// The force has no part from far away, which is the drag's.
template <class D, class V>
HWY_INLINE V film_force(D d, const LawLanes<V>& law, const TouchLanes<V>& touch,
                        V normal_velocity) {
  const V one = hn::Set(d, hn::TFromD<D>{1});
  const V gap = hn::Max(law.film_thinnest, hn::Neg(touch.overlap));
  const V closeness = hn::Max(hn::Zero(d), hn::Sub(hn::Div(one, gap), law.film_closeness));
  const V area = hn::Div(law.film_viscosity, hn::Mul(touch.inverse_radius, touch.inverse_radius));
  return hn::Neg(hn::Mul(hn::Mul(area, closeness), normal_velocity));
}

// ---- the contact ----

/// Force, lever and rolling torque of a contact in each lane of `near`; all zero, and the springs
/// too, where the surfaces are apart (and no bridge or adhesion holds them) or the lane is not
/// `near`, whatever its other values are. `near` may hold any lane whose surfaces come closer than
/// reach_beyond_contact. `friction` is model.friction. `time_step` [s] is what the springs advance
/// by: the time over which the positions have moved with `touch.velocity`.
template <bool friction, class D, class V = hn::Vec<D>, class M = hn::Mask<D>>
HWY_INLINE void contact_force(D d, const ContactModel& model, const LawLanes<V>& law,
                              const TouchLanes<V>& touch, V time_step, SpringLanes<V>& spring,
                              M near, ForceLanes<V>& out) {
  M contact = hn::And(near, hn::Gt(touch.overlap, hn::Zero(d)));
  const V normal_velocity = dot(touch.velocity, touch.normal);
  StiffnessLanes<V> stiffness;
  V adhesion = hn::Zero(d);
  if (model.law == ContactLaw::linear) {
    const V overlap = hn::IfThenElseZero(contact, touch.overlap);
    stiffness = linear_stiffness<friction>(d, law, touch.root_mass, overlap);
  } else if (model.cohesion != CohesionLaw::jkr) {
    const V overlap = hn::IfThenElseZero(contact, touch.overlap);
    stiffness = hertz_stiffness<friction>(d, law, touch, overlap, normal_velocity, time_step);
  } else {
    const V smallest = jkr_smallest(d, law, touch.inverse_radius);
    contact = jkr_holds(d, touch, smallest, near, contact, spring.bridge);
    spring.bridge = hn::IfThenElseZero(contact, hn::Set(d, hn::TFromD<D>{1}));
    const V overlap = hn::IfThenElseZero(contact, touch.overlap);
    stiffness =
        jkr_stiffness<friction>(d, law, touch, overlap, smallest, normal_velocity, time_step);
    adhesion = jkr_pressure(d, law, smallest, touch.inverse_radius);
  }
  const V normal_force = hn::NegMulAdd(stiffness.damping, normal_velocity, stiffness.elastic);
  V along = normal_force;
  M acts = contact;
  if (model.cohesion == CohesionLaw::sjkr || model.cohesion == CohesionLaw::liquid_bridge) {
    const V pull = attraction(d, model, law, touch, near, contact, spring.bridge);
    along = hn::Sub(hn::IfThenElseZero(contact, normal_force), pull);
    acts = near;
  }
  if (model.film) {
    const V film = film_force(d, law, touch, normal_velocity);
    along = hn::Add(hn::IfThenElseZero(acts, along), hn::IfThenZeroElse(contact, film));
    acts = near;
  }
  out.force = or_zero(acts, scaled(touch.normal, along));
  if constexpr (friction) {
    const V pressing = hn::Abs(hn::Add(normal_force, adhesion));
    const Lanes3<V> across = friction_force(d, model, law, stiffness, touch, normal_velocity,
                                            pressing, time_step, contact, spring.tangential);
    out.force = {hn::Add(out.force.x, across.x), hn::Add(out.force.y, across.y),
                 hn::Add(out.force.z, across.z)};
    out.lever = or_zero(contact, cross(across, touch.normal));
    if (model.rolling != RollingLaw::none) {
      out.torque = rolling_torque(d, model, law, stiffness, touch, pressing, time_step, contact,
                                  spring.rolling);
    }
  }
}

}  // namespace fluxpact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
