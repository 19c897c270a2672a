// What the engine of the particles cannot do is refused here, under the key that asks for it.
#include <algorithm>
#include <set>

#include "proto/scene/check.hpp"
#include "proto/scene/engine_abilities.hpp"
#include "proto/scene/names.hpp"

namespace fluxpact {
namespace {

bool several_sizes(const ParticleSettings& particles) {
  std::set<double> diameters;
  const auto meet = [&](double diameter, const std::optional<SizeSettings>& sizes) {
    if (sizes) {
      if (sizes->distribution == SizeDistribution::table) {
        for (const auto& [size, weight] : sizes->table) diameters.insert(size);
      } else {
        diameters.insert(sizes->range.begin(), sizes->range.end());
      }
    } else if (diameter > 0) {
      diameters.insert(diameter);
    }
  };
  for (const InsertionSettings& entry : particles.insertion) meet(entry.diameter, entry.sizes);
  for (const InflowSettings& inflow : particles.inflow) meet(inflow.diameter, inflow.sizes);
  return diameters.size() > 1;
}

bool spread_sizes(const ParticleSettings& particles) {
  const auto spread = [](const auto& entry) {
    return entry.sizes && entry.sizes->distribution != SizeDistribution::table;
  };
  return std::ranges::any_of(particles.insertion, spread) ||
         std::ranges::any_of(particles.inflow, spread);
}

/// Findings against one engine.
class Refusal {
 public:
  Refusal(ParticleBackend backend, Findings& findings)
      : engine_(name_of(backend)), findings_(findings) {}

  /// What is `asked` under `path` and not `able`.
  void of(const std::string& path, bool asked, bool able, const std::string& what) {
    if (!asked || able || !findings_.sound(path)) return;
    findings_.add(path,
                  fmt::format("{}, which particles.backend: {} does not know; change that, or use "
                              "another engine (docs/engines.md tells what each can do)",
                              what, engine_));
  }

 private:
  std::string_view engine_;
  Findings& findings_;
};

void check_program(const ParticleSettings& particles, Findings& findings) {
  if (!findings.sound("particles.program")) return;
  const bool custom = particles.backend == ParticleBackend::custom;
  if (custom && particles.program.empty()) {
    findings.add("particles.program",
                 "missing; required with `backend: custom`: the path of a particle server");
  } else if (!custom && !particles.program.empty()) {
    findings.add("particles.program",
                 "has no meaning here, only with `backend: custom`; remove it");
  }
}

}  // namespace

void check_backend(const Scene& scene, Findings& findings) {
  const ParticleSettings& particles = scene.particles;
  if (!findings.sound("particles.backend")) return;
  check_program(particles, findings);
  const EngineAbilities can = abilities_of(particles.backend);
  Refusal refuse(particles.backend, findings);
  const ContactSettings& contact = particles.contact;
  refuse.of("particles.contact.law", contact.law == ContactLaw::hertz, can.hertz,
            "`hertz` is a law");
  refuse.of("particles.contact.rolling", contact.rolling != RollingLaw::none, can.rolling,
            fmt::format("`{}` is a law", name_of(contact.rolling)));
  refuse.of("particles.contact.cohesion", contact.cohesion != CohesionLaw::none, can.cohesion,
            fmt::format("`{}` is a law", name_of(contact.cohesion)));
  refuse.of("particles.numerics.precision", particles.numerics.precision == Precision::mixed,
            can.mixed_precision, "`mixed` is a precision");
  refuse.of("particles.surfaces", !particles.surfaces.empty(), can.surfaces,
            "these are walls beside those of the mesh");
  refuse.of("particles.ranks", particles.ranks > 1, can.ranks,
            fmt::format("{} asks for MPI", particles.ranks));
  refuse.of("particles.insertion", several_sizes(particles), can.any_size,
            "the particles have different diameters");
  refuse.of("particles.insertion", spread_sizes(particles), can.spread_sizes,
            "a continuous distribution makes every diameter another one");
  const bool alone = particles.ranks == 1 || !can.ranks;
  const std::string on_ranks = alone ? "" : " on several ranks";
  refuse.of("particles.inflow", !particles.inflow.empty(), can.flow && alone,
            "particles come in" + on_ranks);
  refuse.of("particles.outflow", particles.inflow.empty() && particles_flow(scene),
            can.flow && alone, "particles can leave" + on_ranks + " (an empty list keeps them in)");
  refuse.of("interphase.forces", has_force(scene, InterphaseForce::lubrication), can.lubrication,
            "`lubrication` acts between particles that move");
  for (std::size_t i = 0; i < particles.insertion.size(); ++i) {
    refuse.of(fmt::format("particles.insertion[{}].motion", i),
              particles.insertion[i].motion == Mobility::fixed, can.fixed,
              "`fixed` makes particles that nothing moves");
  }
  refuse.of("fluid.mesh", has_particles(scene) && !scene.fluid.mesh.is_box(),
            can.any_mesh || particles.backend == ParticleBackend::kinematic,
            "a mesh from a file may be no box, and its walls are more than six sides");
  if (particles.backend == ParticleBackend::yade) check_yade(scene, findings);
}

}  // namespace fluxpact
