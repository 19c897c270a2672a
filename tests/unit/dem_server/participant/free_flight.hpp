// An engine without contacts, for tests of what is between the phases.
#pragma once

#include <cmath>
#include <memory>
#include <utility>

#include "dem_server/backends/particle_engine.hpp"
#include "dem_server/backends/particle_rows.hpp"

namespace fluxpact {

/// Constant acceleration over the window, integrated exactly. Positions wrap into [0, period) along
/// each axis that has a period. `held` particles stand still: something carries all of their load.
class FreeFlight : public ParticleEngine {
 public:
  FreeFlight(ParticleState initial, Vector3 gravity, Vector3 period, bool held = false)
      : committed_(std::move(initial)),
        candidate_(committed_),
        gravity_(std::move(gravity)),
        period_(std::move(period)),
        held_(held) {}

  const ParticleState& particles() const override { return newest_ ? candidate_ : committed_; }
  bool mobile() const override { return true; }
  void advance(double window, int sub_steps, std::span<const Vector3> force,
               const Progress& progress) override {
    progress();
    sub_steps_seen = sub_steps;
    candidate_ = committed_;
    newest_ = true;
    if (held_) return;
    for (int i = 0; i < candidate_.size(); ++i) {
      if (candidate_.is_fixed(i)) continue;
      const double r = candidate_.radius[i];
      const double mass = candidate_.density[i] * (4.0 / 3.0 * 3.14159265358979323846 * r * r * r);
      const Vector3 acceleration = gravity_ + force[i] / mass;
      Vector3& x = candidate_.position[i];
      x += window * candidate_.velocity[i] + 0.5 * window * window * acceleration;
      for (int a = 0; a < 3; ++a) {
        if (period_[a] > 0) x[a] -= period_[a] * std::floor(x[a] / period_[a]);
      }
      candidate_.velocity[i] += window * acceleration;
    }
  }
  void exchange(std::span<const int> leaving, const ParticleState& entering) override {
    exchange_rows(leaving, entering, candidate_);
  }
  void commit() override {
    committed_ = candidate_;
    newest_ = false;
  }
  void rollback() override { newest_ = false; }
  void store(EngineState&) const override {}  // no test asks for it
  void restore(const Fields&) override {}

  int sub_steps_seen = 0;

 private:
  ParticleState committed_;
  ParticleState candidate_;
  Vector3 gravity_;
  Vector3 period_;
  bool held_ = false;
  bool newest_ = false;
};

inline ParticleState one_sphere(const Vector3& position, double radius, double density) {
  return {{1}, {position}, {Vector3::Zero()}, {Vector3::Zero()}, {radius}, {density}, {0}};
}

}  // namespace fluxpact
