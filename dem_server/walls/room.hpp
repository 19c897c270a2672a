// Where particles may start: inside the vessel, clear of its walls.
#pragma once

#include "dem_server/walls/walls.hpp"

namespace fluxpact {

/// The room that the walls of a scene leave within its Domain, whose own sides it does not look at:
/// at time 0 when made.
class Room {
 public:
  /// Throws ConfigError as make_walls does.
  Room(const Scene& scene, const Mesh& mesh);

  /// Move the walls to where they are at `time` [s].
  void place(double time) {
    if (walls_.moving()) walls_.place(time);
  }

  /// True if nothing but the domain bounds it.
  bool unbounded() const { return walls_.empty() && boundary_.facets.empty(); }

  /// True if the mesh is no box.
  bool bounded_by_mesh() const { return !boundary_.facets.empty(); }

  /// Distance of a place from the nearest wall [m]; negative behind a plane, on the wrong side of a
  /// surface with a `side`, and outside the mesh. Infinite if there is no wall. A cylinder or cone
  /// has its `side` within its length only.
  double clearance(const Vector3& x) const;

  /// True if a sphere there is within the room, up to rounding.
  bool fits(const Vector3& x, double radius) const { return clearance(x) >= radius * (1 - 1e-9); }

  /// Name of the surface that is nearest to x, in the sense of `clearance`; empty without one.
  std::string nearest_wall(const Vector3& x) const;

  const Walls& walls() const { return walls_; }

 private:
  double clearance_of(const WallSurface& surface, const Vector3& x) const;
  /// From the boundary of the mesh, if it is no box: positive inside.
  double depth_in_mesh(const Vector3& x) const;

  Walls walls_;
  Facets boundary_;  // the whole boundary of the mesh where it is no box: tells inside from outside
  BoxTree tree_;
};

}  // namespace fluxpact
