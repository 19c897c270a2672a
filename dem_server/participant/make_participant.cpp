// Chooses what takes part when the scene arrives: the hello that comes before cannot know it.
#include <memory>
#include <string>

#include "dem_server/backends/kinematic/kinematic_engine.hpp"
#include "dem_server/backends/native/native_engine.hpp"
#include "dem_server/insertion/insertion.hpp"
#include "dem_server/participant/particle_participant.hpp"
#include "dem_server/participant/prescribed_solids.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

const char* name_of(ParticleBackend backend) {
  return backend == ParticleBackend::native ? "native" : "kinematic";
}

std::unique_ptr<ParticleEngine> make_engine(const Scene& scene, const Mesh& mesh,
                                            const Progress& alive) {
  // Before particles are packed, which may take a while.
  if (scene.particles.backend == ParticleBackend::kinematic) check_kinematic_mesh(scene, mesh);
  ParticleState particles = insert_particles(scene, mesh, alive);
  switch (scene.particles.backend) {
    case ParticleBackend::native:
      return make_native_engine(scene, mesh, std::move(particles));
    case ParticleBackend::kinematic:
      return make_kinematic_engine(scene, mesh, std::move(particles));
  }
  throw ConfigError("particles.backend: unknown value {}",
                    static_cast<int>(scene.particles.backend));
}

class ChosenByScene : public Participant {
 public:
  explicit ChosenByScene(std::string backend) : backend_(std::move(backend)) {}

  Identity identity() const override { return particle_identity(backend_); }

  void keep_alive(Progress alive) override { alive_ = std::move(alive); }

  void configure(const Scene& scene, const Mesh& mesh) override {
    if (scene.interphase.voidage.map == VoidageMap::prescribed) {
      chosen_ = std::make_unique<PrescribedSolids>(backend_);
    } else {
      if (backend_ != name_of(scene.particles.backend)) {
        throw ConfigError(
            "particles.backend is '{}', but this particle server was started as '{}'; start it "
            "with "
            "--backend {}",
            name_of(scene.particles.backend), backend_, name_of(scene.particles.backend));
      }
      chosen_ = std::make_unique<ParticleParticipant>(
          backend_, [this](const Scene& s, const Mesh& m) { return make_engine(s, m, alive_); });
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
  std::string backend_;
  Progress alive_;
  std::unique_ptr<Participant> chosen_;  ///< set by configure, which the session calls first
};

}  // namespace

std::unique_ptr<Participant> make_particle_participant(const std::string& backend) {
  for (const auto known : {ParticleBackend::native, ParticleBackend::kinematic}) {
    if (backend == name_of(known)) return std::make_unique<ChosenByScene>(backend);
  }
  throw ConfigError("particle backend '{}' is not known; this program has native and kinematic",
                    backend);
}

}  // namespace fluxpact
