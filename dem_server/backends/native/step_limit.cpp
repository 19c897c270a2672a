#include "dem_server/backends/native/step_limit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double share_of_contact_time = 0.1;
constexpr double share_of_rayleigh_time = 0.2;
// A sphere between ten others still feels less than the 2 at which an explicit dashpot goes astray.
constexpr double share_of_film_time = 0.2;

/// The particles of one material, either the free or the fixed ones.
struct Present {
  int count = 0;
  double lightest = infinity;  ///< [kg]; fixed ones are infinitely heavy
  double smallest = infinity;  ///< radius [m]
  double largest = 0;          ///< radius [m]
  double rayleigh = infinity;  ///< smallest r sqrt(ρ)
  double fastest = 0;          ///< [m/s]
};

/// The free ones of each material, then the fixed ones of each.
std::vector<Present> count_materials(const ContactLaws& laws, const ParticleState& particles) {
  std::vector<Present> present(2 * static_cast<std::size_t>(laws.walls()));
  for (int row = 0; row < particles.size(); ++row) {
    const bool fixed = particles.is_fixed(row);
    Present& material = present[particles.material[row] + (fixed ? laws.walls() : 0)];
    const double radius = particles.radius[row];
    const double density = particles.density[row];
    ++material.count;
    if (!fixed) material.lightest = std::min(material.lightest, sphere_mass(radius, density));
    material.smallest = std::min(material.smallest, radius);
    material.largest = std::max(material.largest, radius);
    material.rayleigh = std::min(material.rayleigh, radius * std::sqrt(density));
    material.fastest = std::max(material.fastest, particles.velocity[row].norm());
  }
  return present;
}

/// Two materials, or a material and walls, that can meet.
struct Meeting {
  const PairLaw& law;
  std::string name;
  double mass;    ///< m* of the lightest [kg]
  double radius;  ///< R* of the smallest [m]
  double widest;  ///< R* of the largest [m]
  double uneven;  ///< R* of the smallest of one beside the largest of the other [m]
  double speed;   ///< [m/s]
};

/// What the stiffest motion of the contact has over k_n (linear) or S_n (hertz).
double stiffening(const PairLaw& law) {
  double spin = 2.5 * law[LawColumn::rolling_stiffness];
  if (law[LawColumn::friction] > 0) {
    spin += 3.5 * law[LawColumn::tangential] / law[LawColumn::normal];
  }
  return std::max(1.0, spin);
}

StepLimit limit_of(const Meeting& meeting, const ContactModel& model) {
  const PairLaw& law = meeting.law;
  if (model.law == ContactLaw::linear) {
    const double stiffness = law[LawColumn::normal] * stiffening(law);
    const double contact = std::numbers::pi * std::sqrt(meeting.mass / stiffness);
    return {share_of_contact_time * contact,
            fmt::format("a tenth of the contact time of {}, {:.4g} s", meeting.name, contact)};
  }
  if (meeting.speed == 0) return {infinity, ""};
  const double modulus = 0.5 * law[LawColumn::normal];
  const double contact =
      2.868 *
      std::pow(meeting.mass * meeting.mass / (meeting.radius * modulus * modulus * meeting.speed),
               0.2) /
      std::sqrt(stiffening(law));
  return {share_of_contact_time * contact,
          fmt::format("a tenth of the contact time of {} at {:.3g} m/s, {:.4g} s", meeting.name,
                      meeting.speed, contact)};
}

/// Of the film at its thinnest: m*/c, c = 6π μ R*² (1/roughness − 1/reach).
StepLimit film_limit(const Meeting& meeting) {
  const PairLaw& law = meeting.law;
  const double closeness = 1 / law[LawColumn::film_thinnest] - law[LawColumn::film_closeness];
  const double resistance =
      law[LawColumn::film_viscosity] * meeting.uneven * meeting.uneven * closeness;
  const double time = meeting.mass / resistance;
  return {share_of_film_time * time,
          fmt::format("a fifth of the time in which the film of lubrication stops {}, {:.4g} s",
                      meeting.name, time)};
}

