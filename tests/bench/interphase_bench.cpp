// Cost of the exchange between particles and cells, by map: a packed bed of 2 mm spheres in the
// flat box of 0.25 x 0.02 x 0.6 m with 50 x 2 x 80 cells.
//
//   interphase_bench [--bed FILE.h5] [--maps exact centroid ...] [--threads 1] [--repeats N]
//
// Per particle and window: weights by rows, the same by columns, voidage and mean velocity, and
// what uses them: sampling of the fluid, drag, and what goes back to the cells. Then the noise that
// a map makes: rms of V ∂ε/∂t over a cell's own flux of fluid while particles move.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <ctime>
#include <functional>

#include "dem_server/insertion/random.hpp"
#include "dem_server/interphase/prediction.hpp"
#include "proto/mesh/box.hpp"
#include "proto/scene/names.hpp"
#include "tests/bench/bench_bed.hpp"

namespace {

using namespace fluxpact;

constexpr double window = 1e-4;          // s
constexpr double superficial_speed = 1;  // m/s, of the fluid

struct Options {
  std::string bed;
  std::vector<std::string> maps{"centroid", "satellite", "exact", "kernel", "diffusion"};
  double width = 8e-3;  // m, of kernel and diffusion
  int threads = 1;
  int repeats = 7;
};

/// 186,805 spheres on a cubic lattice, each moved by up to 0.4 of the free gap, in layers from
/// below.
ParticleState lattice_bed(const Vector3& upper) {
  constexpr int count = 186805;
  constexpr double filled = 0.28;  // m, of the height
  const double spacing = std::cbrt(upper.x() * upper.y() * filled / count);
  const int nx = static_cast<int>(upper.x() / spacing);
  const int ny = static_cast<int>(upper.y() / spacing);
  UniformRandom random(3);
  ParticleState bed;
  for (int i = 0; i < count; ++i) {
    const Vector3 at((i % nx + 0.5) * upper.x() / nx, (i / nx % ny + 0.5) * upper.y() / ny,
                     (i / nx / ny + 0.5) * 2.005e-3);
    const Vector3 shake(random.next() - 0.5, random.next() - 0.5, random.next() - 0.5);
    bed.id.push_back(i + 1);
    bed.position.push_back(at + 2e-4 * shake);
    bed.velocity.push_back(0.4 * shake);
    bed.spin.push_back(Vector3::Zero());
    bed.radius.push_back(0.5 * bench_diameter);
    bed.density.push_back(bench_density);
    bed.material.push_back(0);
  }
  return bed;
}

/// Of one thread its processor time, which others on the machine leave alone; of several the time
/// that passes [s].
double clock_now(int threads) {
  timespec now{};
  clock_gettime(threads == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The fastest of some calls [s].
double best_of(const Options& options, const std::function<void()>& call) {
  double best = 1e300;
  for (int k = 0; k < options.repeats; ++k) {
    const double start = clock_now(options.threads);
    call();
    best = std::min(best, clock_now(options.threads) - start);
  }
  return best;
}

struct Bench {
  Bench(const Mesh& mesh_, const ParticleState& particles_, const VoidageSettings& map,
        const Options& options_)
      : mesh(mesh_),
        particles(particles_),
        options(options_),
        builder(mesh_, map, options_.threads),
        excess(mesh_, map.smallest),
        voidage(mesh_.cell_volumes.size()),
        mean(voidage.size()),
        coefficient(voidage.size()),
        source(voidage.size()),
        velocity(voidage.size(), Vector3(0.1, 0, superficial_speed / 0.45)),
        gradient(voidage.size(), Vector3(0, 0, -9000)) {
    settings.fluid = {1.2, 1.8e-5};
    settings.gravity = {0, 0, -9.81};
    settings.drag.law = DragLaw::gidaspow;
    settings.threads = options.threads;
  }

  void build() { builder.build(particles, 1, offer.weights); }
  double map() {
    return map_voidage(offer.weights, bulk.volume, mesh.cell_volumes, excess, 1, options.threads,
                       voidage);
  }
  void mean_velocity() {
    map_velocity(offer.weights, bulk.volume, particles.velocity, options.threads, solids, mean);
  }
  void exchange() {
    const FluidSeen fluid{true, velocity, gradient};
    const FluidSeen seen = view.of(fluid, offer.weights);
    window_forces(settings, offer, seen, particles, bulk, 1, window, forces);
    maker.make(settings, seen, offer.weights.seen(std::span<const double>(voidage), voidage_seen),
               particles, bulk, {particles.velocity, window, &forces}, offer);
    deposit_vectors(offer.weights, forces.impulse, options.threads, mean);
    deposit_offer(offer, options.threads, coefficient, source);
  }

  void run(std::string_view name) {
    measure_bulk(particles, bulk);
    offer.window = window;
    build();
    map();
    offer.coefficient.assign(particles.radius.size(), 1e-6);
    offer.velocity = particles.velocity;
    exchange();
    const double per = 1e9 / particles.size();
    const double bulk_time = best_of(options, [&] { measure_bulk(particles, bulk); });
    const double build_time = best_of(options, [&] { build(); });
    const double map_time = best_of(options, [&] { map(); });
    const double mean_time = best_of(options, [&] { mean_velocity(); });
    const double exchange_time = best_of(options, [&] { exchange(); });
    const double all = bulk_time + build_time + map_time + mean_time + exchange_time;
    fmt::print("{:>10} | {:>6.2f} | {:>7.1f} {:>7.1f} {:>7.1f} {:>7.1f} {:>7.1f} | {:>7.1f} ms |",
               name, static_cast<double>(offer.weights.row_cells.size()) / particles.size(),
               per * bulk_time, per * build_time, per * map_time, per * mean_time,
               per * exchange_time, 1e3 * all);
    std::fflush(stdout);
  }

  /// rms over the cells with particles of V Δε/Δt over the fluid that crosses such a cell.
  void noise(double speed) {
    const ParticleState at_rest = particles;
    build();
    map();
    const std::vector<double> before = voidage;
    UniformRandom random(5);
    for (Vector3& x : particles.position) {
      // Sideways at random, upwards at the speed: what a fluidised bed does.
      x += window * speed * Vector3(random.next() - 0.5, random.next() - 0.5, 1);
      for (int axis = 0; axis < 3; ++axis) {
        x[axis] = std::clamp(x[axis], 1e-6, mesh.points.back()[axis] - 1e-6);
      }
    }
    build();
    map();
    double square = 0;
    int cells = 0;
    for (std::size_t c = 0; c < before.size(); ++c) {
      if (before[c] == 1) continue;
      const double height = mesh.cell_volumes[c] / face_area;
      square += std::pow((voidage[c] - before[c]) / window * height / superficial_speed, 2);
      ++cells;
    }
    fmt::print(" {:>7.3f}", std::sqrt(square / cells));
    particles = at_rest;
  }

  const Mesh& mesh;
  ParticleState particles;
  const Options& options;
  WeightsBuilder builder;
  ExcessFinder excess;
  ExchangeSettings settings;
  ParticleBulk bulk;
  WindowForces forces;
  FluidView view;
  OfferMaker maker;
  Offer offer;
  std::vector<double> voidage, voidage_seen, solids;
  std::vector<Vector3> mean;
  std::vector<double> coefficient;
  std::vector<Vector3> source, velocity, gradient;
  double face_area = 0.005 * 0.01;  // m², across the flow
};

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Cost of the exchange between particles and cells by map", "interphase_bench");
  app.add_option("--bed", options.bed, "HDF5 or CSV file of the bed; default: made here");
  app.add_option("--maps", options.maps, "Names as in the scene");
  app.add_option("--width", options.width, "Of kernel and diffusion, m");
  app.add_option("--threads", options.threads, "Number of threads");
  app.add_option("--repeats", options.repeats, "The fastest of these counts");
  CLI11_PARSE(app, argc, argv);

  MeshSettings box;
  box.box = {{0, 0, 0}, {0.25, 0.02, 0.6}, {50, 2, 80}};
  const Mesh mesh = make_box(box);
  const ParticleState bed = options.bed.empty() ? lattice_bed(box.box.upper)
                                                : read_bed(options.bed, box.box.upper).particles;
  fmt::print("{} particles, {} cells, {} threads\n", bed.size(), mesh.cells(), options.threads);
  fmt::print(
      "           | cells  |            ns a particle                | one        | rms of V dε/dt "
      "over the flux\n"
      "       map | a row  |    bulk   build voidage    mean sampling| window     | at 0.1, 0.3, "
      "1 m/s\n");
  for (const std::string& name : options.maps) {
    VoidageSettings settings(value_of<VoidageMap>(name).value());
    settings.width = options.width;
    Bench bench(mesh, bed, settings, options);
    bench.run(name);
    for (const double speed : {0.1, 0.3, 1.0}) bench.noise(speed);
    fmt::print("\n");
  }
  return 0;
}
