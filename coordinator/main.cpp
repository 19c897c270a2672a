// The coordinator: command line only.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include "coordinator/audit/audit_row.hpp"
#include "coordinator/run/run.hpp"
#include "coordinator/scene/load_mesh.hpp"
#include "coordinator/scene/load_scene.hpp"
#include "coordinator/scene/mesh_report.hpp"
#include "coordinator/scene/particle_report.hpp"
#include "coordinator/scene/self_disturbance.hpp"
#include "coordinator/scene/surface_report.hpp"
#include "proto/base/logging.hpp"
#include "proto/base/version.hpp"
#include "proto/scene/read_scene.hpp"

namespace {

using namespace fluxpact;

void check_scene(const RunOptions& options) {
  const Scene scene = load_scene(options.scene, options.overrides);
  const Mesh mesh = load_mesh(scene);
  const std::vector<std::string> surfaces = surface_lines(scene);
  fmt::print("{}: fine; {} cells, {} windows of {} s, {} sub-steps in each\n",
             options.scene.string(), mesh.cells(), windows(scene), scene.coupling.window,
             sub_steps(scene));
  fmt::print("{}{}", particle_report(scene, mesh), mesh_report(scene, mesh));
  for (const std::string& text : particle_warnings(scene)) fmt::print("  warning: {}\n", text);
  for (const std::string& text : self_disturbance_warnings(scene, mesh))
    fmt::print("  warning: {}\n", text);
  for (const std::string& line : surfaces) fmt::print("{}\n", line);
}

int dispatch(int argc, char** argv) {
  CLI::App app("fluxpact coordinator: mass-conservative CFD-DEM co-simulation", "coordinator");
  app.set_version_flag("--version", version_text());
  app.require_subcommand(1);
  RunOptions options;
  const auto add_scene = [&](CLI::App* command) {
    command
        ->add_option("scene", options.scene,
                     "Scene file (YAML); docs/scene-reference.md lists the keys")
        ->required();
    command
        ->add_option("--set", options.overrides,
                     "Override one value, e.g. --set coupling.window=1e-4")
        ->allow_extra_args(false);
  };
  CLI::App* run = app.add_subcommand("run", "Run a scene");
  add_scene(run);
  run->add_option("--out", options.directory,
                  "Results directory (default: output.directory of the scene)");
  run->add_option("--until", options.until, "End time in seconds instead of the scene's");
  run->add_option("--log-level", options.log_level, "Detail of run.log")
      ->check(CLI::IsMember(log_levels()))
      ->capture_default_str();
  run->add_flag("--quiet", options.quiet, "No progress, no summary");
  CLI::App* check = app.add_subcommand(
      "check", "Check a scene without running it; shows every error with its place");
  add_scene(check);
  CLI::App* reference = app.add_subcommand("reference", "Print a reference as Markdown");
  std::string subject = "scene";
  reference->add_option("subject", subject, "scene (its keys) or audit (the columns of audit.csv)")
      ->check(CLI::IsMember({"scene", "audit"}))
      ->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::usage);
  }
  if (*reference) {
    fmt::print("{}", subject == "scene" ? scene_reference() : audit_reference());
  } else if (*check) {
    check_scene(options);
  } else {
    return static_cast<int>(run_scene(options));
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  fluxpact::log_to_console("coordinator");
  try {
    return dispatch(argc, argv);
  } catch (const fluxpact::Error& error) {
    spdlog::error("{}", error.what());
    return static_cast<int>(error.exit_code());
  } catch (const std::exception& error) {
    spdlog::error("unexpected: {}", error.what());
    return static_cast<int>(fluxpact::ExitCode::participant);
  }
}
