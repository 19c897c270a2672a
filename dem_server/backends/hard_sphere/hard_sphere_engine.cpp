#include "dem_server/backends/hard_sphere/hard_sphere_engine.hpp"

#include <algorithm>
#include <optional>

#include "dem_server/backends/engine_state.hpp"
#include "dem_server/backends/hard_sphere/hard_spheres.hpp"
#include "dem_server/backends/native/contact_law.hpp"
#include "dem_server/backends/native/soundness.hpp"
#include "dem_server/backends/particle_rows.hpp"
#include "proto/base/errors.hpp"
#include "proto/scene/size_law.hpp"

namespace fluxpact {
namespace {

constexpr int state_version = 1;

/// Diameter [m] of the largest sphere that is there or comes in.
double largest_diameter(const Scene& scene, const ParticleState& particles) {
  double largest = 0;
  for (const double radius : particles.radius) largest = std::max(largest, 2 * radius);
  for (const InflowSettings& inflow : scene.particles.inflow) {
    largest = std::max(largest, SizeLaw(inflow.diameter, inflow.sizes).largest());
  }
  return largest;
}

class HardSphereEngine final : public ParticleEngine {
 public:
  HardSphereEngine(const Scene& scene, const Mesh& mesh, ParticleState initial)
      : domain_(particle_domain(scene, mesh)),
        materials_(static_cast<int>(scene.particles.materials.size())),
        flow_(particles_flow(scene)),
        gravity_(scene.scene.gravity),
        motion_(domain_, CollisionLaws(scene.particles)) {
    spheres_.state = checked_rows(std::move(initial), materials_);
    const double largest = largest_diameter(scene, spheres_.state);
    check_periods(domain_, largest, largest);
    check_inside();
    spheres_.activity.assign(spheres_.state.id.size(), 0);
    for (Vector3& position : spheres_.state.position) position = wrapped(domain_, position);
    make_room(domain_, 0, spheres_);
    keep();
  }

  const ParticleState& particles() const override { return spheres_.state; }
  bool mobile() const override { return true; }
  EngineCounters counters() const override {
    EngineCounters counters;
    counters.sub_steps = sub_steps_;
    counters.collisions = motion_.collisions();
    counters.events = motion_.events();
    return counters;
  }

  void advance(double window, int sub_steps, std::span<const Vector3> force,
               const Progress& progress) override {
    if (has_candidate_) rollback();
    accelerate(force);
    has_candidate_ = true;
    motion_.advance(spheres_, acceleration_, window, window / sub_steps, progress);
    sub_steps_ += sub_steps;
    check_inside();
    if (progress) progress();
  }

  void exchange(std::span<const int> leaving, const ParticleState& entering) override {
    if (leaving.empty() && entering.size() == 0) return;
    if (!before_exchange_) before_exchange_ = spheres_;
    exchange_rows(leaving, checked_rows(entering, materials_), spheres_.state);
    remove_rows(leaving, spheres_.reach);
    remove_rows(leaving, spheres_.activity);
    const auto stay = static_cast<int>(spheres_.activity.size());
    spheres_.activity.resize(spheres_.state.id.size(), 0);
    make_room(domain_, stay, spheres_);
  }

  void commit() override {
    keep();
    before_exchange_.reset();
    has_candidate_ = false;
  }

  void rollback() override {
    if (!has_candidate_) return;
    if (before_exchange_) spheres_ = std::move(*before_exchange_);
    before_exchange_.reset();
    spheres_.state.position = kept_.state.position;
    spheres_.state.velocity = kept_.state.velocity;
    spheres_.state.spin = kept_.state.spin;
    spheres_.reach = kept_.reach;
    spheres_.activity = kept_.activity;
    has_candidate_ = false;
  }

  void store(EngineState& state) const override {
    if (has_candidate_) {
      throw ProtocolError("the hard_sphere engine cannot store its state: a candidate is pending");
    }
    state.add_number("hard_sphere_state", state_version);
    store_rows(spheres_.state, state);
    state.add_vectors("position") = spheres_.state.position;
    state.add_vectors("velocity") = spheres_.state.velocity;
    state.add_vectors("spin") = spheres_.state.spin;
    state.add_scalars("reach") = spheres_.reach;
    state.add_scalars("activity") = spheres_.activity;
  }

