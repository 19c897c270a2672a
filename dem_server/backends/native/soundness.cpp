#include "dem_server/backends/native/soundness.hpp"

#include "dem_server/walls/walls.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {

bool is_sound_after_all(const Domain& domain, const Motion& motion, double time_step) {
  if (!motion.position.allFinite() || !motion.velocity.allFinite()) return false;
  if (lost_through(domain, motion.position, motion.radius) >= 0) return false;
  return motion.velocity.norm() * time_step <= motion.radius;
}

void refuse(const Domain& domain, std::int64_t id, const Motion& motion, const SubStep& sub_step) {
  const Vector3& x = motion.position;
  const Vector3& v = motion.velocity;
  const std::string who = fmt::format(
      "particle {} at ({:.6g}, {:.6g}, {:.6g}) m with velocity ({:.4g}, {:.4g}, {:.4g}) m/s, "
      "sub-step {} of {} of this window:",
      id, x.x(), x.y(), x.z(), v.x(), v.y(), v.z(), sub_step.number, sub_step.of);
  if (!x.allFinite() || !v.allFinite()) {
    throw NumericsError(
        "{} position or velocity is not finite; two centres in one place, or contacts too stiff "
        "for the time step: look at the insertion, shorten particles.time_step",
        who);
  }
  const int side = lost_through(domain, x, motion.radius);
  if (side >= 0 && domain.sides[side] == SideKind::open) {
    throw NumericsError(
        "{} left the domain through {}, which is open; move that side out (fluid.mesh.box) or "
        "close it",
        who, side_name(side));
  }
  if (side >= 0) {
    throw NumericsError(
        "{} was pressed through the wall {}; raise the normal_stiffness between its material and "
        "the walls, or shorten particles.time_step",
        who, side_name(side));
  }
  throw NumericsError(
      "{} moves by {:.3g} of its radius in one sub-step, so it could pass through others; set "
      "particles.time_step to at most {:.3g} s",
      who, v.norm() * sub_step.time_step / motion.radius, motion.radius / v.norm());
}

void refuse_lost_in_surface(std::int64_t id) {
  throw NumericsError(
      "particle {}: pressed through a surface of particles.surfaces or the mesh, or wedged into "
      "more than {} places of it; raise the normal_stiffness of its pair with the surface, or "
      "shorten particles.time_step",
      id, most_wall_touches);
}

void refuse_force(std::int64_t id, const Vector3& force) {
  throw NumericsError(
      "particle {}: the force on it is ({}, {}, {}) N; look at the drag and the fluid state "
      "around it",
      id, force.x(), force.y(), force.z());
}

void check_periods(const Domain& domain, double largest_diameter, double shortest) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!domain.periodic(axis) || domain.length(axis) >= shortest) continue;
    throw ConfigError(
        "fluid.mesh.periodic: the period in {} is {:.6g} m, but the largest particle has a "
        "diameter of {:.6g} m and would meet its own image; make the box at least {:.6g} m long "
        "there",
        "xyz"[axis], domain.length(axis), largest_diameter, shortest);
  }
}

}  // namespace fluxpact
