#include "dem_server/backends/yade/yade_springs.hpp"

#include <cmath>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

/// The numbers of one contact.
struct Contact {
  double kn, ks;  // [N/m]
  double cn, cs;  // [kg/s]
};

Contact contact_of(const PairLaw& law, double effective_mass) {
  const double damping = damping_coefficient(law, effective_mass);
  return {law[LawColumn::normal], law[LawColumn::tangential], damping,
          law[LawColumn::tangential_damping] * damping};
}

[[noreturn]] void refuse(const ContactLaws& laws, int free, int other, const char* key,
                         const char* allowed) {
  throw ConfigError(
      "particles.contact.pairs: the {} of [{}, {}] beside that of [{}, {}]: particles.backend: "
      "yade gives springs to bodies and puts those of two in series, so that {}; change one of "
      "them, or use another engine",
      key, laws.name(free), laws.name(other), laws.name(free), laws.name(free), allowed);
}

}  // namespace

std::optional<double> in_series_with(double partner, double wanted) {
  if (partner == 0) return wanted;
  // A rounding error beyond is the same number.
  if (!(wanted > 0) || wanted > partner * (1 + 1e-12)) return std::nullopt;
  return wanted >= partner ? 0 : 1 / (1 / wanted - 1 / partner);
}

YadeMaterials yade_materials(const ContactLaws& laws, const YadeSpheres& spheres) {
  const double mass = sphere_mass(spheres.radius, spheres.density);
  const int free = spheres.material;
  const int kinds = laws.walls() + 2;
  const PairLaw& own = laws[laws.index(free, free)];
  YadeMaterials materials;
  materials.friction_angle.assign(static_cast<std::size_t>(kinds * kinds), 0.0);
  const auto set_friction = [&](int kind, double friction) {
    materials.friction_angle[static_cast<std::size_t>(kind)] =
        materials.friction_angle[static_cast<std::size_t>(kind * kinds)] = std::atan(friction);
  };
  const auto add = [&](double kn, double ks, double cn, double cs) {
    materials.kn.push_back(kn);
    materials.ks.push_back(ks);
    materials.cn.push_back(cn);
    materials.cs.push_back(cs);
  };
  const Contact among = contact_of(own, mass / 2);
  add(2 * among.kn, 2 * among.ks, 2 * among.cn, 2 * among.cs);
  set_friction(0, own[LawColumn::friction]);
  for (int kind = 1; kind < kinds; ++kind) {
    const int other = kind - 1;
    const PairLaw& law = laws[laws.index(free, other)].given ? laws[laws.index(free, other)] : own;
    const Contact contact = contact_of(law, mass);
    const auto kn = in_series_with(2 * among.kn, contact.kn);
    const auto ks = in_series_with(2 * among.ks, contact.ks);
    const auto cn = in_series_with(2 * among.cn, contact.cn);
    const auto cs = in_series_with(2 * among.cs, contact.cs);
    if (!kn) refuse(laws, free, other, "normal_stiffness", "it is at most twice that");
    if (!ks) refuse(laws, free, other, "tangential_stiffness", "it is at most twice that");
    if (!cn || !cs) {
      refuse(laws, free, other, "restitution",
             "the dashpot |ln e| sqrt(m* k / (pi^2 + ln^2 e)) is at most twice that, and not 0");
    }
    add(*kn, *ks, *cn, *cs);
    set_friction(kind, law[LawColumn::friction]);
  }
  return materials;
}

int yade_kind(const ParticleState& particles, int row) {
  return particles.is_fixed(row) ? 1 + particles.material[row] : 0;
}

}  // namespace fluxpact
