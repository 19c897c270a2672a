#include "coordinator/run/run.hpp"

#include <fmt/chrono.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <cmath>

#include "coordinator/coupling/run_step.hpp"
#include "coordinator/record/recorder.hpp"
#include "coordinator/run/progress.hpp"
#include "coordinator/run/summary.hpp"
#include "coordinator/scene/load_mesh.hpp"
#include "coordinator/scene/load_scene.hpp"
#include "coordinator/scene/mesh_report.hpp"
#include "coordinator/scene/particle_report.hpp"
#include "coordinator/scene/self_disturbance.hpp"
#include "coordinator/scene/surface_report.hpp"
#include "coordinator/session/interrupt.hpp"
#include "proto/base/logging.hpp"
#include "proto/base/version.hpp"
#include "proto/participant/field_names.hpp"
#include "proto/scene/read_scene.hpp"

namespace fluxpact {
namespace {

using SteadyClock = std::chrono::steady_clock;

double seconds_since(SteadyClock::time_point start) {
  return std::chrono::duration<double>(SteadyClock::now() - start).count();
}

Scene resolve_scene(const RunOptions& options) {
  std::vector<std::string> overrides = options.overrides;
  if (options.directory) overrides.push_back("output.directory=" + options.directory->string());
  if (options.until) overrides.push_back(fmt::format("scene.end_time={}", *options.until));
  Scene scene = load_scene(options.scene, overrides);
  if (scene.output.directory.empty()) scene.output.directory = "runs/" + scene.scene.name;
  return scene;
}

/// True in the windows after which something that is due every `every` seconds is recorded.
bool is_due(double every, std::int64_t step, double window) {
  if (every <= 0) return false;
  const auto interval = std::max<std::int64_t>(1, std::llround(every / window));
  return step % interval == 0;
}

std::filesystem::path open_log(const std::filesystem::path& path, const std::string& level) {
  log_to_file("coordinator", level, path);
  return path;
}

/// A run that has started: what it needs from the first window to the last.
class Run {
 public:
  Run(const Scene& scene, const Mesh& mesh, const RunOptions& options)
      : scene_(scene),
        recorder_(scene.output.directory, mesh,
                  {write_scene(scene), version_line(), scene.coupling.continuity,
                   scalar_names(scene), particles_flow(scene)}),
        log_(open_log(recorder_.directory() / "run.log", options.log_level)),
        session_(scene, mesh, log_, options.log_level),
        coupling_{scene, mesh, session_},
        progress_(windows(scene), options.quiet) {}

  ~Run() { session_.close(); }
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  ExitCode run() {
    spdlog::info("{}", mesh_line(scene_, coupling_.mesh));
    session_.greet(write_scene(scene_), coupling_.mesh);
    state_ = start_coupling(coupling_);
    summary_.start(coupling_.mesh, scene_, state_);
    record({0, 0.0}, true, true);
    try {
      advance_to_end();
    } catch (const Error&) {
      record_last_committed();
      throw;
    }
    if (moment_.step != recorded_fields_ || moment_.step != recorded_particles_)
      record(moment_, true, true);
    ask_for_figures();
    recorder_.close();
    progress_.finish();
    return interrupts() > 0 && moment_.step < windows(scene_) ? ExitCode::interrupted
                                                              : ExitCode::done;
  }

  std::string summary() const { return summary_.text(scene_, seconds_since(begin_)); }

 private:
  void advance_to_end() {
    const std::int64_t last = windows(scene_);
    const double length = scene_.coupling.window;
    for (std::int64_t step = 1; step <= last && interrupts() == 0; ++step) {
      const Window window{step, static_cast<double>(step - 1) * length, length};
      const StepResult result = run_step(coupling_, window, state_);
      if (!result.committed) {
        throw ConservationError(
            "{} Stopped at the last committed window, t = {} s; to go on all the same set "
            "coupling.audit.on_violation: warn",
            describe(result.verdict, result.row), moment_.time);
      }
      warn_of_violation(result);
      warn_of_lag(result.row.mass.epsilon_min);
      moment_ = {step, window.end()};
      const auto begin = SteadyClock::now();
      recorder_.append(result.row);
      record(moment_, is_due(scene_.output.fields.every, step, length),
             is_due(scene_.output.particles.every, step, length));
      summary_.add(result.row, state_, seconds_since(begin));
      progress_.show(step, result.row);
    }
  }

  void warn_of_violation(const StepResult& result) {
    if (result.verdict.pass) return;
    if (violations_++ == 0) spdlog::warn("{} (said once)", describe(result.verdict, result.row));
    summary_.count_violation();
  }

