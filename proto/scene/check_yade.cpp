// What particles.backend: yade cannot do beyond the table of engine_abilities.cpp.
#include "proto/scene/check.hpp"

namespace fluxpact {

void check_yade(const Scene& scene, Findings& findings) {
  if (!scene.fluid.mesh.periodic.empty() && has_particles(scene) &&
      findings.sound("fluid.mesh.periodic")) {
    findings.add("fluid.mesh.periodic",
                 "particles.backend: yade has no periodic sides beside walls; remove the axes, or "
                 "use another engine");
  }
  if (scene.particles.numerics.threads > 1 && findings.sound("particles.numerics.threads")) {
    findings.add("particles.numerics.threads",
                 fmt::format("{} threads, and particles.backend: yade runs in one, so that sums "
                             "have one order; remove it, or use another engine",
                             scene.particles.numerics.threads));
  }
}

}  // namespace fluxpact
