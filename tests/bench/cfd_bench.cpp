// Cost of the native fluid solver: a bed with a moving surface and a rising bubble, by size and
// threads.
//
//   cfd_bench [--cells 8000 64000 512000 2097152] [--threads 1 2] [--windows N] [--general]
//
// Each case runs in a process of its own, so that its peak memory is its own; the first windows
// (set-up, start from rest) are not timed. One line a case: milliseconds a window (wall and
// processor), cells times windows a second, share of each phase, iterations a solve, peak memory a
// cell with the mesh.
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

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
  std::vector<double> voidage;
  std::vector<double> drag;
  std::vector<Vector3> source;

  void move_to(double time, const Mesh& mesh, const Scene& scene) {
    const Vector3 top = scene.fluid.mesh.box.upper;
    const double width = std::min(top.x(), top.z());
    const Vector3 bubble(0.5 * top.x(), 0.5 * top.y(), 0.25 * top.z() + particle_speed * time);
    voidage.resize(mesh.cell_volumes.size());
    drag.resize(voidage.size());
    source.resize(voidage.size());
    for (std::size_t cell = 0; cell < voidage.size(); ++cell) {
      const Vector3& at = mesh.cell_centres[cell];
      const double surface = 0.5 * top.z() + 0.02 * top.z() * std::cos(20 * at.x() / width) +
                             particle_speed * time - at.z();
      const double from_bubble = (at - bubble).norm() - 0.12 * width;
      const double filled = std::clamp(std::min(surface, from_bubble) / spacing + 0.5, 0.0, 1.0);
      const double solids = (1 - packed) * filled;
      const double empty = 1 - solids;
      const double slip = 1.0;
      voidage[cell] = empty;
      drag[cell] = mesh.cell_volumes[cell] *
                   (150 * solids * solids * scene.fluid.viscosity / (empty * diameter * diameter) +
                    1.75 * scene.fluid.density * solids * slip / diameter);
      source[cell] = drag[cell] * Vector3(0, 0, particle_speed);
    }
  }
  SolidsInput view() const { return {voidage, drag, source}; }
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

void run_case(int wanted, int threads, const Options& options) {
  const double memory_before = peak_memory();
  const auto shape = shape_of(wanted);
  const Scene scene = bed_scene(shape, threads);
  Mesh mesh = make_box(scene.fluid.mesh);
  if (options.general) mesh = perturbed(mesh, Vector3::Constant(spacing), 0.15, 1);
  const int cells = mesh.cells();
  Bed bed;
  bed.move_to(0, mesh, scene);
  const double memory_of_bed = 40.0 * cells;  // not the server's: messages stand in their place
  VansSolver solver(scene, mesh);
  solver.start(bed.voidage);
  const int windows = options.windows > 0 ? options.windows : std::clamp(4000000 / cells, 3, 200);
  constexpr int first = 3;
  double wall = 0;
  double processor = 0;
  double best = INFINITY;
  int solves = 0;
  PhaseSeconds sum;
  double iterations = 0;
  double predictor = 0;
  for (int step = 1; step <= first + windows; ++step) {
    bed.move_to(step * window, mesh, scene);
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t clock = std::clock();
    solver.advance({step, (step - 1) * window, window}, bed.view(), {});
    const double spent = seconds_since(start);
    solver.commit();
    if (step <= first) continue;
    wall += spent;
    best = std::min(best, spent);
    processor += static_cast<double>(std::clock() - clock) / CLOCKS_PER_SEC;
    const FluidReport& report = solver.report();
    sum.predictor += report.seconds.predictor;
    sum.assembly += report.seconds.assembly;
    sum.setup += report.seconds.setup;
    sum.pressure += report.seconds.pressure;
    sum.closure += report.seconds.closure;
    iterations += report.iterations;
    predictor += report.predictor_iterations;
    solves += scene.fluid.numerics.correctors + 1;
  }
  const double rest = wall - sum.predictor - sum.assembly - sum.setup - sum.pressure - sum.closure;
  const auto share = [&](double part) { return 100 * part / wall; };
  fmt::print(
      "{:>8} {:>2} | {:>9.2f} {:>9.2f} {:>9.2f} {:>6.2f} | {:>5.1f} {:>5.1f} {:>5.1f} {:>5.1f} "
      "{:>5.1f} {:>5.1f} | {:>5.1f} {:>5.1f} | {:>6.0f}\n",
      cells, threads, 1e3 * wall / windows, 1e3 * best, 1e3 * processor / windows,
      1e-6 * cells * windows / wall, share(sum.predictor), share(sum.assembly), share(sum.setup),
      share(sum.pressure), share(sum.closure), share(rest), iterations / solves,
      predictor / windows, (peak_memory() - memory_before - memory_of_bed) / cells);
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
  fmt::print(
      "   cells  t |   ms/win      best  cpu ms/w  Mc*w/s | share %: predictor assembly setup "
      "pressure closure rest | iterations a solve, predictor | B/cell\n");
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
