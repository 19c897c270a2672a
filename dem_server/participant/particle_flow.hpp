// Who leaves and who comes in at the end of a window: after the engine's sub-steps, before the new
// positions are mapped. The fluid never sees an offer of one that has left.
#pragma once

#include <vector>

#include "dem_server/backends/domain.hpp"
#include "dem_server/insertion/inflow.hpp"
#include "dem_server/interphase/exchange.hpp"
#include "proto/participant/participant.hpp"

namespace fluxpact {

/// What came in and left in one window.
struct WindowFlow {
  std::int64_t entered = 0;
  std::int64_t left = 0;
  std::int64_t waiting = 0;                                ///< due so far, without room
  double mass_entered = 0;                                 ///< [kg]
  double mass_left = 0;                                    ///< [kg]
  std::vector<Vector3> momentum_entered{Vector3::Zero()};  ///< [N s] one row
  std::vector<Vector3> momentum_left{Vector3::Zero()};     ///< [N s] one row
};

/// Adds it to a result: the fields of particles_flow.
void publish_flow(const WindowFlow& flow, Fields& out);

class ParticleFlow {
 public:
  /// `initial`: the particles at time 0. Throws ConfigError if an inflow has no place in the mesh.
  ParticleFlow(const Scene& scene, const Mesh& mesh, const ParticleState& initial);

  /// After `engine.advance`. `bulk`: of the rows that moved. Candidate until commit.
  void advance(const Window& window, const ParticleBulk& bulk, ParticleEngine& engine);
  void commit();
  void rollback();

  const WindowFlow& window() const { return window_; }

  /// Row of each particle before some left or came in, -1 for one that came in; empty: none did.
  std::span<const int> row_before() const { return row_before_; }

 private:
  void find_leaving(const ParticleState& particles);
  void match_rows(int before, int entered);

  Domain domain_;
  Inflow inflow_;
  WindowFlow window_;
  bool said_waiting_ = false;
  std::vector<int> leaving_;
  std::vector<int> row_before_;
  ParticleState entering_;
  ParticleBulk entering_bulk_;
};

}  // namespace fluxpact
