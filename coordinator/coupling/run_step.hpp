// One coupling window, from the particles' move to the commit. The first file to read.
#pragma once

#include "coordinator/audit/gate.hpp"
#include "coordinator/session/session.hpp"

namespace fluxpact {

/// What both sides sent of the last committed window, and the audit's totals up to it.
struct CommittedState {
  Message particles;
  Message fluid;
  MassTotal mass;
  MomentumTotal momentum;
  ParticleTotal solids;
};

/// What does not change from window to window.
struct Coupling {
  const Scene& scene;
  const Mesh& mesh;
  Session& session;
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
