// Particles that come in during the run: how many are due at the end of a window, and where.
//
// What is due is counted from the start of the flow, so that the mean rate is exact: what is no
// whole particle, or finds no room, is due later. The generator, the sizes and the ids belong to
// the candidate: a window that is repeated brings the same particles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dem_server/backends/domain.hpp"
#include "dem_server/backends/particle_engine.hpp"
#include "dem_server/insertion/near_spheres.hpp"
#include "dem_server/insertion/random.hpp"
#include "dem_server/walls/room.hpp"
#include "proto/base/compensated_sum.hpp"
#include "proto/scene/size_law.hpp"

namespace fluxpact {

class Inflow {
 public:
  /// From particles.inflow; ids from `first_id` on. Throws ConfigError that names the entry if its
  /// patch is not in the mesh, or its box is outside the domain or too small for a sphere.
  Inflow(const Scene& scene, const Mesh& mesh, std::int64_t first_id);

  /// Those due at `time` [s] that find room beside the rows of `present` that are not `leaving`
  /// (ascending), without touching any, or a wall where it is at that time. `entering` is
  /// overwritten. Candidate until commit.
  void advance(double time, const ParticleState& present, std::span<const int> leaving,
               ParticleState& entering);
  void commit() { committed_ = candidate_; }
  void rollback() { candidate_ = committed_; }

  /// Of all entries at the last `advance`: due and without room.
  std::int64_t waiting() const;

 private:
  /// A triangle of a patch, from which particles come.
  struct Gate {
    Vector3 corner, side, other_side;  ///< [m]
    Vector3 inward;                    ///< unit vector
    double depth = 0;                  ///< [m] that a particle goes inward in a window
    double area = 0;                   ///< [m²] up to and with this one
  };
  /// One entry of particles.inflow.
  struct Source {
    InflowSettings settings;
    SizeLaw sizes;
    int material = 0;
    double density = 0;              ///< [kg/m³]
    std::vector<Gate> gates;         ///< empty: the box
    std::array<bool, 3> periodic{};  ///< the box is the whole period along the axis
    Vector3 lower, upper;            ///< [m] of the places of centres and spheres
  };
  /// What an entry has given so far.
  struct Given {
    UniformRandom random;
    double diameter = 0;  ///< [m] of the next one
    std::int64_t count = 0;
    std::int64_t waiting = 0;
    CompensatedSum mass;  ///< [kg]
  };
  struct State {
    std::vector<Given> given;  ///< one a source
    std::int64_t next_id = 1;
  };

  void lay_gates(const Scene& scene, const Mesh& mesh, Source& source) const;
  void lay_box(const std::string& name, Source& source) const;
  std::int64_t due(const Source& source, const Given& given, double time) const;
  void gather(const Source& source, const ParticleState& present, std::span<const int> leaving,
              const ParticleState& entering);
  void add_images(const Vector3& centre, double radius);
  bool find_place(const Source& source, Given& given, Vector3& place) const;
  Vector3 propose(const Source& source, Given& given) const;
  bool is_inside(const Vector3& place, double radius) const;

  Domain domain_;
  Room room_;
  std::vector<Source> sources_;
  State committed_;
  State candidate_;
  NearSpheres near_;
};

}  // namespace fluxpact
