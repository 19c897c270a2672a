#include "dem_server/backends/yade/yade_springs.hpp"

#include <cmath>

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

}  // namespace

double in_series_with(double partner, double wanted) {
  if (partner == 0) return wanted;
  const double given = wanted > 0 ? wanted : 1e-9 * partner;
  return given == partner ? 0 : 1 / (1 / given - 1 / partner);
}

YadeMaterials yade_materials(const ContactLaws& laws, const YadeSpheres& spheres) {
  const double mass = sphere_mass(spheres.radius, spheres.density);
  const int free = spheres.material;
  const int kinds = laws.walls() + 2;
  const PairLaw& own = laws[laws.index(free, free)];
  YadeMaterials materials;
  materials.friction_angle.assign(static_cast<std::size_t>(kinds) * kinds, 0.0);
  const auto set_friction = [&](int kind, double friction) {
    materials.friction_angle[static_cast<std::size_t>(kind)] =
        materials.friction_angle[static_cast<std::size_t>(kind) * kinds] = std::atan(friction);
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
    add(in_series_with(2 * among.kn, contact.kn), in_series_with(2 * among.ks, contact.ks),
        in_series_with(2 * among.cn, contact.cn), in_series_with(2 * among.cs, contact.cs));
    set_friction(kind, law[LawColumn::friction]);
  }
  return materials;
}

int yade_kind(const ParticleState& particles, int row) {
  return particles.is_fixed(row) ? 1 + particles.material[row] : 0;
}

}  // namespace fluxpact
