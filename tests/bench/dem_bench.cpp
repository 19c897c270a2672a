// Rate of the native particle engine: particle-steps per second of processor time on a settled bed.
//
//   dem_bench [PARTICLES] [THREADS] [FRICTION] [CSV]
//
// Without a CSV of positions (insertion type `file`) the bed is packed at random and settles first.
// The window is 20 sub-steps; a line gives the rate of each of five runs of 25 windows.
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <ctime>

#include "dem_server/backends/native/native_engine.hpp"
#include "dem_server/insertion/insertion.hpp"
#include "proto/mesh/box.hpp"

namespace {

using namespace fluxpact;

constexpr double time_step = 5e-6;
constexpr double diameter = 2e-3;

Scene bed_scene(int count, int threads, double friction, const std::string& csv) {
  Scene scene;
  const double side = diameter * std::cbrt(count);
  scene.coupling.window = 20 * time_step;
  scene.fluid.mesh.box = {Vector3::Zero(), {side, side, 4 * side}, {2, 2, 2}};
  if (!csv.empty()) scene.fluid.mesh.box.upper = {0.25, 0.02, 0.6};
  scene.particles.time_step = time_step;
  scene.particles.materials["glass"].density = 2250;
  for (const char* other : {"glass", "walls"}) {
    PairSettings pair;
    pair.between = {"glass", other};
    pair.normal_stiffness = 1000;
    pair.restitution = 0.9;
    pair.friction = friction;
    scene.particles.contact.pairs.push_back(pair);
  }
  InsertionSettings bed;
  bed.material = "glass";
  bed.diameter = diameter;
  bed.count = count;
  bed.within.z = {0, 1.15 * side};
  if (!csv.empty()) bed.type = InsertionType::file;
  bed.path = csv;
  scene.particles.insertion.push_back(bed);
  scene.particles.numerics.threads = threads;
  return scene;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void report(const ParticleState& bed) {
  constexpr double mass = 9.42478e-6;  // kg
  double height = 0;
  double translation = 0;
  double rotation = 0;
  for (int i = 0; i < bed.size(); ++i) {
    height += bed.position[i].z() / bed.size();
    translation += 0.5 * mass * bed.velocity[i].squaredNorm();
    rotation += 0.2 * mass * bed.radius[i] * bed.radius[i] * bed.spin[i].squaredNorm();
  }
  fmt::print("mean height {:.10g} m, kinetic energy {:.6g} J and {:.6g} J of spin\n", height,
             translation, rotation);
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 10000;
  const int threads = argc > 2 ? std::atoi(argv[2]) : 1;
  const double friction = argc > 3 ? std::atof(argv[3]) : 0.3;
  const std::string csv = argc > 4 ? argv[4] : "";
  const Scene scene = bed_scene(count, threads, friction, csv);
  const Mesh mesh = make_box(scene.fluid.mesh);
  const auto packing = std::chrono::steady_clock::now();
  const ParticleState bed = insert_particles(scene, mesh);
  fmt::print("{} particles inserted in {:.2f} s\n", bed.size(), seconds_since(packing));
  const auto engine = make_native_engine(scene, mesh, bed);
  const std::vector<Vector3> none(bed.id.size(), Vector3::Zero());
  if (csv.empty()) {
    for (int window = 0; window < 500; ++window) {
      engine->advance(20 * time_step, 20, none, {});
      engine->commit();
    }
  }
  for (int repeat = 0; repeat < 5; ++repeat) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t clock = std::clock();
    for (int window = 0; window < 25; ++window) {
      engine->advance(20 * time_step, 20, none, {});
      engine->commit();
    }
    const double steps = 500.0 * bed.size();
    const double processor = static_cast<double>(std::clock() - clock) / CLOCKS_PER_SEC;
    fmt::print("{:.2f} M particle-steps/s of wall time, {:.2f} M per processor second\n",
               1e-6 * steps / seconds_since(start), 1e-6 * steps / processor);
    report(engine->particles());
  }
  return 0;
}
