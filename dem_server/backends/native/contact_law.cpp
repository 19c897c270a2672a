#include "dem_server/backends/native/contact_law.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

void check_range(const PairSettings& pair, const char* key, double value, bool fits,
                 const char* allowed) {
  if (fits) return;
  throw ConfigError("particles.contact.pairs: [{}, {}] has {} = {}; it must be {}", pair.between[0],
                    pair.between[1], key, value, allowed);
}

PairLaw make_law(const PairSettings& pair) {
  const double tangential = pair.tangential_stiffness.value_or(2.0 / 7.0 * pair.normal_stiffness);
  check_range(pair, "normal_stiffness", pair.normal_stiffness, pair.normal_stiffness > 0,
              "positive [N/m]");
  check_range(pair, "tangential_stiffness", tangential, tangential > 0, "positive [N/m]");
  check_range(pair, "restitution", pair.restitution, pair.restitution >= 0 && pair.restitution <= 1,
              "between 0 and 1");
  check_range(pair, "friction", pair.friction, pair.friction >= 0, "zero or positive");
  return {pair.normal_stiffness, tangential, damping_ratio(pair.restitution), pair.friction, true};
}

/// Count and lightest mass of the particles of each material.
struct Present {
  int count = 0;
  double lightest = std::numeric_limits<double>::infinity();
};

std::vector<Present> count_materials(const ContactLaws& laws, const ParticleState& particles) {
  std::vector<Present> present(laws.walls());
  for (int row = 0; row < particles.size(); ++row) {
    Present& material = present[particles.material[row]];
    ++material.count;
    material.lightest =
        std::min(material.lightest, sphere_mass(particles.radius[row], particles.density[row]));
  }
  return present;
}

}  // namespace

double sphere_mass(double radius, double density) {
  return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius * density;
}

double damping_ratio(double restitution) {
  if (restitution <= 0) return 1.0;
  const double log_e = std::log(restitution);
  return -log_e / std::sqrt(std::numbers::pi * std::numbers::pi + log_e * log_e);
}

double damping_coefficient(const PairLaw& law, double effective_mass) {
  return 2.0 * law.damping_ratio * std::sqrt(law.normal_stiffness * effective_mass);
}

ContactLaws::ContactLaws(const ParticleSettings& settings) {
  for (const auto& [name, material] : settings.materials) names_.push_back(name);
  names_.emplace_back("walls");
  laws_.resize(names_.size() * names_.size());
  for (const PairSettings& pair : settings.contact.pairs) {
    const int a = find(pair.between[0]);
    const int b = find(pair.between[1]);
    if (laws_[index(a, b)].given) {
      throw ConfigError("particles.contact.pairs: [{}, {}] stands twice; keep one of them",
                        pair.between[0], pair.between[1]);
    }
    laws_[index(a, b)] = laws_[index(b, a)] = make_law(pair);
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

bool ContactLaws::any_friction() const {
  return std::any_of(laws_.begin(), laws_.end(),
                     [](const PairLaw& law) { return law.friction > 0; });
}

StepLimit step_limit(const ContactLaws& laws, const ParticleState& particles, bool walls) {
  const std::vector<Present> present = count_materials(laws, particles);
  StepLimit limit{std::numeric_limits<double>::infinity(), ""};
  const auto consider = [&](int a, int b, double effective_mass) {
    const PairLaw& law = laws[laws.index(a, b)];
    const std::string pair = fmt::format("[{}, {}]", laws.name(a), laws.name(b));
    if (!law.given) {
      throw ConfigError(
          "particles.contact.pairs: no entry between {}, and the particles of this scene can meet; "
          "add one with normal_stiffness, restitution and friction",
          pair);
    }
    double stiffness = law.normal_stiffness;
    if (law.friction > 0) stiffness = std::max(stiffness, 3.5 * law.tangential_stiffness);
    const double longest = 0.1 * std::numbers::pi * std::sqrt(effective_mass / stiffness);
    if (longest < limit.longest) limit = {longest, pair};
  };
  for (int a = 0; a < laws.walls(); ++a) {
    if (present[a].count == 0) continue;
    if (walls) consider(a, laws.walls(), present[a].lightest);
    for (int b = a; b < laws.walls(); ++b) {
      if (present[b].count == 0 || (a == b && present[a].count < 2)) continue;
      const double mass_a = present[a].lightest;
      const double mass_b = present[b].lightest;
      consider(a, b, mass_a * mass_b / (mass_a + mass_b));
    }
  }
  return limit;
}

}  // namespace fluxpact
