// The walls of a scene that are no sides of its box: planes, cylinders, cones and triangles, at
// rest or moving. Geometry only: the engine asks which elements are near a sphere when it makes its
// contact list (`nearby`), and in every sub-step where the sphere touches them (`touches`); what
// force that gives is its own affair.
//
// Sides. A plane is solid behind it. Every other surface is a thin sheet with two sides, and a
// particle is held on the side from which it came: `nearby` notes that side in the element numbers
// that it gives, and carries it over from the list before. A centre that gets behind the sheet by
// less than the reach of the list is pushed back through it, with a negative distance. The side
// comes from the nearest point of the whole sheet (Baerentzen and Aanaes 2005), so triangles may be
// far smaller than the particle and in any order; at the rim of an open sheet there is no side, and
// particles roll around it. Between two lists a particle must not move as far as from one side of a
// rim to the other (half its circumference). A closed body thinner than twice the depth to which a
// centre gets behind cannot hold it: what is nearest may be its other face.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "dem_server/walls/box_tree.hpp"
#include "dem_server/walls/facets.hpp"
#include "dem_server/walls/motion.hpp"
#include "dem_server/walls/tube.hpp"
#include "proto/mesh/mesh.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// Where a sphere touches a wall.
struct WallTouch {
  Vector3 normal;            ///< unit vector from the wall to the centre's side
  double distance = 0;       ///< [m] of the centre from the wall along it; negative behind the wall
  Vector3 velocity;          ///< [m/s] of the wall there
  int surface = 0;           ///< index: material and name
  std::int32_t feature = 0;  ///< what was touched, stable in time: one number for each primitive
                             ///< (and rim), for connected triangles of one plane, for each line of
                             ///< edges, for each corner
};

/// Room that `touches` needs. The normals of two touches differ by more than `least_angle`; more
/// than this number are only met by a sphere wedged in on nearly all sides.
inline constexpr int most_wall_touches = 16;

/// Touches whose normals differ by less (cosine, 32 degrees) are one, the nearest: so the facets of
/// a smooth vessel count once, and a spring finds its contact again on the next facet as the one
/// whose normal is near.
inline constexpr double least_angle_cosine = 0.85;

/// One surface as a rigid body.
struct WallSurface {
  std::string name;      ///< of particles.surfaces, or "mesh"
  std::string material;  ///< for the contact law
  SurfaceType type = SurfaceType::plane;
  SurfaceSide side = SurfaceSide::both;
  MotionSettings motion;
  Pose pose;              ///< at the time of the last `place`
  double arm = 0;         ///< [m] farthest of its points from its axis of rotation; 0: it turns in
                          ///< itself; infinite: the surface has no end
  Vector3 point, normal;  ///< plane
  Tube tube;              ///< cylinder, cone
  BoxTree tree;           ///< stl
  int first_element = 0;  ///< plane, cylinder, cone: its element; stl: that of its first triangle
  int elements = 0;
  std::int32_t feature = 0;  ///< plane, cylinder, cone: its first
};

class Walls {
 public:
  Walls() = default;

  bool empty() const { return surfaces_.empty(); }
  bool moving() const { return moving_; }
  int size() const { return static_cast<int>(surfaces_.size()); }
  const WallSurface& operator[](int surface) const { return surfaces_[surface]; }
  const Facets& facets() const { return facets_; }
  /// Surfaces that are one element each; the numbers of facets follow theirs.
  int primitives() const { return static_cast<int>(surface_of_primitive_.size()); }
  int elements() const { return primitives() + static_cast<int>(facets_.facets.size()); }
  /// What `nearby` appends is below this.
  int element_codes() const { return 4 * elements(); }

  /// Move the surfaces to where they are at `time` [s]. They are at time 0 when made.
  void place(double time);

  /// Bound [m] of how far the part of any surface that is within `reach` [m] of a particle has
  /// moved from where it was at `since` [s] to where it is now. A list made then with a skin is
  /// good while this and the way of the particle together are within the skin.
  double travelled(double since, double reach) const;

  /// Bound [m/s] of the speed of a surface inside the domain, at any time.
  double fastest(int surface) const;

  /// Append to `elements` what is within `reach` [m] of a centre, with the side on which the
  /// particle is held: to be handed to `touches` as they are. `before`: the elements of the same
  /// particle in the list before, or none (not a part of `elements`). Needs no memory if `elements`
  /// has room. False if the particle was pressed through a sheet deeper than `reach`, and is lost.
  bool nearby(const Vector3& position, double reach, std::span<const int> before,
              std::vector<int>& elements) const;

  /// Where a sphere [m] touches its elements: distance below its radius. One touch for a face, edge
  /// or corner that is the nearest of its neighbourhood; a face hides its edges and corners.
  /// Ascending by distance. Returns their number, or -1 if there are more than `out` holds
  /// (`most_wall_touches` suffice but for a sphere that is wedged in on nearly all sides).
  int touches(const Vector3& position, double radius, std::span<const int> elements,
              std::span<WallTouch> out) const;

  /// The surface of an element, for messages.
  int surface_of(int element) const;

 private:
  friend class WallsMaker;

  std::vector<WallSurface> surfaces_;
  Facets facets_;
  double arm_in_domain(const WallSurface& surface) const;

  std::vector<int> surface_of_primitive_;  // elements below its size; the triangles follow
  Vector3 lower_ = Vector3::Zero();        // [m] of the domain
  Vector3 upper_ = Vector3::Zero();
  double time_ = 0;
  bool moving_ = false;
};

/// The walls of a scene. The faces of the mesh that lie on no side of its bounding box are the
/// surface `mesh` (with `walls: from_mesh`), except those of patches with a pressure boundary;
/// those on the sides are walls of the Domain. Throws ConfigError: a file that cannot be read
/// (file, line or triangle), a direction without length (key), `side` of a file that is not closed.
Walls make_walls(const Scene& scene, const Mesh& mesh);

}  // namespace fluxpact
