// Cost of the native particle engine: particle-steps a second and bytes a particle, by bed, size
// and threads.
//
//   dem_bench --bed FILE.h5|CSV [--box X Y Z] [--fluidised] [--threads 1 2] [--steps N] [--repeats
//   N] dem_bench --particles 10000 40000 ... [--fluidised] [--threads 1 2] ... dem_bench --bed ...
//   --fluidised --write FILE.csv        the bed as it starts, for other engines
//
// Beds and motion: bench_bed.hpp. Each case runs in a process of its own, so that its peak memory
// is its own: what the kernel counts at most from just before the engine is made, less what was
// resident then; pages of program files count in neither. 20 steps are not timed; then `repeats`
// times `steps`, in windows of 20. One line a case, and one on the state at its end
// (compare_dem.py reads both).
#include <fmt/format.h>
#include <hwy/targets.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <map>
#include <span>

#include "dem_server/backends/native/native_engine.hpp"
#include "proto/mesh/box.hpp"
#include "tests/bench/bench_bed.hpp"

namespace {

using namespace fluxpact;

struct Options {
  std::string bed;
  std::array<double, 3> box{0.25, 0.02, 0.6};
  bool fluidised = false;
  std::string write;
  std::vector<int> particles;
  std::vector<int> threads{1};
  std::vector<Precision> precisions{Precision::full};
  bool no_avx512 = false;
  int steps = 480;
  int repeats = 5;
};

/// A line of the kernel's account of this process [B]: VmHWM (peak), VmRSS (now), of the latter
/// RssFile (pages of program files).
double memory(const std::string& line) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word != line + ":") continue;
    double kilobytes = 0;
    status >> kilobytes;
    return 1024 * kilobytes;
  }
  return 0;
}

void forget_peak_memory() { std::ofstream("/proc/self/clear_refs") << "5"; }

/// Rates of each repeat [M particle-steps/s].
struct Rates {
  std::vector<double> wall;
  std::vector<double> processor;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

double best(const std::vector<double>& values) {
  return *std::max_element(values.begin(), values.end());
}

/// `none`: a force of zero for each particle.
void run_windows(ParticleEngine& engine, std::span<const Vector3> none, int steps) {
  for (int step = 0; step < steps; step += bench_steps_per_window) {
    engine.advance(bench_steps_per_window * bench_time_step, bench_steps_per_window, none, {});
    engine.commit();
  }
}

Rates measure(ParticleEngine& engine, std::span<const Vector3> none, const Options& options) {
  Rates rates;
  for (int repeat = 0; repeat < options.repeats; ++repeat) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t clock = std::clock();
    run_windows(engine, none, options.steps);
    const double processor = static_cast<double>(std::clock() - clock) / CLOCKS_PER_SEC;
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    const double work = 1e-6 * options.steps * engine.particles().size();
    rates.wall.push_back(work / wall.count());
    rates.processor.push_back(work / processor);
  }
  return rates;
}

void print_state(const BenchBed& bed, const ParticleState& state) {
  double height = 0;
  double top = 0;
  double energy = 0;
  for (int i = 0; i < state.size(); ++i) {
    const double mass =
        4.0 / 3.0 * 3.14159265358979 * std::pow(state.radius[i], 3) * state.density[i];
    height += state.position[i].z() / state.size();
    top = std::max(top, state.position[i].z());
    energy += 0.5 * mass * state.velocity[i].squaredNorm();
  }
  const PairCount pairs = count_pairs(bed, state);
  fmt::print(
      "  end: mean height {:.12g} m, top {:.10g} m, kinetic energy {:.8g} J; a particle {:.2f} "
      "contacts, {:.2f} pairs closer than 0.3 mm\n",
      height, top, energy, pairs.contacts, pairs.near);
}

