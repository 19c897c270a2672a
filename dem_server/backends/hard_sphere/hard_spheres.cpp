#include "dem_server/backends/hard_sphere/hard_spheres.hpp"

#include <algorithm>
#include <cmath>

#include "dem_server/backends/hard_sphere/flight.hpp"
#include "dem_server/backends/native/contact_law.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

constexpr int events_between_signs = 1024;

constexpr double rounding = std::numeric_limits<double>::epsilon();

double inward(int side) { return side % 2 == 0 ? 1.0 : -1.0; }

}  // namespace

void HardSpheres::advance(Spheres& spheres, std::span<const Vector3> acceleration, double window,
                          double contact_time, const Progress& progress) {
  window_ = window;
  contact_time_ = contact_time;
  load(spheres, acceleration);
  const int count = static_cast<int>(bodies_.size());
  if (count == 0) return;
  cells_.sort(domain_, position_, radius_);
  grow(spheres);
  queue_.reset(count);
  for (int sphere = 0; sphere < count; ++sphere) find_next(sphere, 0);
  for (std::int64_t done = 1;; ++done) {
    const int sphere = queue_.first();
    const double now = queue_.time(sphere);
    if (!(now <= window)) break;
    happen(sphere, now);
    ++events_;
    if (progress && done % events_between_signs == 0) progress();
  }
  store(spheres);
}

void HardSpheres::load(const Spheres& spheres, std::span<const Vector3> acceleration) {
  const ParticleState& state = spheres.state;
  const int count = state.size();
  double mean = 0;
  for (const double radius : state.radius) mean += 2 * radius / count;
  order_.sort(domain_, mean, {count > 0 ? state.position.front().data() : nullptr, 3, count});
  const auto rows = static_cast<std::size_t>(count);
  bodies_.resize(rows);
  turning_.resize(rows);
  event_.resize(rows);
  id_.resize(rows);
  position_.resize(rows);
  radius_.resize(rows);
  for (int place = 0; place < count; ++place) {
    const int row = order_.order()[place];
    const double mass = sphere_mass(state.radius[row], state.density[row]);
    const bool fixed = state.is_fixed(row);
    Body& body = bodies_[place];
    body.position = state.position[row];
    body.velocity = state.velocity[row];
    body.acceleration = fixed ? Vector3(Vector3::Zero()) : acceleration[row];
    body.time = 0;
    body.reach = spheres.reach[row];
    body.speed = body.velocity.norm();
    body.pull = body.acceleration.norm();
    body.inverse_mass = fixed ? 0 : 1 / mass;
    body.material = state.material[row];
    body.epoch = 0;
    turning_[place] = {state.spin[row], spheres.activity[row], 0};
    id_[place] = state.id[row];
    position_[place] = body.position;
    radius_[place] = state.radius[row];
  }
}

/// Those that overlapped at the start take a quarter of the room that they have: the other one may
/// do so too, and half of it is left.
void HardSpheres::grow(const Spheres& spheres) {
  if (spheres.reach == spheres.state.radius) return;
  const int count = static_cast<int>(bodies_.size());
  grown_.resize(bodies_.size());
  for (int sphere = 0; sphere < count; ++sphere) {
    const Body& body = bodies_[sphere];
    const double radius = radius_[sphere];
    grown_[sphere] = body.reach;
    if (body.reach >= radius) continue;
    double gap = never;
    cells_.visit_near(sphere, [&](int other, int shift) {
      if (other == sphere) return;
      const Vector3 apart = bodies_[other].position + shifts_[shift] - body.position;
      gap = std::min(gap, apart.norm() - body.reach - bodies_[other].reach);
    });
    for (int side = 0; side < 6; ++side) {
      if (domain_.sides[side] != SideKind::wall) continue;
      const double above = inward(side) * (body.position[side / 2] - domain_.plane(side));
      gap = std::min(gap, above - body.reach);
    }
    grown_[sphere] = std::clamp(body.reach + 0.25 * gap, body.reach, radius);
  }
  for (int sphere = 0; sphere < count; ++sphere) bodies_[sphere].reach = grown_[sphere];
}

