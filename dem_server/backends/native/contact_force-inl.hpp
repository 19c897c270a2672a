// The force of one contact, in vector lanes: one contact a lane, for any instruction set. Included by
// contact_pass.cpp once for each instruction set (Highway's foreach_target), hence the unusual guard.
#if defined(FLUXPACT_CONTACT_FORCE_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef FLUXPACT_CONTACT_FORCE_INL_
#undef FLUXPACT_CONTACT_FORCE_INL_
#else
#define FLUXPACT_CONTACT_FORCE_INL_
#endif

#include <hwy/highway.h>

#include "dem_server/backends/native/contact_law.hpp"

HWY_BEFORE_NAMESPACE();
namespace fluxpact::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class V>
struct Lanes3 {
  V x, y, z;
};

/// One contact a lane, seen from the particle on which the force is wanted.
template <class V>
struct TouchLanes {
  Lanes3<V> normal;       // unit, from the partner to the particle
  V overlap;              // [m]
  Lanes3<V> velocity;     // [m/s] of the particle's centre relative to the partner's
  Lanes3<V> radius_spin;  // [m/s] sum of radius x spin rate over both
  V root_mass;            // [kg^0.5] of the effective mass
};

template <class V>
struct LawLanes {
  V normal_stiffness, tangential_stiffness, inverse_tangential_stiffness, damping, friction;
};

template <class V>
struct ForceLanes {
  Lanes3<V> force, lever;
};

template <class V>
HWY_INLINE V dot(const Lanes3<V>& a, const Lanes3<V>& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

template <bool friction, class D, class V = hn::Vec<D>>
HWY_INLINE void contact_force(D d, const LawLanes<V>& law, const TouchLanes<V>& touch, V time_step,
                              Lanes3<V>& spring, hn::Mask<D> touching, ForceLanes<V>& out) {
  const Lanes3<V>& n = touch.normal;
  const Lanes3<V>& v = touch.velocity;
  const V damping = hn::Mul(law.damping, touch.root_mass);
  const V approach = dot(v, n);
  const V normal =
      hn::NegMulAdd(damping, approach, hn::Mul(law.normal_stiffness, touch.overlap));
  const V pressed = hn::IfThenElseZero(touching, normal);
  out.force = {hn::Mul(pressed, n.x), hn::Mul(pressed, n.y), hn::Mul(pressed, n.z)};
  if constexpr (friction) {
    const Lanes3<V>& w = touch.radius_spin;
    const Lanes3<V> slip{
        hn::Sub(hn::NegMulAdd(approach, n.x, v.x), hn::MulSub(w.y, n.z, hn::Mul(w.z, n.y))),
        hn::Sub(hn::NegMulAdd(approach, n.y, v.y), hn::MulSub(w.z, n.x, hn::Mul(w.x, n.z))),
        hn::Sub(hn::NegMulAdd(approach, n.z, v.z), hn::MulSub(w.x, n.y, hn::Mul(w.y, n.x)))};
    Lanes3<V> xi{hn::MulAdd(time_step, slip.x, spring.x), hn::MulAdd(time_step, slip.y, spring.y),
                 hn::MulAdd(time_step, slip.z, spring.z)};
    const V along = dot(xi, n);
    xi = {hn::NegMulAdd(along, n.x, xi.x), hn::NegMulAdd(along, n.y, xi.y),
          hn::NegMulAdd(along, n.z, xi.z)};
    const V half = hn::Mul(hn::Set(d, 0.5), damping);
    const Lanes3<V> dash{hn::Mul(half, slip.x), hn::Mul(half, slip.y), hn::Mul(half, slip.z)};
    const V kt = law.tangential_stiffness;
    Lanes3<V> t{hn::MulAdd(kt, xi.x, dash.x), hn::MulAdd(kt, xi.y, dash.y),
                hn::MulAdd(kt, xi.z, dash.z)};  // minus the force
    const V limit = hn::Mul(law.friction, hn::Abs(normal));
    const V square = dot(t, t);
    const auto slides = hn::Gt(square, hn::Mul(limit, limit));
    if (!hn::AllFalse(d, slides)) {
      const V share = hn::IfThenElse(slides, hn::Div(limit, hn::Sqrt(square)), hn::Set(d, 1));
      t = {hn::Mul(share, t.x), hn::Mul(share, t.y), hn::Mul(share, t.z)};
      const V inverse = law.inverse_tangential_stiffness;
      xi = {hn::IfThenElse(slides, hn::Mul(inverse, hn::Sub(t.x, dash.x)), xi.x),
            hn::IfThenElse(slides, hn::Mul(inverse, hn::Sub(t.y, dash.y)), xi.y),
            hn::IfThenElse(slides, hn::Mul(inverse, hn::Sub(t.z, dash.z)), xi.z)};
    }
    t = {hn::IfThenElseZero(touching, t.x), hn::IfThenElseZero(touching, t.y),
         hn::IfThenElseZero(touching, t.z)};
    spring = {hn::IfThenElseZero(touching, xi.x), hn::IfThenElseZero(touching, xi.y),
              hn::IfThenElseZero(touching, xi.z)};
    out.force = {hn::Sub(out.force.x, t.x), hn::Sub(out.force.y, t.y), hn::Sub(out.force.z, t.z)};
    // -n x F_t = n x t
    out.lever = {hn::MulSub(n.y, t.z, hn::Mul(n.z, t.y)), hn::MulSub(n.z, t.x, hn::Mul(n.x, t.z)),
                 hn::MulSub(n.x, t.y, hn::Mul(n.y, t.x))};
  }
}

}  // namespace fluxpact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
