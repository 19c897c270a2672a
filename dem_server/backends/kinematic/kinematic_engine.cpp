#include "dem_server/backends/kinematic/kinematic_engine.hpp"

#include <optional>

#include "dem_server/backends/domain.hpp"
#include "dem_server/backends/engine_state.hpp"
#include "dem_server/backends/particle_rows.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

class KinematicEngine final : public ParticleEngine {
 public:
  KinematicEngine(const Scene& scene, const Mesh& mesh, ParticleState initial)
      : domain_(particle_domain(scene, mesh)),
        materials_(static_cast<int>(scene.particles.materials.size())),
        flow_(particles_flow(scene)),
        presented_(checked_rows(std::move(initial), materials_)),
        committed_position_(presented_.position) {}

  const ParticleState& particles() const override { return presented_; }
  bool mobile() const override { return false; }

  void advance(double window, int, std::span<const Vector3>, const Progress& progress) override {
    has_candidate_ = true;
    for (int row = 0; row < presented_.size(); ++row) {
      const Vector3 position = committed_position_[row] + window * presented_.velocity[row];
      const int side = lost_through(domain_, position, presented_.radius[row]);
      if (side >= 0 || !position.allFinite()) refuse(row, position, side);
      presented_.position[row] = wrapped(domain_, position);
    }
    if (progress) progress();
  }
  void exchange(std::span<const int> leaving, const ParticleState& entering) override {
    if (!before_exchange_) before_exchange_ = presented_;
    exchange_rows(leaving, checked_rows(entering, materials_), presented_);
  }
  void commit() override {
    committed_position_ = presented_.position;
    before_exchange_.reset();
    has_candidate_ = false;
  }
  void rollback() override {
    if (before_exchange_) presented_ = std::move(*before_exchange_);
    before_exchange_.reset();
    presented_.position = committed_position_;
    has_candidate_ = false;
  }

  void store(EngineState& state) const override {
    if (has_candidate_) {
      throw ProtocolError("the kinematic engine cannot store its state: a candidate is pending");
    }
    state.add_number("kinematic_state", state_version);
    store_rows(presented_, state);
    state.add_vectors("position") = presented_.position;
    state.add_vectors("velocity") = presented_.velocity;
    state.add_vectors("spin") = presented_.spin;
  }
  void restore(const Fields& fields) override {
    const StateReader state(fields, "kinematic_state", state_version);
    ParticleState stored = restored_rows(state, materials_, presented_, flow_);
    const auto take = [&](const char* name, std::vector<Vector3>& values) {
      const auto rows = state.vectors(name, stored.id.size());
      values.assign(rows.begin(), rows.end());
    };
    take("position", stored.position);
    take("velocity", stored.velocity);
    take("spin", stored.spin);
    rollback();
    presented_ = std::move(stored);
    committed_position_ = presented_.position;
  }

 private:
  static constexpr int state_version = 1;

  [[noreturn]] void refuse(int row, const Vector3& at, int side) const {
    throw NumericsError(
        "particle {} of the kinematic engine would go to ({:.6g}, {:.6g}, {:.6g}) m and leave the "
        "domain "
        "through {}; lower its velocity, make that direction periodic, enlarge the box, or let it "
        "out (particles.outflow)",
        presented_.id[row], at.x(), at.y(), at.z(), side < 0 ? "infinity" : side_name(side));
  }

  Domain domain_;
  int materials_;
  bool flow_;  ///< particles come and go
  bool has_candidate_ = false;
  ParticleState presented_;
  std::vector<Vector3> committed_position_;
  std::optional<ParticleState> before_exchange_;  ///< in a window in which some entered or left
};

}  // namespace

std::unique_ptr<ParticleEngine> make_kinematic_engine(const Scene& scene, const Mesh& mesh,
                                                      ParticleState initial) {
  return std::make_unique<KinematicEngine>(scene, mesh, std::move(initial));
}

}  // namespace fluxpact
