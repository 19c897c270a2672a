// The particle side of a session: an engine that moves particles, and all that is between the
// phases.
//
// One window: forces from the last offer and the fluid's answer -> the engine's sub-steps -> who
// leaves and who comes in -> weights, voidage, mean velocity of the new positions -> the next offer
// of drag. In coupling.scheme parallel the offer comes first: late_exchange.hpp.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dem_server/interphase/exchange.hpp"
#include "dem_server/interphase/own_disturbance.hpp"
#include "dem_server/participant/late_exchange.hpp"
#include "dem_server/participant/particle_flow.hpp"
#include "proto/participant/participant.hpp"

namespace fluxpact {

/// Makes the engine with the scene's particles in it.
using EngineFactory = std::function<std::unique_ptr<ParticleEngine>(const Scene&, const Mesh&)>;

class ParticleParticipant : public Participant {
 public:
  ParticleParticipant(std::string backend, EngineFactory make_engine);

  Identity identity() const override;

  /// Throws ConfigError if the scene maps no particles (interphase.voidage: prescribed), and what
  /// the engine's factory throws.
  void configure(const Scene& scene, const Mesh& mesh) override;

  /// `in` may hold the fluid's initial velocity; without it the drag coefficient is that at u = 0.
  /// The first window finds its own (first_window.hpp).
  void start(const Fields& in, Fields& out) override;

  /// Needs velocity and pressure_gradient of the committed fluid state, one row a cell, and what
  /// the scene's forces ask for (asked_fields.hpp). Throws ProtocolError if they are missing or the
  /// last candidate was neither committed nor rolled back, NumericsError if a particle leaves the
  /// mesh, nothing has room
  /// for what over-full cells hold, a force is not finite.
  void advance(const Window& window, const Fields& in, Fields& out,
               const Progress& progress) override;
  void commit() override;
  void rollback() override;

  /// In coupling.scheme parallel, with the fields that `advance` needs in serial. Throws as that,
  /// and ProtocolError in another scheme.
  void offer(const Window& window, const Fields& in, Fields& out,
             const Progress& progress) override;

  /// id, position, velocity, spin, radius, density. Throws ProtocolError while a candidate is
  /// pending: the engine then shows that one.
  void snapshot(Fields& out) override;

  /// Of the native engine in mixed precision, if a window was committed: the numbers
  /// precision_*, which also go to the log; else nothing.
  void figures(Fields& out, const Progress& progress) override;

 private:
  std::vector<Vector3> last_force() const;
  void require_settled(const char* asked, std::int64_t step) const;
  void advance_and_offer(const Window& window, const Fields& in, Fields& out,
                         const Progress& progress);
  void advance_under_offer(const Window& window, Fields& out, const Progress& progress);
  void move_particles(const Window& window, std::span<const Vector3> force,
                      const ParticleBulk& bulk, const Progress& progress);
  void map_particles(std::int64_t step);
  void publish_offer(const Offer& offer, Fields& out, std::span<const Vector3> lent = {});
  void publish_state(std::span<Vector3> impulse_given, Fields& out);
  /// Sums over the processes that share the particles.
  AddUp add_up() const;
  void warn_of_drag();

  std::string backend_;
  EngineFactory make_engine_;
  std::unique_ptr<ParticleEngine> engine_;
  std::optional<WeightsBuilder> builder_;
  std::optional<ExcessFinder> excess_;
  std::optional<OwnDisturbance> own_;  ///< none: drag is that of the fluid as it is
  std::optional<ParticleFlow> flow_;   ///< none: nobody can come in or leave
  std::optional<LateExchange> late_;   ///< of coupling.scheme parallel
  ExchangeSettings settings_;
  int sub_steps_ = 1;
  double first_window_ = 0;  ///< [s]
  std::vector<double> cell_volumes_;
  struct Place {
    Scene scene;
    Mesh mesh;
  };
  std::optional<Place> mixed_;  ///< of particles in mixed precision, for `figures`
  double last_window_ = 0;      ///< [s] of the last committed window; 0: none was

  Offer committed_;
  Offer candidate_;
  bool pending_ = false;    ///< a candidate waits for commit or rollback
  double beyond_drag_ = 0;  ///< particles out of the range of the drag law
  bool said_drag_ = false;  ///< that many particles are beyond the range of the drag law

  // Of the newest advance. Nothing here is read by the next one.
  ParticleBulk bulk_;
  WindowForces forces_;
  OfferMaker offer_maker_;
  FluidView fluid_view_;
  double excess_moved_ = 0;           ///< [m³] out of over-full cells
  std::vector<double> cell_solids_;   ///< [m³]
  std::vector<double> voidage_seen_;  ///< if the map goes on from cell to cell
  std::vector<Vector3> velocity_before_;
  WindowFlow flow_sent_;
  std::vector<double> voidage_;
  std::vector<double> drag_coefficient_;
  std::vector<Vector3> drag_source_;
  std::vector<double> pressure_return_;  ///< empty unless pressure returns
  std::vector<Vector3> impulse_given_;
  std::vector<Vector3> particle_velocity_;
  std::vector<double> id_;
};

/// The names of the fields that every particle side gives and needs.
Identity particle_identity(const std::string& backend);

}  // namespace fluxpact
