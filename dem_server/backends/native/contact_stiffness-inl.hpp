// Springs and dashpots of a contact at its overlap: the linear law, Hertz', and Hertz' with
// adhesion. For contact_force-inl.hpp.
#if defined(FLUXPACT_CONTACT_STIFFNESS_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef FLUXPACT_CONTACT_STIFFNESS_INL_
#undef FLUXPACT_CONTACT_STIFFNESS_INL_
#else
#define FLUXPACT_CONTACT_STIFFNESS_INL_
#endif

#include "dem_server/backends/native/contact_lanes-inl.hpp"
#include "hwy/contrib/math/math-inl.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace fluxpact::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// ---- springs and dashpots of the contact as it is ----

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

// ---- adhesion of elastic spheres ----

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

}  // namespace fluxpact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