  void restore(const Fields& fields) override {
    const StateReader state(fields, "hard_sphere_state", state_version);
    Spheres stored;
    stored.state = restored_rows(state, materials_, spheres_.state, flow_);
    const auto rows = stored.state.id.size();
    const auto take = [](const auto& values, auto& to) { to.assign(values.begin(), values.end()); };
    take(state.vectors("position", rows), stored.state.position);
    take(state.vectors("velocity", rows), stored.state.velocity);
    take(state.vectors("spin", rows), stored.state.spin);
    take(state.scalars("reach", rows), stored.reach);
    take(state.scalars("activity", rows), stored.activity);
    check_stored(stored);
    rollback();
    spheres_ = std::move(stored);
    keep();
  }

 private:
  /// What can change in a window.
  void keep() {
    kept_.state.position = spheres_.state.position;
    kept_.state.velocity = spheres_.state.velocity;
    kept_.state.spin = spheres_.state.spin;
    kept_.reach = spheres_.reach;
    kept_.activity = spheres_.activity;
  }

  void accelerate(std::span<const Vector3> force) {
    const ParticleState& state = spheres_.state;
    if (static_cast<int>(force.size()) != state.size()) {
      throw NumericsError("force on the particles: {} rows for {} particles", force.size(),
                          state.size());
    }
    acceleration_.resize(force.size());
    for (int row = 0; row < state.size(); ++row) {
      const double mass = sphere_mass(state.radius[row], state.density[row]);
      acceleration_[row] = gravity_ + force[row] / mass;
      if (!acceleration_[row].allFinite()) refuse_force(state.id[row], force[row]);
    }
  }

  void check_inside() const {
    const ParticleState& state = spheres_.state;
    for (int row = 0; row < state.size(); ++row) {
      const Vector3& x = state.position[row];
      const int side = lost_through(domain_, x, state.radius[row]);
      if (side < 0 && x.allFinite()) continue;
      throw NumericsError(
          "particle {} of the hard_sphere engine at ({:.6g}, {:.6g}, {:.6g}) m is outside the "
          "domain, beyond {}, which is {}; put it inside, move that side out (fluid.mesh.box), "
          "close it, or let particles out (particles.outflow)",
          state.id[row], x.x(), x.y(), x.z(), side < 0 ? "infinity" : side_name(side),
          side >= 0 && domain_.sides[side] == SideKind::wall ? "a wall" : "open");
    }
  }

  void check_stored(const Spheres& stored) const {
    const ParticleState& state = stored.state;
    for (int row = 0; row < state.size(); ++row) {
      const double reach = stored.reach[row];
      const bool sound = state.position[row].allFinite() && state.velocity[row].allFinite() &&
                         state.spin[row].allFinite() && reach > 0 && reach <= state.radius[row] &&
                         stored.activity[row] >= 0 && std::isfinite(stored.activity[row]);
      if (sound) continue;
      throw ConfigError(
          "the stored state of particle {} has a place, speed, `reach` or `activity` that cannot "
          "be: it is damaged",
          state.id[row]);
    }
  }

  Domain domain_;
  int materials_;
  bool flow_;  ///< particles come and go
  Vector3 gravity_;
  HardSpheres motion_;
  Spheres spheres_;
  Spheres kept_;  ///< committed, without what never changes
  bool has_candidate_ = false;
  std::optional<Spheres> before_exchange_;  ///< in a window in which some entered or left
  std::vector<Vector3> acceleration_;
  std::int64_t sub_steps_ = 0;
};

}  // namespace

std::unique_ptr<ParticleEngine> make_hard_sphere_engine(const Scene& scene, const Mesh& mesh,
                                                        ParticleState initial) {
  return std::make_unique<HardSphereEngine>(scene, mesh, std::move(initial));
}

}  // namespace fluxpact