/// The next time at which the sphere meets a wall or a face of its cell.
void HardSpheres::find_plane(const Body& body, const Here& here, int sphere, double& horizon,
                             Event& event) {
  const auto try_plane = [&](const Fall& fall, int code) {
    const double time = first_touch(fall, horizon);
    if (time == never) return;
    horizon = time;
    event.with = code;
  };
  const EventCells::Bounds bounds = cells_.bounds(sphere);
  for (int axis = 0; axis < 3; ++axis) {
    const double x = here.position[axis];
    const double v = here.velocity[axis];
    const double a = body.acceleration[axis];
    const int low = Domain::low_side(axis);
    try_plane({x - bounds.lower[axis], v, a}, first_face - low);
    try_plane({bounds.upper[axis] - x, -v, -a}, first_face - low - 1);
    if (domain_.sides[low] == SideKind::wall) {
      try_plane({x - domain_.lower[axis] - body.reach, v, a}, first_wall - low);
    }
    if (domain_.sides[low + 1] == SideKind::wall) {
      try_plane({domain_.upper[axis] - x - body.reach, -v, -a}, first_wall - low - 1);
    }
  }
}

void HardSpheres::find_next(int sphere, double now) {
  const Body& body = bodies_[sphere];
  Event& event = event_[sphere];
  event = {};
  if (body.inverse_mass == 0) return;  // others come to it
  const double flown = now - body.time;
  const Here here{body.position + flown * (body.velocity + 0.5 * flown * body.acceleration),
                  body.velocity + flown * body.acceleration};
  const double own_speed = here.velocity.norm();
  double horizon = window_ - now;
  find_plane(body, here, sphere, horizon, event);
  near_.clear();
  cells_.visit_near(sphere, [&](int other, int shift) {
    __builtin_prefetch(&bodies_[other]);
    near_.push_back({other, shift});
  });
  for (const auto& [other, shift] : near_) {
    const Body& its = bodies_[other];
    const double late = now - its.time;
    const double touch = body.reach + its.reach;
    // From where it was last, the two come nearer by no more than this, whatever their directions.
    const double flown_at_most =
        (late + horizon) * (its.speed + 0.5 * (late + horizon) * its.pull) +
        horizon * (own_speed + 0.5 * horizon * body.pull);
    Vector3 apart = its.position - here.position;
    if (shift != Shift::none) apart += shifts_[shift];
    if (apart.squaredNorm() > (touch + flown_at_most) * (touch + flown_at_most)) continue;
    if (other == sphere) continue;
    apart += late * (its.velocity + 0.5 * late * its.acceleration);
    const Vector3 velocity = its.velocity + late * its.acceleration - here.velocity;
    const double closing = horizon * (velocity.norm() + 0.5 * horizon * (body.pull + its.pull));
    if (apart.squaredNorm() > (touch + closing) * (touch + closing)) continue;
    const Separation separation(apart, velocity, its.acceleration - body.acceleration, touch);
    const double time = first_touch(separation, horizon);
    if (time == never) continue;
    horizon = time;
    event = {other, its.epoch, shift};
  }
  queue_.set(sphere, event.with == nothing ? never : now + horizon);
}

void HardSpheres::happen(int sphere, double now) {
  const Event event = event_[sphere];
  if (event.with >= 0) {
    if (bodies_[event.with].epoch == event.epoch) {
      meet(sphere, event, now);
    } else {
      find_next(sphere, now);
    }
  } else if (event.with > first_face) {
    hit_wall(sphere, first_wall - event.with, now);
  } else {
    cross(sphere, first_face - event.with, now);
  }
}

void HardSpheres::fly(Body& body, double now) const {
  const double time = now - body.time;
  body.position += time * (body.velocity + 0.5 * time * body.acceleration);
  body.velocity += time * body.acceleration;
  body.speed = body.velocity.norm();
  body.time = now;
}

