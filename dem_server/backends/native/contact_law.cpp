#include "dem_server/backends/native/contact_law.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

using std::numbers::pi;

/// Checks one number of a pair after another.
struct PairCheck {
  const PairSettings& pair;

  void range(const char* key, double value, bool fits, const char* allowed) const {
    if (fits) return;
    throw ConfigError("particles.contact.pairs: [{}, {}] has {} = {}; it must be {}",
                      pair.between[0], pair.between[1], key, value, allowed);
  }
  double needed(const char* key, const std::optional<double>& value) const {
    if (value) return *value;
    throw ConfigError("particles.contact.pairs: [{}, {}] has no {}, which the contact laws need",
                      pair.between[0], pair.between[1], key);
  }
  double not_negative(const char* key, const std::optional<double>& value) const {
    const double number = needed(key, value);
    range(key, number, number >= 0, "zero or positive");
    return number;
  }
};

struct Elasticity {
  double youngs_modulus;  ///< [Pa]
  double poisson_ratio;   ///< [-]
};

double shear_modulus(const Elasticity& one) {
  return one.youngs_modulus / (2 * (1 + one.poisson_ratio));
}

/// 1/E* = Σ (1 - ν²)/E (Hertz 1882; Johnson, Contact Mechanics, 1985, eq. 4.20).
double effective_modulus(const Elasticity& a, const Elasticity& b) {
  const auto compliance = [](const Elasticity& one) {
    return (1 - one.poisson_ratio * one.poisson_ratio) / one.youngs_modulus;
  };
  return 1 / (compliance(a) + compliance(b));
}

/// 1/G* = Σ (2 - ν)/G (Mindlin 1949; Johnson eq. 7.43).
double effective_shear_modulus(const Elasticity& a, const Elasticity& b) {
  const auto compliance = [](const Elasticity& one) {
    return (2 - one.poisson_ratio) / shear_modulus(one);
  };
  return 1 / (compliance(a) + compliance(b));
}

void set_linear(const PairCheck& check, PairLaw& law) {
  const double normal = check.needed("normal_stiffness", check.pair.normal_stiffness);
  const double tangential = check.pair.tangential_stiffness.value_or(2.0 / 7.0 * normal);
  check.range("normal_stiffness", normal, normal > 0, "positive [N/m]");
  check.range("tangential_stiffness", tangential, tangential > 0, "positive [N/m]");
  law[LawColumn::normal] = normal;
  law[LawColumn::tangential] = tangential;
  law[LawColumn::tangential_softness] = 1 / tangential;
  law[LawColumn::damping] = 2 * damping_ratio(check.pair.restitution) * std::sqrt(normal);
  law[LawColumn::tangential_damping] = 0.5;
}

void set_hertz(const PairCheck& check, const Elasticity& a, const Elasticity& b, PairLaw& law) {
  const double normal = 2 * effective_modulus(a, b);
  const double tangential = 8 * effective_shear_modulus(a, b);
  law[LawColumn::normal] = normal;
  law[LawColumn::tangential] = tangential;
  law[LawColumn::damping] = 2 * std::sqrt(5.0 / 6.0) * damping_ratio(check.pair.restitution);
  law[LawColumn::tangential_damping] = std::sqrt(tangential / normal);
}

void set_rolling(const PairCheck& check, RollingLaw rolling, PairLaw& law) {
  if (rolling == RollingLaw::none) return;
  const double friction = check.not_negative("rolling_friction", check.pair.rolling_friction);
  law[LawColumn::rolling_friction] = friction;
  if (rolling == RollingLaw::constant_torque) return;
  law[LawColumn::rolling_stiffness] = 2.25 * friction * friction;
  law[LawColumn::rolling_damping] = check.pair.rolling_damping.value_or(0.3);
  check.not_negative("rolling_damping", law[LawColumn::rolling_damping]);
}

