// One coupling window, from the particles' move to the commit. The first file to read; who moves
// when is in schemes.hpp.
#pragma once

#include "coordinator/audit/gate.hpp"
#include "coordinator/coupling/schemes.hpp"

namespace fluxpact {

/// What both sides sent of the last committed window, and the audit's totals up to it.
struct CommittedState {
  Message offered;  ///< what the fluid was told of the particles: in coupling.scheme parallel a
                    ///< window older than `particles`
  Message particles;
  Message fluid;
  MassTotal mass;
  MomentumTotal momentum;
  ParticleTotal solids;
};

struct StepResult {
  AuditRow row;
  Verdict verdict;
  bool committed = false;
};

/// Ask both sides for their state at time 0.
CommittedState start_coupling(const Coupling& coupling);

/// Advance both sides by one window, audit what they sent, and commit it, or roll back if the audit
/// refuses it and the scene says so. `state` moves on only with a commit. Throws ProtocolError,
/// NumericsError.
StepResult run_step(const Coupling& coupling, const Window& window, CommittedState& state);

}  // namespace fluxpact
