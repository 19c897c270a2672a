// One window of hard spheres, event by event: each flies on its own parabola from one event to the
// next, which is a collision with another sphere or a wall, or the crossing into another cell. Only
// those whom an event touches are moved, each to its own time.
//
// Every sphere holds its own next event; a tournament (event_queue.hpp) tells whose is first. A
// collision that was found with a partner who has collided since is found anew when its time comes
// (Marin, Risso & Cordero, J. Comput. Phys. 109, 1993, 306-317; Pöschel & Schwager, Computational
// Granular Dynamics, 2005, chapter 3). Nothing is kept from one window to the next but what
// `Spheres` holds: the forces have changed, so all events are found anew.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "dem_server/backends/domain.hpp"
#include "dem_server/backends/hard_sphere/collision.hpp"
#include "dem_server/backends/hard_sphere/event_cells.hpp"
#include "dem_server/backends/hard_sphere/event_queue.hpp"
#include "dem_server/backends/particle_engine.hpp"

namespace fluxpact {

/// What moves, one row each, in the order of `state`.
struct Spheres {
  ParticleState state;
  /// [m] at which a sphere collides: its radius, or less for those that overlapped at the start,
  /// until they have had the room to grow.
  std::vector<double> reach;
  /// Collisions of late: their number, each forgotten at the rate 1 / (memory t_c).
  std::vector<double> activity;
};

/// Contacts last no time here, so a packing at rest would collide without end (inelastic collapse:
/// McNamara & Young, Phys. Fluids A 4, 1992, 496-504). Spheres that collide more than once in the
/// time t_c that a real contact lasts are in a lasting contact, whose energy is stored and not yet
/// lost: collisions among them conserve energy (Luding & McNamara, Granul. Matter 1, 1998,
/// 113-128). The rate is that of about the last `memory` collisions.
inline constexpr double memory = 8;

/// Collisions in the time t_c beyond which a sphere is stuck, on average over `memory` t_c.
inline constexpr double most_collisions = 1000;

class HardSpheres {
 public:
  HardSpheres(const Domain& domain, CollisionLaws laws)
      : domain_(domain), laws_(std::move(laws)), shifts_(shift_vectors(domain)) {}

  /// Move the spheres by `window` [s], each under a constant acceleration [m/s²]. `contact_time`
  /// [s]: t_c above. Positions are wrapped in periodic axes, before and after. Throws NumericsError
  /// that names a sphere which collides without end.
  void advance(Spheres& spheres, std::span<const Vector3> acceleration, double window,
               double contact_time, const Progress& progress);

  /// So far.
  std::int64_t collisions() const { return collisions_; }
  std::int64_t events() const { return events_; }

 private:
  /// A sphere at its own time. What tells that it is too far away comes first: one cache line.
  struct alignas(64) Body {
    Vector3 position;
    double time;   ///< [s] since the window began
    double reach;  ///< [m]
    double speed;  ///< |velocity|
    double pull;   ///< |acceleration|
    double inverse_mass;
    Vector3 velocity, acceleration;
    int material;
    std::int32_t epoch;  ///< changes whenever its path does
  };
  /// What collisions alone need.
  struct Turning {
    Vector3 spin;
    double activity;  ///< at the time `collided`
    double collided;  ///< [s] time of the last collision, at first that of the window's begin
  };
  /// Place at a time.
  struct Here {
    Vector3 position, velocity;
  };
  /// What comes next: a sphere (its number), or one of the codes below.
  struct Event {
    int with = nothing;
    std::int32_t epoch = 0;  ///< of the other sphere when this was found
    int shift = Shift::none;
  };
  static constexpr int nothing = -1;
  static constexpr int first_wall = -2;  // -2 ... -7: wall 0 ... 5
  static constexpr int first_face = -8;  // -8 ... -13: face of the cell, by Side

  void load(const Spheres& spheres, std::span<const Vector3> acceleration);
  void grow(const Spheres& spheres);
  void find_next(int sphere, double now);
  void find_plane(const Body& body, const Here& here, int sphere, double& horizon, Event& event);
  void happen(int sphere, double now);
  void meet(int sphere, const Event& event, double now);
  void hit_wall(int sphere, int side, double now);
  void cross(int sphere, int side, double now);
  void fly(Body& body, double now) const;
  double stir(int sphere, double now);
  Rest rest(double activity, const Vector3& normal, const Body& a, const Body& b) const;
  void store(Spheres& spheres);
  [[noreturn]] void refuse_endless(int sphere) const;

  Domain domain_;
  CollisionLaws laws_;
  std::array<Vector3, 27> shifts_;
  double window_ = 0;
  double contact_time_ = 0;
  std::int64_t collisions_ = 0;
  std::int64_t events_ = 0;

  // By place: the order of cells at the begin of the window, in which neighbours are near in
  // memory.
  std::vector<Body> bodies_;
  std::vector<Turning> turning_;
  std::vector<Event> event_;
  struct Near {
    int sphere, shift;
  };
  std::vector<Near> near_;  // of the one whose next event is sought
  EventQueue queue_;
  EventCells cells_;
  CellGrid order_;
  std::vector<std::int64_t> id_;
  std::vector<Vector3> position_;
  std::vector<double> radius_;
  std::vector<double> grown_;
};

/// The share by which spheres may overlap at the start [-].
inline constexpr double most_overlap_of_hard_spheres = 0.1;

/// Sets `reach` of the rows from `first` on to their radius, and makes that of all that overlap, or
/// touch others or a wall, as much smaller as it takes to leave a gap. Throws ConfigError that
/// names the pair if one overlaps by more than the share above.
void make_room(const Domain& domain, int first, Spheres& spheres);

}  // namespace fluxpact