void set_cohesion(const PairCheck& check, CohesionLaw cohesion, PairLaw& law) {
  if (cohesion == CohesionLaw::sjkr) {
    law[LawColumn::attraction] =
        2 * pi * check.not_negative("cohesion_energy_density", check.pair.cohesion_energy_density);
  } else if (cohesion == CohesionLaw::jkr) {
    const double work = check.not_negative("work_of_adhesion", check.pair.work_of_adhesion);
    law[LawColumn::attraction] = std::cbrt(pi * work / (4 * law[LawColumn::normal]));
  } else if (cohesion == CohesionLaw::liquid_bridge) {
    const double volume = check.not_negative("liquid_volume", check.pair.liquid_volume);
    const double tension = check.not_negative("surface_tension", check.pair.surface_tension);
    const double angle = check.not_negative("contact_angle", check.pair.contact_angle);
    check.range("contact_angle", angle, angle <= pi / 2, "at most pi/2 [rad]");
    if (volume == 0) return;
    law[LawColumn::attraction] = 4 * pi * tension * std::cos(angle);
    law[LawColumn::bridge_shape] = 2 / volume;
    law[LawColumn::bridge_rupture] = (1 + 0.5 * angle) * std::cbrt(volume);
  }
}

Elasticity checked(const std::string& where, std::optional<double> modulus,
                   std::optional<double> ratio) {
  if (!modulus || !ratio) {
    throw ConfigError(
        "{}: youngs_modulus and poisson_ratio are missing; particles.contact.law: hertz needs them",
        where);
  }
  if (!(*modulus > 0 && *ratio > -1 && *ratio <= 0.5)) {
    throw ConfigError(
        "{}: youngs_modulus = {}, poisson_ratio = {}; they must be > 0 [Pa], and > -1 and <= 0.5",
        where, *modulus, *ratio);
  }
  return {*modulus, *ratio};
}

/// By material, then the walls (if they are given). Empty for a law that has no need of it.
std::vector<Elasticity> elasticities(const ParticleSettings& settings) {
  std::vector<Elasticity> all;
  if (settings.contact.law != ContactLaw::hertz) return all;
  for (const auto& [name, material] : settings.materials) {
    all.push_back(
        checked("particles.materials." + name, material.youngs_modulus, material.poisson_ratio));
  }
  const auto& walls = settings.contact.walls;
  if (walls) {
    all.push_back(checked("particles.contact.walls", walls->youngs_modulus, walls->poisson_ratio));
  }
  return all;
}

}  // namespace

double sphere_mass(double radius, double density) {
  return 4.0 / 3.0 * pi * radius * radius * radius * density;
}

double damping_ratio(double restitution) {
  if (restitution <= 0) return 1.0;
  const double log_e = std::log(restitution);
  return -log_e / std::sqrt(pi * pi + log_e * log_e);
}

double damping_coefficient(const PairLaw& law, double effective_mass) {
  return law[LawColumn::damping] * std::sqrt(effective_mass);
}

int spring_rows(const ContactModel& model) {
  if (model.rolling == RollingLaw::spring_dashpot) return 2;
  return model.friction || outlasts_touch(model.cohesion) ? 1 : 0;
}

SpringNumbers spring_numbers(const ContactModel& model) {
  SpringNumbers numbers;
  const auto add = [&numbers](int first, int last) {
    for (int place = first; place < last; ++place) {
      numbers.place[numbers.count++] = static_cast<std::uint8_t>(place);
    }
  };
  if (model.friction) add(0, 3);
  if (outlasts_touch(model.cohesion)) add(3, 4);
  if (model.rolling == RollingLaw::spring_dashpot) add(4, 7);
  return numbers;
}

