// A particle server with an engine of its own, as docs/new-backend.md describes: spheres that fly
// under gravity and the force of the window, bounce off the sides of the domain with a restitution
// of 0.8, and pass through each other (a dilute suspension).
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "dem_server/backends/domain.hpp"
#include "dem_server/backends/engine_state.hpp"
#include "dem_server/backends/particle_rows.hpp"
#include "dem_server/participant/particle_server.hpp"
#include "proto/base/errors.hpp"

namespace {

using namespace fluxpact;

constexpr double restitution = 0.8;
constexpr int state_version = 1;

class BallisticEngine final : public ParticleEngine {
 public:
  BallisticEngine(const Scene& scene, const Mesh& mesh, ParticleState initial)
      : domain_(particle_domain(scene, mesh)),
        gravity_(scene.scene.gravity),
        materials_(static_cast<int>(scene.particles.materials.size())),
        flow_(particles_flow(scene)),
        state_(checked_rows(std::move(initial), materials_)) {}

  const ParticleState& particles() const override { return state_; }
  bool mobile() const override { return true; }

  void advance(double window, int sub_steps, std::span<const Vector3> force,
               const Progress& progress) override {
    if (committed_) rollback();
    committed_ = state_;
    const double dt = window / sub_steps;
    for (int step = 0; step < sub_steps; ++step) {
      for (int row = 0; row < state_.size(); ++row) {
        if (!state_.is_fixed(row)) fly(row, force[static_cast<std::size_t>(row)], dt);
      }
      if (progress) progress();
    }
  }
  void exchange(std::span<const int> leaving, const ParticleState& entering) override {
    exchange_rows(leaving, checked_rows(entering, materials_), state_);
  }
  void commit() override { committed_.reset(); }
  void rollback() override {
    if (committed_) state_ = *std::exchange(committed_, std::nullopt);
  }

  void store(EngineState& state) const override {
    if (committed_)
      throw ProtocolError("the ballistic engine cannot store its state: a candidate is pending");
    state.add_number("ballistic_state", state_version);
    store_rows(state_, state);
    state.add_vectors("position") = state_.position;
    state.add_vectors("velocity") = state_.velocity;
    state.add_vectors("spin") = state_.spin;
  }
  void restore(const Fields& fields) override {
    const StateReader state(fields, "ballistic_state", state_version);
    ParticleState stored = restored_rows(state, materials_, state_, flow_);
    const auto take = [&](const char* name, std::vector<Vector3>& values) {
      const auto rows = state.vectors(name, stored.id.size());
      values.assign(rows.begin(), rows.end());
    };
    take("position", stored.position);
    take("velocity", stored.velocity);
    take("spin", stored.spin);
    committed_.reset();
    state_ = std::move(stored);
  }

 private:
  void fly(int row, const Vector3& force, double dt) {
    const auto i = static_cast<std::size_t>(row);
    const double radius = state_.radius[i];
    const double mass =
        4.0 / 3.0 * 3.14159265358979323846 * radius * radius * radius * state_.density[i];
    const Vector3 acceleration = gravity_ + force / mass;
    Vector3& x = state_.position[i];
    Vector3& v = state_.velocity[i];
    x += dt * (v + 0.5 * dt * acceleration);
    v += dt * acceleration;
    for (int side = 0; side < 6; ++side) {
      if (domain_.sides[static_cast<std::size_t>(side)] != SideKind::wall) continue;
      const int axis = side / 2;
      const double inward = side % 2 == 0 ? 1 : -1;
      const double depth = radius - inward * (x[axis] - domain_.plane(side));
      if (depth <= 0) continue;
      x[axis] += inward * depth;
      if (inward * v[axis] < 0) v[axis] *= -restitution;
    }
    x = wrapped(domain_, x);
    if (const int side = lost_through(domain_, x, radius); side >= 0 || !x.allFinite()) {
      throw NumericsError(
          "particle {} at ({:.6g}, {:.6g}, {:.6g}) m left the domain through {}; let it out "
          "(particles.outflow)",
          state_.id[i], x.x(), x.y(), x.z(), side < 0 ? "infinity" : side_name(side));
    }
  }

  Domain domain_;
  Vector3 gravity_;
  int materials_;
  bool flow_;
  ParticleState state_;
  std::optional<ParticleState> committed_;  ///< while there is a candidate
};

/// What the scene asks for and this engine does not do is an error, not a surprise.
void check(const Scene& scene, const Mesh& mesh) {
  if (!scene.particles.contact.pairs.empty()) {
    throw ConfigError(
        "particles.contact.pairs: the particles of ballistic_server pass through each other; "
        "remove the pairs");
  }
  if (!faces_off_the_box(scene, mesh, particle_domain(scene, mesh)).empty()) {
    throw ConfigError("fluid.mesh: ballistic_server knows the sides of a box only");
  }
}

}  // namespace

int main(int argc, char** argv) {
  return particle_server_main(argc, argv, "ballistic_server",
                              {{ParticleBackend::custom, check,
                                [](const Scene& scene, const Mesh& mesh, ParticleState initial) {
                                  return std::make_unique<BallisticEngine>(scene, mesh,
                                                                           std::move(initial));
                                }}});
}
