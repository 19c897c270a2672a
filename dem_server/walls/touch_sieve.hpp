// From all the places where a sphere meets parts of walls to the touches that count.
#pragma once

#include <array>
#include <span>

#include "dem_server/walls/walls.hpp"

namespace fluxpact {

/// A place where a sphere meets a face, edge or vertex.
/// (Without initial values: a sieve has many, and reads only those that it was given.)
struct Meeting {
  Vector3 normal;           ///< from the wall to the centre's side
  double distance;          ///< [m]
  const FacetJoint* joint;  ///< the edge or vertex; nullptr: a face or a primitive
  std::int32_t feature;
  bool face;    ///< it hides the edges and vertices of its plane
  int surface;  ///< set by the sieve
};

/// Collects meetings, keeps of those that are one touch the nearest.
class TouchSieve {
 public:
  explicit TouchSieve(const Facets& facets) : facets_(facets) {}

  /// What is added from here to `end` is of this surface, in the frame of the surface at rest.
  void begin(int surface) {
    surface_ = surface;
    first_ = count_;
  }
  void add(const Meeting& meeting);
  void end(const Pose& pose);

  /// The touches, ascending by distance; their number, or -1 if they do not fit. The velocity of
  /// the walls is not written.
  int write(std::span<WallTouch> out);

 private:
  static constexpr int capacity = 64;
  bool hidden_by(const Meeting& kept, const Meeting& meeting) const;
  void sift(int first);

  const Facets& facets_;
  std::array<Meeting, capacity> meetings_;
  int count_ = 0;
  int first_ = 0;
  int surface_ = 0;
  bool full_ = false;
};

}  // namespace fluxpact