ContactLaws::ContactLaws(const ParticleSettings& settings, const std::optional<Film>& film) {
  const ContactSettings& contact = settings.contact;
  for (const auto& [name, material] : settings.materials) names_.push_back(name);
  names_.emplace_back("walls");
  laws_.resize(names_.size() * names_.size());
  if (contact.cohesion == CohesionLaw::jkr && contact.law != ContactLaw::hertz) {
    throw ConfigError("particles.contact.cohesion: jkr needs particles.contact.law: hertz");
  }
  model_ = {contact.law, contact.rolling, contact.cohesion, film.has_value(),
            contact.rolling != RollingLaw::none};
  const std::vector<Elasticity> elastic = elasticities(settings);
  for (const Elasticity& one : elastic) {
    rayleigh_factors_.push_back(pi / std::sqrt(shear_modulus(one)) /
                                (0.1631 * one.poisson_ratio + 0.8766));
  }
  for (const PairSettings& pair : contact.pairs) {
    const int a = find(pair.between[0]);
    const int b = find(pair.between[1]);
    if (laws_[index(a, b)].given) {
      throw ConfigError("particles.contact.pairs: [{}, {}] stands twice; keep one of them",
                        pair.between[0], pair.between[1]);
    }
    const PairCheck check{pair};
    check.range("restitution", pair.restitution, pair.restitution >= 0 && pair.restitution <= 1,
                "between 0 and 1");
    PairLaw law;
    law.given = true;
    law[LawColumn::friction] = check.not_negative("friction", pair.friction);
    if (contact.law == ContactLaw::linear) {
      set_linear(check, law);
    } else if (const auto last = static_cast<std::size_t>(std::max(a, b)); last < elastic.size()) {
      set_hertz(check, elastic[a], elastic[b], law);
    } else {
      throw ConfigError(
          "particles.contact.walls: missing; the pair [{}, {}] needs the youngs_modulus and "
          "poisson_ratio of the walls with particles.contact.law: hertz",
          pair.between[0], pair.between[1]);
    }
    set_rolling(check, contact.rolling, law);
    set_cohesion(check, contact.cohesion, law);
    if (film) {
      law[LawColumn::film_viscosity] = 6 * pi * film->viscosity;
      law[LawColumn::film_thinnest] = film->roughness;
      law[LawColumn::film_closeness] = 1 / film->reach;
    }
    model_.friction = model_.friction || law[LawColumn::friction] > 0;
    laws_[index(a, b)] = laws_[index(b, a)] = law;
  }
}

int ContactLaws::find(const std::string& name) const {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found == names_.end()) {
    throw ConfigError(
        "particles.contact.pairs: `{}` is neither a material of particles.materials nor `walls`",
        name);
  }
  return static_cast<int>(found - names_.begin());
}

double reach_beyond_contact(const ContactLaws& laws, double largest_radius) {
  double reach = 0;
  for (int pair = 0; pair < laws.count(); ++pair) {
    const PairLaw& law = laws[pair];
    reach = std::max(reach, law[LawColumn::bridge_rupture]);
    if (laws.model().film && law.given) {
      reach = std::max(reach, 1 / law[LawColumn::film_closeness]);
    }
    if (laws.model().cohesion == CohesionLaw::jkr) {
      // 3 a_c²/R*, which grows with R*; that of a contact with a wall is the radius.
      const double factor = law[LawColumn::attraction];
      reach = std::max(reach, 3 * factor * factor * std::cbrt(largest_radius));
    }
  }
  return reach;
}

template <class T>
LawTable<T> law_table(const ContactLaws& laws) {
  LawTable<T> table{laws.model(), laws.count(), true, 0, {}};
  table.values.resize(static_cast<std::size_t>(law_columns) *
                      static_cast<std::size_t>(laws.count()));
  bool found = false;
  for (int pair = 0; pair < laws.count(); ++pair) {
    const PairLaw& law = laws[pair];
    if (!law.given) continue;
    if (!found) table.any = pair;
    found = true;
    table.one_law = table.one_law && std::equal(std::begin(law.column), std::end(law.column),
                                                std::begin(laws[table.any].column));
    for (int column = 0; column < law_columns; ++column) {
      table.values[static_cast<std::size_t>(column) * laws.count() + pair] =
          static_cast<T>(law.column[column]);
    }
  }
  return table;
}
template LawTable<double> law_table(const ContactLaws&);
template LawTable<float> law_table(const ContactLaws&);

}  // namespace fluxpact
