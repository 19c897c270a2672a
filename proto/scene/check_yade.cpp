// What particles.backend: yade cannot do beyond the table of engine_abilities.cpp.
#include "proto/scene/check.hpp"

namespace fluxpact {
namespace {

/// A material of YADE has one dashpot, which suits one mass.
class OneKind {
 public:
  explicit OneKind(Findings& findings) : findings_(findings) {}

  /// Free particles that stand under `path`.
  void meet(const std::string& path, const std::string& material, double diameter, bool sizes) {
    if (!findings_.sound(path)) return;
    if (path_.empty()) {
      path_ = path;
      material_ = material;
      diameter_ = diameter;
    }
    if (!sizes && material == material_ && diameter == diameter_) return;
    findings_.add(path,
                  fmt::format("particles.backend: yade moves particles of one material and one "
                              "diameter only, here those of {} ({}, {} m); change that, or use "
                              "another engine",
                              path_, material_, diameter_));
  }

 private:
  Findings& findings_;
  std::string path_;  // of the first
  std::string material_;
  double diameter_ = 0;
};

}  // namespace

void check_yade(const Scene& scene, Findings& findings) {
  const ParticleSettings& particles = scene.particles;
  if (!scene.fluid.mesh.periodic.empty() && has_particles(scene) &&
      findings.sound("fluid.mesh.periodic")) {
    findings.add("fluid.mesh.periodic",
                 "particles.backend: yade has no periodic sides beside walls; remove the axes, or "
                 "use another engine");
  }
  if (particles.numerics.threads > 1 && findings.sound("particles.numerics.threads")) {
    findings.add("particles.numerics.threads",
                 fmt::format("{} threads, and particles.backend: yade runs in one, so that sums "
                             "have one order; remove it, or use another engine",
                             particles.numerics.threads));
  }
  OneKind kind(findings);
  for (std::size_t i = 0; i < particles.insertion.size(); ++i) {
    const InsertionSettings& entry = particles.insertion[i];
    if (entry.motion == Mobility::fixed || entry.type == InsertionType::file) continue;
    kind.meet(fmt::format("particles.insertion[{}]", i), entry.material, entry.diameter,
              entry.sizes.has_value());
  }
  for (std::size_t i = 0; i < particles.inflow.size(); ++i) {
    const InflowSettings& entry = particles.inflow[i];
    kind.meet(fmt::format("particles.inflow[{}]", i), entry.material, entry.diameter,
              entry.sizes.has_value());
  }
}

}  // namespace fluxpact