  void warn_of_lag(double least_voidage) {
    if (said_lag_ || scene_.coupling.scheme != CouplingScheme::parallel) return;
    const double response = late_response(scene_, least_voidage);
    if (response <= most_late_response) return;
    said_lag_ = true;
    spdlog::warn(
        "coupling.scheme parallel: where the voidage is {:.3g} the particles answer to the fluid "
        "that they displace with {:.3g} of their own motion, one window late; above {:.4g} that "
        "can "
        "swing up (said once): set coupling.scheme: serial, see docs/theory.md, section 4",
        least_voidage, response, most_late_response);
  }

  void record(const Moment& moment, bool fields, bool particles) {
    if (fields) record_fields(moment);
    if (!particles) return;
    Message request;
    request.header.type = MessageType::snapshot;
    const Message reply = session_.ask(Role::particles, request);
    recorded_particles_ = moment.step;
    if (reply.header.arrays.empty()) return;  // solids without particles
    const Fields snapshot = fields_of(reply);
    const auto count = static_cast<int>(snapshot.views().front().values.size());
    recorder_.record_particles(moment, {.id = snapshot.scalars("id", count),
                                        .position = snapshot.vectors("position", count),
                                        .velocity = snapshot.vectors("velocity", count),
                                        .spin = snapshot.vectors("spin", count),
                                        .radius = snapshot.scalars("radius", count),
                                        .density = snapshot.scalars("density", count)});
  }

  /// What mixed precision has cost is told at the end.
  void ask_for_figures() {
    if (scene_.particles.numerics.precision != Precision::mixed || !has_particles(scene_)) return;
    Message request;
    request.header.type = MessageType::snapshot;
    request.header.body["figures"] = std::int64_t{1};
    const Message reply = session_.ask(Role::particles, request);
    summary_.add_figures(fields_of(reply).numbers());
  }

  void record_fields(const Moment& moment) {
    const int cells = coupling_.mesh.cells();
    const Fields particles = fields_of(state_.particles);
    const Fields solids = fields_of(state_.offered);
    const Fields fluid = fields_of(state_.fluid);
    std::vector<std::span<const double>> scalars;
    for (const auto& [name, scalar] : scene_.fluid.scalars)
      scalars.push_back(fluid.scalars(field::scalar(name), cells));
    recorder_.record_fields(
        moment, {.voidage = solids.scalars(field::voidage, cells),
                 .velocity = fluid.vectors(field::velocity, cells),
                 .pressure = fluid.scalars(field::pressure, cells),
                 .drag_coefficient = solids.scalars(field::drag_coefficient, cells),
                 .particle_velocity = particles.vectors(field::particle_velocity, cells),
                 .face_flux = fluid.scalars(field::face_flux, coupling_.mesh.faces()),
                 .scalars = scalars});
    recorded_fields_ = moment.step;
  }

  /// After a failure: what we hold of the last committed window is kept, whatever has become of the
  /// participants.
  void record_last_committed() noexcept {
    try {
      if (recorded_fields_ != moment_.step) record_fields(moment_);
      recorder_.close();
      progress_.finish();
    } catch (const std::exception& error) {
      spdlog::error("could not record the last committed window: {}", error.what());
    }
  }

  const Scene& scene_;
  const SteadyClock::time_point begin_ = SteadyClock::now();
  Recorder recorder_;
  std::filesystem::path log_;
  Session session_;
  Coupling coupling_;
  ProgressBar progress_;
  CommittedState state_;
  Summary summary_;
  Moment moment_;
  std::int64_t recorded_fields_ = -1;
  std::int64_t recorded_particles_ = -1;
  std::int64_t violations_ = 0;
  bool said_lag_ = false;
};

}  // namespace

ExitCode run_scene(const RunOptions& options) {
  const Scene scene = resolve_scene(options);
  const Mesh mesh = load_mesh(scene);
  const std::vector<std::string> surfaces = surface_lines(scene);  // read before anything starts
  watch_for_interrupts();
  Run run(scene, mesh, options);
  for (const std::string& line : surfaces) spdlog::info("{}", line);
  for (const std::string& text : particle_warnings(scene)) spdlog::warn("{}", text);
  for (const std::string& text : self_disturbance_warnings(scene, mesh)) spdlog::warn("{}", text);
  const ExitCode code = run.run();
  if (!options.quiet) fmt::print("{}", run.summary());
  if (code == ExitCode::interrupted)
    fmt::print(stderr, "interrupted; everything up to the last committed window is saved\n");
  return code;
}

}  // namespace fluxpact