void run_case(const BenchBed& bed, int threads, Precision precision, const Options& options) {
  const int count = bed.particles.size();
  const Scene scene = bench_scene(bed, threads, precision);
  const Mesh mesh = make_box(scene.fluid.mesh);
  ParticleState start = bed.particles;
  const std::vector<Vector3> none(start.id.size(),
                                  Vector3::Zero());  // the caller's, not the engine's
  forget_peak_memory();
  const double before = memory("VmRSS") - memory("RssFile");
  const auto engine = make_native_engine(scene, mesh, std::move(start));
  run_windows(*engine, none, bench_steps_per_window);
  const Rates rates = measure(*engine, none, options);
  const double bytes = memory("VmHWM") - memory("RssFile") - before;
  const EngineCounters counters = engine->counters();
  const double lists = static_cast<double>(std::max<std::int64_t>(1, counters.rebuilds));
  fmt::print(
      "{:>8} {:>3} {:>6} | {:>7.2f} {:>7.2f} | {:>7.2f} {:>7.2f} | {:>6.0f} {:>6.0f} | {:>5.0f} "
      "{:>5.2f}\n",
      count, threads, precision == Precision::mixed ? "mixed" : "double", median(rates.wall),
      best(rates.wall), median(rates.processor), best(rates.processor), bytes / count,
      memory("VmHWM") / count, static_cast<double>(counters.sub_steps) / lists,
      static_cast<double>(counters.list_pairs) / count);
  print_state(bed, engine->particles());
}

int run_in_process_of_its_own(const BenchBed& bed, int threads, Precision precision,
                              const Options& options) {
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    run_case(bed, threads, precision, options);
    std::fflush(stdout);
    std::_Exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status == 0 ? 0 : 1;
}

int run_all(const Options& options) {
  fmt::print(
      "                    | M particle-steps a second of    | bytes a       | steps a list,\n"
      "                    |      wall       |   processor   | particle:     | pairs a\n"
      "particles thr  with |  median    best |  median  best | engine, whole | particle in it\n");
  int failed = 0;
  const std::vector<int> sizes = options.bed.empty() ? options.particles : std::vector<int>{0};
  for (const int size : sizes) {
    BenchBed bed = options.bed.empty() ? settled_bed(size)
                                       : read_bed(options.bed, Vector3(options.box.data()));
    if (options.fluidised) fluidise(bed);
    if (!options.write.empty()) {
      write_bed(bed, options.write);
      continue;
    }
    for (const int threads : options.threads) {
      for (const Precision precision : options.precisions) {
        failed += run_in_process_of_its_own(bed, threads, precision, options);
      }
    }
  }
  return failed == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Cost of the native particle engine by bed, size and threads", "dem_bench");
  auto* bed = app.add_option("--bed", options.bed, "Bed between walls: HDF5 or CSV");
  app.add_option("--box", options.box, "Upper corner of the bed's box [m]")->needs(bed);
  app.add_option("--particles", options.particles, "Sizes of beds settled here")->excludes(bed);
  app.add_flag("--fluidised", options.fluidised,
               "The bed in motion, about one new list in 50 steps");
  app.add_option("--write", options.write, "Write the bed as CSV instead of running it");
  app.add_option("--threads", options.threads, "Numbers of threads");
  const std::map<std::string, Precision> precisions{{"double", Precision::full},
                                                    {"mixed", Precision::mixed}};
  app.add_option("--precision", options.precisions, "double, mixed")
      ->transform(CLI::CheckedTransformer(precisions));
  app.add_flag("--no-avx512", options.no_avx512, "As on a processor without AVX-512");
  app.add_option("--steps", options.steps, "Timed steps of a repeat, in windows of 20")
      ->check(CLI::PositiveNumber);
  app.add_option("--repeats", options.repeats, "Timed repeats")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  if (options.no_avx512) hwy::DisableTargets(HWY_AVX3 | HWY_AVX3_DL);
  if (options.bed.empty() && options.particles.empty()) {
    options.particles = {10000, 40000, 200000, 500000, 2000000};
  }
  // Threads that wait sleep soon, as the coordinator has it for its servers.
  if (std::getenv("GOMP_SPINCOUNT") == nullptr && std::getenv("OMP_WAIT_POLICY") == nullptr) {
    setenv("GOMP_SPINCOUNT", "10000", 1);
    execv("/proc/self/exe", argv);
  }
  try {
    return run_all(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "dem_bench: {}\n", error.what());
    return 1;
  }
}