void check_meeting(const Meeting& meeting, const ContactModel& model) {
  if (!meeting.law.given) {
    const char* const needs = model.law == ContactLaw::linear
                                  ? "normal_stiffness, restitution and friction"
                                  : "restitution and friction";
    throw ConfigError(
        "particles.contact.pairs: no entry between {}, and the particles of this scene can meet; "
        "add one with {}",
        meeting.name, needs);
  }
  if (model.law != ContactLaw::linear || model.cohesion != CohesionLaw::sjkr) return;
  const double attraction = meeting.law[LawColumn::attraction] * meeting.widest;
  if (attraction >= meeting.law[LawColumn::normal]) {
    throw ConfigError(
        "particles.contact.pairs: the cohesion of {} pulls with {:.4g} N/m (2 pi "
        "cohesion_energy_density times the effective radius of {:.4g} m), but normal_stiffness, "
        "which must withstand it, is {:.4g} N/m; raise it, or lower the cohesion",
        meeting.name, attraction, meeting.widest, meeting.law[LawColumn::normal]);
  }
}

double in_series(double a, double b) { return std::isinf(b) ? a : a * b / (a + b); }

/// A particle of material `a` at a wall.
Meeting meeting_with_wall(const ContactLaws& laws, const Present& one, int a,
                          const WallsPresent& wall) {
  return {laws[laws.index(a, wall.material)],
          fmt::format("[{}, {}]", laws.name(a), laws.name(wall.material)),
          one.lightest,
          one.smallest,
          one.largest,
          one.smallest,
          one.fastest + wall.speed};
}

/// Free particles of the material `a` and those of the group `b`.
Meeting meeting_of(const ContactLaws& laws, const std::vector<Present>& present, int a, int b) {
  const Present& one = present[a];
  const Present& other = present[b];
  const int material = b % laws.walls();
  return {laws[laws.index(a, material)],
          fmt::format("[{}, {}]", laws.name(a), laws.name(material)),
          in_series(one.lightest, other.lightest),
          in_series(one.smallest, other.smallest),
          in_series(one.largest, other.largest),
          std::max(in_series(one.smallest, other.largest), in_series(one.largest, other.smallest)),
          one.fastest + other.fastest};
}

}  // namespace

StepLimit step_limit(const ContactLaws& laws, const ParticleState& particles,
                     std::span<const WallsPresent> walls) {
  const std::vector<Present> present = count_materials(laws, particles);
  StepLimit least{infinity, ""};
  const auto consider = [&](const StepLimit& limit) {
    if (limit.longest < least.longest) least = limit;
  };
  const int materials = laws.walls();
  const int groups = 2 * materials;
  std::vector<bool> meets(groups, false);
  const auto meet = [&](const Meeting& meeting) {
    check_meeting(meeting, laws.model());
    consider(limit_of(meeting, laws.model()));
    if (laws.model().film) consider(film_limit(meeting));
  };
  for (int a = 0; a < materials; ++a) {
    if (present[a].count == 0) continue;
    for (const WallsPresent& wall : walls) {
      meet(meeting_with_wall(laws, present[a], a, wall));
      meets[a] = true;
    }
    for (int b = groups - 1; b >= a; --b) {
      if (present[b].count <= (a == b ? 1 : 0)) continue;
      meet(meeting_of(laws, present, a, b));
      meets[a] = meets[b] = true;
    }
  }
  for (int a = 0; a < groups && laws.model().law == ContactLaw::hertz; ++a) {
    if (!meets[a]) continue;
    const int material = a % materials;
    const double rayleigh = laws.rayleigh_factor(material) * present[a].rayleigh;
    consider({share_of_rayleigh_time * rayleigh,
              fmt::format("a fifth of the Rayleigh time of {}, {:.4g} s", laws.name(material),
                          rayleigh)});
  }
  return least;
}

void check_time_step(const StepLimit& limit, double time_step) {
  // A window cut into equal parts may miss the limit by a rounding error.
  if (time_step <= limit.longest * (1 + 1e-9)) return;
  throw ConfigError(
      "particles.time_step: a sub-step of {:.4g} s is longer than {}; set it to at most {:.4g} s "
      "(recommended: half of that, {:.2g} s), or soften the contact",
      time_step, limit.reason, limit.longest, 0.5 * limit.longest);
}

}  // namespace fluxpact
