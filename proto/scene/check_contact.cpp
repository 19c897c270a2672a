// Which keys of materials and pairs the contact laws of particles.contact need, and which have no
// meaning with them.
#include <algorithm>

#include "proto/scene/check.hpp"
#include "proto/scene/names.hpp"

namespace fluxpact {
namespace {

/// A key that goes with some laws only.
struct ConditionalKey {
  std::string_view name;
  bool given;
  bool applies;
  bool needed;                 ///< where it applies
  std::string_view condition;  ///< when it applies
  std::string_view example;
};

void check_key(const std::string& section, const ConditionalKey& key, Findings& findings) {
  const std::string path = fmt::format("{}.{}", section, key.name);
  if (!findings.sound(path)) return;
  if (key.given && !key.applies) {
    findings.add(path, fmt::format("has no meaning here, only with particles.contact.{}; remove it",
                                   key.condition));
  } else if (key.applies && key.needed && !key.given) {
    findings.add(path, fmt::format("missing; required with particles.contact.{}, e.g. {}: {}",
                                   key.condition, key.name, key.example));
  }
}

constexpr std::string_view linear = "law: linear";
constexpr std::string_view hertz = "law: hertz";

/// Hard spheres have no springs, but beds that settle before the start do so on springs.
bool wants_springs(const ParticleSettings& particles) {
  return particles.backend != ParticleBackend::hard_sphere ||
         std::ranges::any_of(particles.insertion, [](const InsertionSettings& entry) {
           return entry.type == InsertionType::settled;
         });
}

void check_tangential_restitution(const std::string& pair, const PairSettings& settings,
                                  ParticleBackend backend, Findings& findings) {
  const std::string path = pair + ".tangential_restitution";
  if (!settings.tangential_restitution || backend == ParticleBackend::hard_sphere) return;
  if (!findings.sound(path) || !findings.sound("particles.backend")) return;
  findings.add(path,
               "has no meaning here, only with particles.backend: hard_sphere (springs have "
               "their tangential_stiffness); remove it");
}

void check_pair_keys(const std::string& path, const PairSettings& pair,
                     const ContactSettings& contact, bool springs_needed, Findings& findings) {
  const bool is_linear = contact.law == ContactLaw::linear;
  const bool rolls = contact.rolling != RollingLaw::none;
  const bool springs = contact.rolling == RollingLaw::spring_dashpot;
  const bool sticks = contact.cohesion == CohesionLaw::sjkr;
  const bool wet = contact.cohesion == CohesionLaw::liquid_bridge;
  constexpr std::string_view any_rolling = "rolling: constant_torque | spring_dashpot";
  constexpr std::string_view bridge = "cohesion: liquid_bridge";
  const ConditionalKey keys[] = {
      {"normal_stiffness", pair.normal_stiffness.has_value(), is_linear, springs_needed, linear,
       "1000"},
      {"tangential_stiffness", pair.tangential_stiffness.has_value(), is_linear, false, linear, ""},
      {"rolling_friction", pair.rolling_friction.has_value(), rolls, true,
       springs ? "rolling: spring_dashpot"
       : rolls ? "rolling: constant_torque"
               : any_rolling,
       "0.01"},
      {"rolling_damping", pair.rolling_damping.has_value(), springs, false,
       "rolling: spring_dashpot", ""},
      {"cohesion_energy_density", pair.cohesion_energy_density.has_value(), sticks, true,
       "cohesion: sjkr", "1e4 J/m3"},
      {"work_of_adhesion", pair.work_of_adhesion.has_value(), contact.cohesion == CohesionLaw::jkr,
       true, "cohesion: jkr", "0.05 J/m2"},
      {"liquid_volume", pair.liquid_volume.has_value(), wet, true, bridge, "0.01 mm3"},
      {"surface_tension", pair.surface_tension.has_value(), wet, true, bridge, "0.072"},
      {"contact_angle", pair.contact_angle.has_value(), wet, true, bridge, "0"},
  };
  for (const ConditionalKey& key : keys) check_key(path, key, findings);
}

}  // namespace

void check_contact_laws(const Scene& scene, Findings& findings) {
  const ContactSettings& contact = scene.particles.contact;
  for (const char* path : {"particles.contact.law", "particles.contact.rolling",
                           "particles.contact.cohesion", "particles.contact.pairs"}) {
    if (!findings.sound(path)) return;
  }
  const bool is_hertz = contact.law == ContactLaw::hertz;
  if (contact.cohesion == CohesionLaw::jkr && !is_hertz) {
    findings.add("particles.contact.cohesion",
                 "`jkr` is the adhesion of elastic spheres and has no meaning without "
                 "particles.contact.law: hertz; use that, or `sjkr`");
    return;
  }
  for (const auto& [name, material] : scene.particles.materials) {
    const std::string path = "particles.materials." + name;
    check_key(
        path,
        {"youngs_modulus", material.youngs_modulus.has_value(), is_hertz, true, hertz, "10 MPa"},
        findings);
    check_key(path,
              {"poisson_ratio", material.poisson_ratio.has_value(), is_hertz, true, hertz, "0.25"},
              findings);
  }
  const bool any_wall =
      std::any_of(contact.pairs.begin(), contact.pairs.end(), [](const PairSettings& pair) {
        return pair.between[0] == "walls" || pair.between[1] == "walls";
      });
  check_key("particles.contact",
            {"walls", contact.walls.has_value(), is_hertz, any_wall, hertz,
             "{youngs_modulus: 10 MPa, poisson_ratio: 0.25}"},
            findings);
  for (std::size_t i = 0; i < contact.pairs.size(); ++i) {
    const std::string path = fmt::format("particles.contact.pairs[{}]", i);
    check_pair_keys(path, contact.pairs[i], contact, wants_springs(scene.particles), findings);
    check_tangential_restitution(path, contact.pairs[i], scene.particles.backend, findings);
  }
}

}  // namespace fluxpact
