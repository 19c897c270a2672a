// Cost of the native fluid solver: a bed with a moving surface and a rising bubble, by size and
// threads.
//
//   cfd_bench [--cells 8000 64000 512000 2097152] [--threads 1 2] [--windows N] [--general]
//
// Each case runs in a process of its own, so that its peak memory is its own (all but what the
// bench itself holds); the first three windows are not timed. One line a case.
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>

#include <CLI/CLI.hpp>
#include <cmath>
#include <ctime>
#include <fstream>

#include "cfd_server/vans/solver.hpp"
#include "proto/mesh/box.hpp"
#include "tests/unit/cfd_server/perturbed_box.hpp"

namespace {

using namespace fluxpact;

constexpr double window = 1e-4;         // s
constexpr double spacing = 5e-3;        // m
constexpr double diameter = 2e-3;       // m
constexpr double packed = 0.42;         // voidage
constexpr double particle_speed = 0.2;  // m/s
constexpr double slip = 1.0;            // m/s, for the drag

struct Options {
  std::vector<int> cells{8000, 64000, 512000, 2097152};
  std::vector<int> threads{1};
  int windows = 0;  // 0: by size
  bool general = false;
};

/// 8000 cells are the flat bed of Wu et al. (Chem. Eng. J. 152, 2009, 514-529); else a cube.
std::array<int, 3> shape_of(int cells) {
  if (cells == 8000) return {50, 2, 80};
  const int side = static_cast<int>(std::lround(std::cbrt(cells)));
  return {side, side, side};
}

Scene bed_scene(std::array<int, 3> cells, int threads) {
  Scene scene;
  scene.coupling.window = window;
  scene.scene.gravity = {0, 0, -9.81};
  scene.fluid.density = 1.2;
  scene.fluid.viscosity = 1.8e-5;
  scene.fluid.numerics.threads = threads;
  MeshSettings& mesh = scene.fluid.mesh;
  mesh.box = {Vector3::Zero(), spacing * Vector3(cells[0], cells[1], cells[2]), cells};
  mesh.patches = {{"inlet", {Side::z_min, {}}}, {"outlet", {Side::z_max, {}}}};
  BoundarySettings inlet;
  inlet.type = BoundaryType::velocity;
  inlet.superficial = Vector3(0, 0, 1);
  BoundarySettings outlet;
  outlet.type = BoundaryType::pressure;
  scene.fluid.boundaries = {{"inlet", inlet}, {"outlet", outlet}};
  scene.fluid.initial.superficial = Vector3(0, 0, 1);
  return scene;
}

/// The solids at time t: packed below half the height and outside a bubble, jumps within one cell;
/// drag by Ergun (Chem. Eng. Prog. 48, 1952, 89-94) at a slip of 1 m/s.
struct Bed {
  std::vector<Vector3> centre;
  std::vector<double> volume;
  std::vector<double> voidage;
  std::vector<double> drag;
  std::vector<Vector3> source;

  explicit Bed(const Mesh& mesh)
      : centre(mesh.cell_centres),
        volume(mesh.cell_volumes),
        voidage(volume.size()),
        drag(volume.size()),
        source(volume.size()) {}

  void move_to(double time, const Scene& scene) {
    const Vector3 top = scene.fluid.mesh.box.upper;
    const double width = std::min(top.x(), top.z());
    const Vector3 bubble(0.5 * top.x(), 0.5 * top.y(), 0.25 * top.z() + particle_speed * time);
    for (std::size_t cell = 0; cell < voidage.size(); ++cell) {
      const Vector3& at = centre[cell];
      const double surface = 0.5 * top.z() + 0.02 * top.z() * std::cos(20 * at.x() / width) +
                             particle_speed * time - at.z();
      const double from_bubble = (at - bubble).norm() - 0.12 * width;
      const double filled = std::clamp(std::min(surface, from_bubble) / spacing + 0.5, 0.0, 1.0);
      const double solids = (1 - packed) * filled;
      const double empty = 1 - solids;
      voidage[cell] = empty;
      drag[cell] = volume[cell] *
                   (150 * solids * solids * scene.fluid.viscosity / (empty * diameter * diameter) +
                    1.75 * scene.fluid.density * solids * slip / diameter);
      source[cell] = drag[cell] * Vector3(0, 0, particle_speed);
    }
  }
  SolidsInput view() const { return {voidage, drag, source}; }
  double bytes() const { return 72.0 * static_cast<double>(volume.size()); }
};

/// Peak resident memory of this process [B].
double peak_memory() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word != "VmHWM:") continue;
    double kilobytes = 0;
    status >> kilobytes;
    return 1024 * kilobytes;
  }
  return 0;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Sums over the timed windows.
