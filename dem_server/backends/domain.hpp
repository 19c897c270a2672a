// Where particles may be: the outer box of the mesh, and what each of its sides means to a
// particle. Used by every particle engine and by the insertion.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "proto/base/vector.hpp"
#include "proto/mesh/mesh.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// wall: a plane that particles touch. open: nothing is there; a particle whose centre is beyond it
/// at the end of a window leaves the domain, or is lost (NumericsError) if this side lets none out.
/// periodic: a particle that leaves here comes back on the opposite side.
enum class SideKind : std::uint8_t { wall, open, periodic };

struct Domain {
  Vector3 lower;                    ///< [m]
  Vector3 upper;                    ///< [m]
  std::array<SideKind, 6> sides{};  ///< in the order of Side: x_min, x_max, y_min, ...
  std::array<bool, 6> lets_out{};   ///< particles leave through this side, which is open

  static int low_side(int axis) { return 2 * axis; }
  bool periodic(int axis) const { return sides[low_side(axis)] == SideKind::periodic; }
  double length(int axis) const { return upper[axis] - lower[axis]; }
  /// Place of the plane of side 0 ... 5 along its axis [m].
  double plane(int side) const { return side % 2 == 0 ? lower[side / 2] : upper[side / 2]; }
};

/// "x_min" ... for messages.
const char* side_name(int side);

/// The domain of the particles of a scene. Every side that is not periodic is a wall, so that no
/// particle leaves through an inlet, except a side all of whose faces have a `pressure` boundary,
/// or on which no face of the mesh lies at all: these are open. With `particles.walls: none` all of
/// them are open. An open side lets particles out if all of its faces are of patches in
/// `particles.outflow`, or if that is not given, and if it has faces at all or there are no walls.
/// Boundary faces elsewhere are none of the domain's: see Walls.
Domain particle_domain(const Scene& scene, const Mesh& mesh);

/// The side of the box on which a boundary face of the mesh lies, or -1 if on none.
int side_of_face(const Domain& domain, const Mesh& mesh, int face);

/// The boundary faces that lie on no side of the box, in order, except those of patches with a
/// `pressure` boundary.
std::vector<int> faces_off_the_box(const Scene& scene, const Mesh& mesh, const Domain& domain);

/// Throws ConfigError that names the engine of the scene and the first such face, if the scene has
/// particles: for engines that know the sides of a box only.
void check_box_mesh(const Scene& scene, const Mesh& mesh);

/// Position moved by whole periods into [lower, upper) along the periodic axes [m].
Vector3 wrapped(const Domain& domain, Vector3 position);

/// The side through which a sphere has left the domain as it may, or -1: its centre is beyond one
/// that lets particles out.
int left_through(const Domain& domain, const Vector3& position);

/// The side through which a sphere has got lost, or -1: its centre beyond an open side that lets
/// none out, or all of it beyond a wall. One that has left is not lost. Periodic sides hold
/// everything.
int lost_through(const Domain& domain, const Vector3& position, double radius);

}  // namespace fluxpact
