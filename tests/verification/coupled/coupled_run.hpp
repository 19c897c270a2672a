// Both sides in one process, window by window, as the coordinator's run_step leads them: for
// verifications of what happens between them. Sockets and gate are left out; the momentum audit is
// the coordinator's.
#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <string>

#include "cfd_server/backends/native/fluid_participant.hpp"
#include "coordinator/audit/momentum_ledger.hpp"
#include "proto/mesh/box.hpp"
#include "proto/participant/asked_fields.hpp"
#include "proto/participant/field_names.hpp"

namespace fluxpact {

class CoupledRun {
 public:
  CoupledRun(const Scene& scene, std::unique_ptr<Participant> particles)
      : scene_(scene), mesh_(make_box(scene.fluid.mesh)), particles_(std::move(particles)) {
    particles_->configure(scene_, mesh_);
    fluid_.configure(scene_, mesh_);
    particles_->start({}, solids);
    fluid_.start(solids, flow);
  }

  void advance() {
    const double length = scene_.coupling.window;
    const Window window{++step_, static_cast<double>(step_ - 1) * length, length};
    Fields new_solids;
    particles_->advance(window, flow, new_solids, [] {});
    Fields new_flow;
    fluid_.advance(window, new_solids, new_flow, [] {});
    solids = new_solids;
    flow = new_flow;
    audit(length);
    particles_->commit();
    fluid_.commit();
  }

  /// Row by row, of the committed particles.
  std::vector<Vector3> of_particles(const std::string& name) {
    Fields state;
    particles_->snapshot(state);
    const int count = static_cast<int>(state.views().front().values.size());
    const auto values = state.vectors(name, count);
    return {values.begin(), values.end()};
  }
  const Mesh& mesh() const { return mesh_; }

  Fields solids, flow;       ///< of the newest window; views, valid until the next
  double worst_impulse = 0;  ///< largest errors of the momentum audit so far
  double worst_handover = 0;
  MomentumAudit newest;

 private:
  void audit(double length) {
    const int cells = mesh_.cells();
    const bool returns = !asked_of_particles(scene_).empty();
    newest = audit_momentum(
        mesh_,
        {length,
         scene_.interphase.model == PressureModel::a &&
             has_force(scene_, InterphaseForce::pressure_gradient),
         solids.scalars(field::voidage, cells), solids.scalars(field::drag_coefficient, cells),
         solids.vectors(field::drag_source, cells),
         returns ? solids.scalars(field::pressure_return, cells) : std::span<const double>{},
         flow.vectors(field::velocity, cells), flow.vectors(field::pressure_gradient, cells),
         flow.vectors(field::impulse_taken, cells), solids.vectors(field::impulse_given, cells)},
        total_);
    total_ = newest.total;
    worst_impulse = std::max(worst_impulse, newest.impulse_error);
    worst_handover = std::max(worst_handover, newest.handover_error);
  }

  Scene scene_;
  Mesh mesh_;
  std::unique_ptr<Participant> particles_;
  NativeFluid fluid_;
  MomentumTotal total_;
  std::int64_t step_ = 0;
};

}  // namespace fluxpact