/// Counts a collision; how many there were of late.
double HardSpheres::stir(int sphere, double now) {
  if (bodies_[sphere].inverse_mass == 0) return never;
  Turning& turning = turning_[sphere];
  turning.activity =
      1 + turning.activity * std::exp((turning.collided - now) / (memory * contact_time_));
  turning.collided = now;
  if (turning.activity > memory * most_collisions) refuse_endless(sphere);
  return turning.activity;
}

/// Two that are pressed against each other part for t_c at least; and their speeds change by more
/// than rounding, or they would collide again at once.
Rest HardSpheres::rest(double activity, const Vector3& normal, const Body& a, const Body& b) const {
  const double pressing = normal.dot(a.acceleration - b.acceleration);
  return {activity > memory,
          std::max(0.5 * contact_time_ * pressing, 32 * rounding * (a.speed + b.speed))};
}

void HardSpheres::meet(int sphere, const Event& event, double now) {
  Body& a = bodies_[sphere];
  Body& b = bodies_[event.with];
  fly(a, now);
  fly(b, now);
  const Vector3 normal = (b.position + shifts_[event.shift] - a.position).normalized();
  const double activity = std::min(stir(sphere, now), stir(event.with, now));
  Collider one{a.velocity, turning_[sphere].spin, radius_[sphere], a.inverse_mass};
  Collider other{b.velocity, turning_[event.with].spin, radius_[event.with], b.inverse_mass};
  collide(laws_.of(a.material, b.material), rest(activity, normal, a, b), normal, one, other);
  a.velocity = one.velocity;
  b.velocity = other.velocity;
  a.speed = a.velocity.norm();
  b.speed = b.velocity.norm();
  turning_[sphere].spin = one.spin;
  turning_[event.with].spin = other.spin;
  ++a.epoch;
  if (b.inverse_mass > 0) ++b.epoch;
  ++collisions_;
  find_next(sphere, now);
  if (b.inverse_mass > 0) find_next(event.with, now);
}

void HardSpheres::hit_wall(int sphere, int side, double now) {
  Body& body = bodies_[sphere];
  fly(body, now);
  const Vector3 normal = -inward(side) * Vector3::Unit(side / 2);
  const double activity = stir(sphere, now);
  Collider one{body.velocity, turning_[sphere].spin, radius_[sphere], body.inverse_mass};
  Collider wall{Vector3::Zero(), Vector3::Zero(), 1, 0};
  Body at_rest = body;
  at_rest.velocity = at_rest.acceleration = Vector3::Zero();
  at_rest.speed = 0;
  collide(laws_.of(body.material, laws_.walls()), rest(activity, normal, body, at_rest), normal,
          one, wall);
  body.velocity = one.velocity;
  body.speed = body.velocity.norm();
  turning_[sphere].spin = one.spin;
  ++body.epoch;
  ++collisions_;
  find_next(sphere, now);
}

void HardSpheres::cross(int sphere, int side, double now) {
  const int axis = side / 2;
  const int periods = cells_.cross(sphere, axis, side % 2 == 0 ? -1 : 1);
  if (periods != 0) {
    Body& body = bodies_[sphere];
    body.position[axis] += periods * domain_.length(axis);
    ++body.epoch;  // who is to meet it would look for it at the other end
  }
  find_next(sphere, now);
}

void HardSpheres::store(Spheres& spheres) {
  for (std::size_t place = 0; place < bodies_.size(); ++place) {
    const int row = order_.order()[place];
    Body& body = bodies_[place];
    const Turning& turning = turning_[place];
    fly(body, window_);
    spheres.state.position[row] = wrapped(domain_, body.position);
    spheres.state.velocity[row] = body.velocity;
    spheres.state.spin[row] = turning.spin;
    spheres.reach[row] = body.reach;
    spheres.activity[row] =
        turning.activity * std::exp((turning.collided - window_) / (memory * contact_time_));
  }
}