struct Cost {
  int windows = 0;
  double wall = 0;       // s
  double best = 1e300;   // s, of one window
  double processor = 0;  // s
  PhaseSeconds phases;
  int iterations = 0;
  int predictor_iterations = 0;

  void add(const FluidReport& report, double wall_seconds, double processor_seconds) {
    ++windows;
    wall += wall_seconds;
    best = std::min(best, wall_seconds);
    processor += processor_seconds;
    phases.predictor += report.seconds.predictor;
    phases.assembly += report.seconds.assembly;
    phases.setup += report.seconds.setup;
    phases.pressure += report.seconds.pressure;
    phases.closure += report.seconds.closure;
    iterations += report.iterations;
    predictor_iterations += report.predictor_iterations;
  }

  void print(int cells, int threads, int solves, double bytes_per_cell) const {
    const double rest =
        wall - phases.predictor - phases.assembly - phases.setup - phases.pressure - phases.closure;
    const auto share = [&](double part) { return 100 * part / wall; };
    fmt::print(
        "{:>8} {:>3} | {:>9.2f} {:>9.2f} {:>9.2f} | {:>7.2f} | {:>5.1f} {:>5.1f} {:>5.1f} {:>5.1f} "
        "{:>5.1f} {:>5.1f} | {:>5.1f} {:>5.1f} | {:>6.0f}\n",
        cells, threads, 1e3 * wall / windows, 1e3 * best, 1e3 * processor / windows,
        1e-6 * cells * windows / wall, share(phases.predictor), share(phases.assembly),
        share(phases.setup), share(phases.pressure), share(phases.closure), share(rest),
        static_cast<double>(iterations) / (solves * windows),
        static_cast<double>(predictor_iterations) / windows, bytes_per_cell);
  }
};

void run_case(int wanted, int threads, const Options& options) {
  constexpr int untimed = 3;
  const double memory_before = peak_memory();
  const Scene scene = bed_scene(shape_of(wanted), threads);
  auto mesh = std::make_unique<Mesh>(make_box(scene.fluid.mesh));
  if (options.general) *mesh = perturbed(*mesh, Vector3::Constant(spacing), 0.15, 1);
  const int cells = mesh->cells();
  Bed bed(*mesh);
  bed.move_to(0, scene);
  VansSolver solver(scene, *mesh);
  mesh.reset();  // as the server does
  solver.start(bed.voidage);
  const int windows = options.windows > 0 ? options.windows : std::clamp(4000000 / cells, 3, 200);
  Cost cost;
  for (int step = 1; step <= untimed + windows; ++step) {
    bed.move_to(step * window, scene);
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t clock = std::clock();
    solver.advance({step, (step - 1) * window, window}, bed.view(), {});
    const double spent = seconds_since(start);
    solver.commit();
    if (step > untimed)
      cost.add(solver.report(), spent, static_cast<double>(std::clock() - clock) / CLOCKS_PER_SEC);
  }
  const FluidNumerics& numerics = scene.fluid.numerics;
  const int solves =
      (numerics.correctors + 1) * (options.general ? 1 + numerics.non_orthogonal_correctors : 1);
  cost.print(cells, threads, solves, (peak_memory() - memory_before - bed.bytes()) / cells);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Cost of the native fluid solver by size and threads", "cfd_bench");
  app.add_option("--cells", options.cells, "Sizes; 8000 is 50 x 2 x 80, others are cubes");
  app.add_option("--threads", options.threads, "Numbers of threads");
  app.add_option("--windows", options.windows, "Timed windows; 0: by size");
  app.add_flag("--general", options.general, "Points moved at random: no lattice");
  CLI11_PARSE(app, argc, argv);
  // Threads that wait sleep soon, as the coordinator has it for its servers.
  if (std::getenv("GOMP_SPINCOUNT") == nullptr && std::getenv("OMP_WAIT_POLICY") == nullptr) {
    setenv("GOMP_SPINCOUNT", "10000", 1);
    execv("/proc/self/exe", argv);
  }
  fmt::print(
      "                |        ms a window           | M cells *  | share of the time, %          "
      "      "
      "| iterations   | bytes\n"
      "   cells    thr |      wall      best processor | windows/s | predictor, assembly, set-up, "
      "pressure, closure, rest | a solve, predictor | a cell\n");
  std::fflush(stdout);
  int failed = 0;
  for (const int cells : options.cells) {
    for (const int threads : options.threads) {
      const pid_t child = fork();
      if (child == 0) {
        run_case(cells, threads, options);
        std::fflush(stdout);
        std::exit(0);
      }
      int status = 0;
      waitpid(child, &status, 0);
      failed += status == 0 ? 0 : 1;
    }
  }
  return failed == 0 ? 0 : 1;
}
