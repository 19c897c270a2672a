// The native fluid solver as a participant: fields in, one window of `VansSolver`, fields out.
#pragma once

#include <memory>
#include <vector>

#include "cfd_server/vans/solver.hpp"
#include "proto/participant/participant.hpp"

namespace fluxpact {

class NativeFluid final : public Participant {
 public:
  Identity identity() const override;
  void configure(const Scene& scene, const Mesh& mesh) override;

  /// in: voidage. out: velocity, pressure, pressure_gradient, face_flux; and as `advance` does what
  /// the scene's forces ask for (asked_fields.hpp).
  void start(const Fields& in, Fields& out) override;

  /// in: voidage, drag_coefficient, drag_source. out: face_flux, velocity, pressure,
  /// pressure_gradient, impulse_taken; numbers solver_iterations, closure_correction, wall_seconds.
  void advance(const Window& window, const Fields& in, Fields& out,
               const Progress& progress) override;
  void commit() override;
  void rollback() override;

  /// Adds nothing: the coordinator has all fluid fields already. Windows after it depend on them
  /// only.
  void snapshot(Fields& out) override;

 private:
  VansSolver& solver();

  void add_flow(const FlowFields& flow, Fields& out);

  int cells_ = 0;
  bool pressure_returns_ = false;  ///< whether pressure_return comes with the solids
  std::unique_ptr<VansSolver> solver_;
  std::vector<Vector3> impulse_;  ///< [N s] taken in the window in hand
};

}  // namespace fluxpact