void HardSpheres::refuse_endless(int sphere) const {
  const Body& body = bodies_[sphere];
  const Vector3& x = body.position;
  throw NumericsError(
      "particle {} at ({:.6g}, {:.6g}, {:.6g}) m collides without end: more than {} times in "
      "particles.time_step ({:.3g} s), again and again; it has no room between its neighbours. "
      "Give the particles room at the start (a lower solid fraction), lower the force that presses "
      "them, lengthen particles.time_step, or use the native backend",
      id_[sphere], x.x(), x.y(), x.z(), most_collisions, contact_time_);
}

// ---- at the start -------------------------------------------------------------------------------

namespace {

/// The share of the distance at which each would touch that it has, and who is nearest.
struct Nearest {
  std::vector<double> share;
  double worst = 1;
  int a = -1;
  int b = -1;  // a row, or -1 - side
};

void look_at_walls(const Domain& domain, const Spheres& spheres, int row, Nearest& nearest) {
  for (int side = 0; side < 6; ++side) {
    if (domain.sides[side] != SideKind::wall) continue;
    const double above =
        inward(side) * (spheres.state.position[row][side / 2] - domain.plane(side));
    const double share = above / spheres.reach[row];
    nearest.share[row] = std::min(nearest.share[row], share);
    if (share < nearest.worst) {
      nearest.worst = share;
      nearest.a = row;
      nearest.b = -1 - side;
    }
  }
}

[[noreturn]] void refuse_overlap(const ParticleState& state, const Nearest& nearest) {
  const Vector3& x = state.position[nearest.a];
  const std::string with = nearest.b < 0 ? std::string("the wall ") + side_name(-1 - nearest.b)
                                         : fmt::format("particle {}", state.id[nearest.b]);
  throw ConfigError(
      "particle {} at ({:.6g}, {:.6g}, {:.6g}) m overlaps {} by {:.3g} of the distance at which "
      "they touch; hard spheres may by {} at the start: give them room, or let them settle with "
      "stiffer springs",
      state.id[nearest.a], x.x(), x.y(), x.z(), with, 1 - nearest.worst,
      most_overlap_of_hard_spheres);
}

}  // namespace

void make_room(const Domain& domain, int first, Spheres& spheres) {
  constexpr double touching = 1e-6;  // nearer than this they have no room
  constexpr double gap = 1e-5;       // that they get, of the distance at which they touch
  const ParticleState& state = spheres.state;
  const int count = state.size();
  spheres.reach.resize(state.id.size());
  for (int row = first; row < count; ++row) spheres.reach[row] = state.radius[row];
  if (first >= count) return;
  Nearest nearest;
  nearest.share.assign(state.id.size(), never);
  CellGrid grid;
  const double largest = *std::ranges::max_element(state.radius);
  grid.sort(domain, 2 * largest, {state.position.front().data(), 3, count});
  const std::array<Vector3, 27> shifts = shift_vectors(domain);
  for (int row = first; row < count; ++row) {
    if (!state.is_fixed(row)) look_at_walls(domain, spheres, row, nearest);
    const Vector3& x = state.position[row];
    grid.visit_near(x.data(), state.radius[row] + largest, [&](int from, int to, int shift) {
      for (int place = from; place < to; ++place) {
        const int other = grid.order()[place];
        if (other == row || (state.is_fixed(row) && state.is_fixed(other))) continue;
        const double share = (state.position[other] + shifts[shift] - x).norm() /
                             (spheres.reach[row] + spheres.reach[other]);
        nearest.share[row] = std::min(nearest.share[row], share);
        nearest.share[other] = std::min(nearest.share[other], share);
        if (share < nearest.worst) {
          nearest.worst = share;
          nearest.a = row;
          nearest.b = other;
        }
      }
    });
  }
  if (1 - nearest.worst > most_overlap_of_hard_spheres) refuse_overlap(state, nearest);
  for (int row = 0; row < count; ++row) {
    if (nearest.share[row] < 1 + touching) spheres.reach[row] *= nearest.share[row] - gap;
  }
}

}  // namespace fluxpact
