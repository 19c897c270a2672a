// Chooses what takes part when the scene arrives: the hello that comes before cannot know it.
#include "dem_server/participant/particle_server.hpp"

#include <algorithm>

#include "dem_server/insertion/insertion.hpp"
#include "dem_server/participant/particle_participant.hpp"
#include "dem_server/participant/prescribed_solids.hpp"
#include "proto/base/errors.hpp"
#include "proto/participant/server_main.hpp"
#include "proto/scene/names.hpp"

namespace fluxpact {
namespace {

class ChosenByScene : public Participant {
 public:
  explicit ChosenByScene(EngineMaker engine)
      : backend_(name_of(engine.backend)), engine_(std::move(engine)) {}

  Identity identity() const override { return particle_identity(backend_); }

  void keep_alive(Progress alive) override { alive_ = std::move(alive); }

  void configure(const Scene& scene, const Mesh& mesh) override {
    if (scene.interphase.voidage.map == VoidageMap::prescribed) {
      chosen_ = std::make_unique<PrescribedSolids>(backend_);
    } else {
      if (engine_.backend != scene.particles.backend) {
        throw ConfigError(
            "particles.backend is '{}', but this particle server was started as '{}'; start it "
            "with "
            "--backend {}",
            name_of(scene.particles.backend), backend_, name_of(scene.particles.backend));
      }
      chosen_ = std::make_unique<ParticleParticipant>(
          backend_, [this](const Scene& s, const Mesh& m) { return make_engine(s, m); });
    }
    chosen_->configure(scene, mesh);
  }

  void start(const Fields& in, Fields& out) override { chosen_->start(in, out); }
  void advance(const Window& window, const Fields& in, Fields& out,
               const Progress& progress) override {
    chosen_->advance(window, in, out, progress);
  }
  void offer(const Window& window, const Fields& in, Fields& out,
             const Progress& progress) override {
    chosen_->offer(window, in, out, progress);
  }
  void commit() override { chosen_->commit(); }
  void rollback() override { chosen_->rollback(); }
  void snapshot(Fields& out) override { chosen_->snapshot(out); }
  void figures(Fields& out, const Progress& progress) override { chosen_->figures(out, progress); }

 private:
  std::unique_ptr<ParticleEngine> make_engine(const Scene& scene, const Mesh& mesh) const {
    if (engine_.check_mesh) engine_.check_mesh(scene, mesh);
    return engine_.make(scene, mesh, insert_particles(scene, mesh, alive_));
  }

  std::string backend_;
  EngineMaker engine_;
  Progress alive_;
  std::unique_ptr<Participant> chosen_;  ///< set by configure, which the session calls first
};

}  // namespace

std::unique_ptr<Participant> make_particle_participant(const std::string& backend,
                                                       std::vector<EngineMaker> engines) {
  std::string known;
  for (EngineMaker& engine : engines) {
    if (backend == name_of(engine.backend))
      return std::make_unique<ChosenByScene>(std::move(engine));
    known += fmt::format("{}{}", known.empty() ? "" : ", ", name_of(engine.backend));
  }
  throw ConfigError("particle backend '{}' is not known; this program has {}", backend, known);
}

int particle_server_main(int argc, char** argv, const std::string& program,
                         std::vector<EngineMaker> engines,
                         std::map<std::string, std::string> elsewhere) {
  ServerProgram server;
  server.name = program;
  server.description = "fluxpact particle server: takes part in a session as the particle side";
  for (const EngineMaker& engine : engines) server.backends.emplace_back(name_of(engine.backend));
  server.elsewhere = std::move(elsewhere);
  server.make = [&](const std::string& backend) {
    return make_particle_participant(backend, engines);
  };
  return server_main(argc, argv, server);
}

}  // namespace fluxpact
