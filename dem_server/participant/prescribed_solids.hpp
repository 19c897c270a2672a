// A particle side without particles: solids at rest whose voidage is a formula of place and time.
// For verification, where the answer must not depend on how particles are mapped.
#pragma once

#include <optional>
#include <vector>

#include "dem_server/interphase/exchange.hpp"
#include "proto/base/expression.hpp"
#include "proto/participant/participant.hpp"

namespace fluxpact {

class PrescribedSolids : public Participant {
 public:
  explicit PrescribedSolids(std::string backend) : backend_(std::move(backend)) {}

  Identity identity() const override;

  /// Throws ConfigError if interphase.prescribed is missing or its formula cannot be read.
  void configure(const Scene& scene, const Mesh& mesh) override;

  /// ε at time 0 and the drag coefficient for the velocity in `in`, for u = 0 without one.
  void start(const Fields& in, Fields& out) override;

  /// ε(x, window.end()) at the cell centres [-]; B = V β(ε, |u|) [kg/s] with the committed u; S =
  /// 0. impulse_given = Δt (B u of the fluid's last step − (1 − ε) V ∇p_d), 0 before the first.
  /// Throws NumericsError naming cell, centre and value if ε is outside (0, 1] or the drag
  /// coefficient is negative or not finite.
  void advance(const Window& window, const Fields& in, Fields& out,
               const Progress& progress) override;
  /// In coupling.scheme parallel: B of the committed ε, and impulse_given for what the fluid
  /// answered to the offer before.
  void offer(const Window& window, const Fields& in, Fields& out,
             const Progress& progress) override;
  void commit() override;
  void rollback() override;

  /// Nothing: there are no particles.
  void snapshot(Fields& out) override;

 private:
  struct State {
    double window = 0;    ///< [s] of the fluid step that answers
    bool initial = true;  ///< no fluid step has answered yet
    std::vector<double> voidage;
    std::vector<double> drag_coefficient;  ///< B [kg/s]
  };

  void find_impulse(const Window& window, const Fields& in, const State& answered);
  void find_voidage(double time, std::int64_t step);
  void find_drag(std::span<const Vector3> velocity, State& state);
  void publish_offer(const State& state, Fields& out);
  void publish_state(double wall_seconds, Fields& out);

  std::string backend_;
  ExchangeSettings settings_;
  std::optional<Expression> formula_;
  double diameter_ = 0;      ///< [m]
  double first_window_ = 0;  ///< [s]
  std::vector<double> cell_volumes_;
  std::vector<Vector3> cell_centres_;
  State answered_;  ///< of coupling.scheme parallel: what the fluid's newest state answers
  State committed_;
  State candidate_;
  bool pending_ = false;
  bool offers_ = false;   ///< coupling.scheme is parallel
  bool offered_ = false;  ///< the window to come has its offer
  std::vector<DragPoint> points_;
  std::vector<Vector3> zero_;
  std::vector<Vector3> impulse_given_;
};

}  // namespace fluxpact
