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

#include "dem_server/backends/native/contact_law.hpp"
#include "hwy/contrib/math/math-inl.h"
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
};

/// What a contact remembers (spring_numbers); parts that the model does not have are neither read
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

// ---- parameters
// -----------------------------------------------------------------------------------------

/// Fills the lanes that `model` uses with `load(column)`.
template <class D, class Load>
HWY_INLINE LawLanes<hn::Vec<D>> load_columns(D d, const ContactModel& model, const Load& load) {
  const auto zero = hn::Zero(d);
  LawLanes<hn::Vec<D>> law{zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero};
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

// ---- vectors
// --------------------------------------------------------------------------------------------

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

// ---- springs and dashpots of the contact as it is
// ----------------------------------------------------

/// F_n = elastic − c v_n, and across it −(k_t ξ + c_t v_t).
template <class V>
struct StiffnessLanes {
  V elastic;             ///< [N] normal force without the dashpot
  V normal;              ///< [N/m] that force over the overlap, without adhesion
  V tangential;          ///< [N/m]
  V damping;             ///< [kg/s]
  V tangential_damping;  ///< [kg/s]
  V spring_kept;         ///< share of the tangential spring that the change of overlap leaves [-]
};

/// Springs and dashpots of constant stiffness (Cundall & Strack, Géotechnique 29, 1979, 47-65):
///   k_n, k_t given,  c = 2 ζ sqrt(k_n m*),  c_t = c/2
template <bool friction, class D, class V>
HWY_INLINE StiffnessLanes<V> linear_stiffness(D d, const LawLanes<V>& law, V root_mass, V overlap) {
  const V damping = hn::Mul(law.damping, root_mass);
  const V tangential_damping = hn::Mul(law.tangential_damping, damping);
  return {hn::Mul(law.normal, overlap), law.normal, law.tangential, damping,
          tangential_damping,           hn::Zero(d)};
}

/// What elastic spheres have at the contact radius a: normal, tangential and the dashpots.
template <bool friction, class D, class V>
HWY_INLINE StiffnessLanes<V> stiffness_of(D d, const LawLanes<V>& law, const TouchLanes<V>& touch,
                                          V radius) {
  using T = hn::TFromD<D>;
  const V zero = hn::Zero(d);
  const V slope = hn::Mul(law.normal, radius);
  const V normal = hn::Mul(hn::Set(d, static_cast<T>(2.0 / 3.0)), slope);
  const V damping = hn::Mul(law.damping, hn::Mul(hn::Sqrt(slope), touch.root_mass));
  if constexpr (!friction) return {zero, normal, zero, damping, zero, zero};
  return {zero,
          normal,
          hn::Mul(law.tangential, radius),
          damping,
          hn::Mul(law.tangential_damping, damping),
          zero};
}

/// Elastic spheres, with the contact radius a = sqrt(R* δ):
///   F_n = 4/3 E* a δ − c v_n,     c = 2 sqrt(5/6) ζ sqrt(S_n m*),   S_n = 2 E* a
///   F_t = −(S_t ξ + c_t v_t),   c_t = 2 sqrt(5/6) ζ sqrt(S_t m*),   S_t = 8 G* a
/// (Hertz 1882; Mindlin, J. Appl. Mech. 16, 1949, 259; damping: Tsuji, Tanaka & Ishida, Powder
/// Technol. 71, 1992, 239, with the ζ of Antypov & Elliott 2011). Area that is newly in contact
/// bears no tangential load, and area that is lost takes its share away: under growing overlap the
/// force S_t ξ stays, so ξ falls by the ratio of the contact radii; under falling overlap ξ stays
/// and the force falls. So the energy S_t ξ²/2 of the spring never grows by a change of overlap
/// (Elata & Berryman, Mech. Mater. 24, 1996, 229). The overlap before the step is δ + v_n dt: the
/// centres have moved with this velocity.
template <bool friction, class D, class V>
HWY_INLINE StiffnessLanes<V> hertz_stiffness(D d, const LawLanes<V>& law,
                                             const TouchLanes<V>& touch, V overlap,
                                             V normal_velocity, V time_step) {
  const V radius = hn::Sqrt(hn::Div(overlap, touch.inverse_radius));
  StiffnessLanes<V> stiffness = stiffness_of<friction>(d, law, touch, radius);
  stiffness.elastic = hn::Mul(stiffness.normal, overlap);
  if constexpr (friction) {
    const V before = hn::Max(hn::Zero(d), hn::MulAdd(normal_velocity, time_step, overlap));
    stiffness.spring_kept = hn::Sqrt(hn::Div(hn::Min(before, overlap), overlap));
  }
  return stiffness;
}

// ---- adhesion of elastic spheres
// ----------------------------------------------------------------------------

/// The smallest contact radius a_c = (π w R*² / 8 E*)^(1/3) [m], at which the surfaces part.
template <class D, class V>
HWY_INLINE V jkr_smallest(D d, const LawLanes<V>& law, V inverse_radius) {
  using T = hn::TFromD<D>;
  const V power = hn::Mul(hn::Set(d, static_cast<T>(-2.0 / 3.0)), hn::Log(d, inverse_radius));
  return hn::Mul(law.attraction, hn::Exp(d, power));
}

/// Where an adhesive contact holds: from δ = 0 on, until δ falls below −3 a_c²/R*.
template <class D, class V, class M>
HWY_INLINE M jkr_holds(D d, const TouchLanes<V>& touch, V smallest, M near, M contact, V held) {
  const V parted = hn::Mul(hn::Set(d, hn::TFromD<D>{-3}),
                           hn::Mul(touch.inverse_radius, hn::Mul(smallest, smallest)));
  return hn::Or(contact,
                hn::And(near, hn::And(hn::Gt(held, hn::Zero(d)), hn::Gt(touch.overlap, parted))));
}

/// The contact radius a, from δ = a²/R* − sqrt(2π w a/E*). With a = a_c y² that is y⁴ − 4 y = D,
/// D = δ R*/a_c² ≥ −3, and y ≥ 1 follows from the root t ≤ 4 of t³ + 4 D t = 16 (Ferrari), to which
/// Newton's method descends from t = 4: six steps to the last bit of a double, from D = −3 to
/// infinity. sqrt(R* δ) where a_c = 0.
template <class D, class V>
HWY_INLINE V jkr_radius(D d, V overlap, V smallest, V inverse_radius) {
  using T = hn::TFromD<D>;
  const V area = hn::Div(overlap, inverse_radius);  // of Hertz' law, over π
  const V depth = hn::Mul(hn::Set(d, T{4}), hn::Div(area, hn::Mul(smallest, smallest)));
  V t = hn::Set(d, T{4});
  for (int step = 0; step < 6; ++step) {
    const V square = hn::Mul(t, t);
    t = hn::Div(hn::MulAdd(hn::Add(t, t), square, hn::Set(d, T{16})),
                hn::MulAdd(hn::Set(d, T{3}), square, depth));
  }
  const V root = hn::Sqrt(t);
  const V rest = hn::Max(hn::Zero(d), hn::Sub(hn::Div(hn::Set(d, T{8}), root), t));
  const V y = hn::Mul(hn::Set(d, static_cast<T>(0.5)), hn::Add(root, hn::Sqrt(rest)));
  const V adhesive = hn::Mul(smallest, hn::Mul(y, y));
  return hn::IfThenElse(hn::Gt(smallest, hn::Zero(d)), adhesive,
                        hn::Sqrt(hn::Max(hn::Zero(d), area)));
}

/// Hertz' law with adhesion of the work w per area (Johnson, Kendall & Roberts, Proc. R. Soc. A
/// 324, 1971, 301):
///   F = 4 E* a³/(3 R*) − sqrt(8π w E* a³) − c v_n
/// with the stiffnesses and dashpots of Hertz' law at this a. The largest pull is 3/2 π w R*.
template <bool friction, class D, class V>
HWY_INLINE StiffnessLanes<V> jkr_stiffness(D d, const LawLanes<V>& law, const TouchLanes<V>& touch,
                                           V overlap, V smallest, V normal_velocity, V time_step) {
  using T = hn::TFromD<D>;
  const V radius = jkr_radius(d, overlap, smallest, touch.inverse_radius);
  StiffnessLanes<V> stiffness = stiffness_of<friction>(d, law, touch, radius);
  // 2/3 (2 E*)/R* (a³ − 6 (a a_c)^(3/2))
  const V mixed = hn::Mul(radius, smallest);
  const V pulled = hn::Mul(hn::Set(d, T{-6}), hn::Mul(mixed, hn::Sqrt(mixed)));
  const V cube = hn::MulAdd(hn::Mul(radius, radius), radius, pulled);
  stiffness.elastic = hn::Mul(hn::Mul(hn::Set(d, static_cast<T>(2.0 / 3.0)), law.normal),
                              hn::Mul(touch.inverse_radius, cube));
  if constexpr (friction) {
    const V before = hn::MulAdd(normal_velocity, time_step, overlap);
    const V least =
        hn::Mul(hn::Set(d, T{-3}), hn::Mul(touch.inverse_radius, hn::Mul(smallest, smallest)));
    const V old = jkr_radius(d, hn::Max(before, least), smallest, touch.inverse_radius);
    stiffness.spring_kept = hn::Div(hn::Min(old, radius), radius);
  }
  return stiffness;
}

/// What an adhesive contact adds to the normal force in the limits of friction and rolling: twice
/// the largest pull, 3π w R* (Thornton, J. Phys. D 24, 1991, 1942).
template <class D, class V>
HWY_INLINE V jkr_pressure(D d, const LawLanes<V>& law, V smallest, V inverse_radius) {
  const V cube = hn::Mul(smallest, hn::Mul(smallest, smallest));
  return hn::Mul(hn::Mul(hn::Set(d, hn::TFromD<D>{12}), law.normal), hn::Mul(inverse_radius, cube));
}

// ---- friction
// -------------------------------------------------------------------------------------------

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
  if (!hn::AllFalse(d, slides)) {
    const Lanes3<V> most = scaled(force, hn::Div(limit, hn::Sqrt(square)));
    V softness = hn::Neg(law.tangential_softness);
    if (model.law == ContactLaw::hertz) {
      softness = hn::Div(hn::Set(d, hn::TFromD<D>{-1}), stiffness.tangential);
    }
    const Lanes3<V> elastic = plus_scaled(most, stiffness.tangential_damping, slip);
    force = select(slides, most, force);
    xi = select(slides, scaled(elastic, softness), xi);
  }
  spring = or_zero(contact, xi);
  return or_zero(contact, force);
}

// ---- rolling
// --------------------------------------------------------------------------------------------

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

// ---- cohesion
// -------------------------------------------------------------------------------------------

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

// ---- the contact
// ----------------------------------------------------------------------------------------

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
