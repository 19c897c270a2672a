#include "tests/bench/bench_bed.hpp"

#include <fmt/os.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "dem_server/backends/native/native_engine.hpp"
#include "dem_server/insertion/packing.hpp"
#include "dem_server/insertion/random.hpp"
#include "dem_server/insertion/read_particles.hpp"
#include "proto/base/errors.hpp"
#include "proto/io/hdf5.hpp"
#include "proto/mesh/box.hpp"

namespace fluxpact {
namespace {

constexpr double near_distance = 3e-4;    // m
constexpr double stretch = 1.02;          // of the heights of a bed in motion
constexpr double roll_speed = 0.45;       // m/s, the largest of the rolls
constexpr double speed_deviation = 0.02;  // m/s, of each component
constexpr double packed_fraction = 0.58;  // of the block, before it settles
constexpr double block_width = 20;        // diameters
constexpr double settling_time = 0.05;    // s
constexpr double settling_step = 2e-5;    // s

void add(ParticleState& state, const Vector3& position, const Vector3& velocity, double radius) {
  state.id.push_back(state.size() + 1);
  state.position.push_back(position);
  state.velocity.push_back(velocity);
  state.spin.push_back(Vector3::Zero());
  state.radius.push_back(radius);
  state.density.push_back(bench_density);
  state.material.push_back(0);
}

ParticleState read_hdf5(const std::string& path) {
  const Hdf5File file = Hdf5File::open(path);
  const auto column = [&](const char* name) { return file.read_doubles(name); };
  const std::vector<double> x = column("/x"), y = column("/y"), z = column("/z");
  const std::vector<double> u = column("/vx"), v = column("/vy"), w = column("/vz");
  const std::vector<double> radius = column("/radius");
  ParticleState state;
  for (std::size_t i = 0; i < x.size(); ++i) {
    add(state, {x[i], y[i], z[i]}, {u[i], v[i], w[i]}, radius[i]);
  }
  return state;
}

/// Two independent normal deviates (Box & Muller 1958).
std::array<double, 2> normal_pair(UniformRandom& random) {
  const double length = std::sqrt(-2 * std::log(1 - random.next()));
  const double angle = 2 * std::numbers::pi * random.next();
  return {length * std::cos(angle), length * std::sin(angle)};
}

/// A block that has come to rest on the floor, periodic sideways.
BenchBed settled_block(int count) {
  const double fill = count * std::numbers::pi / 6 / packed_fraction;
  const double width = std::min(block_width, std::cbrt(fill));
  BenchBed block;
  block.upper = bench_diameter * Vector3(width, width, 3 * fill / (width * width));
  block.periodic = {Axis::x, Axis::y};
  const Vector3 filled(block.upper.x(), block.upper.y(), block.upper.z() / 3 + bench_diameter);
  const auto centres =
      random_packing({Vector3::Zero(), filled, {true, true, false}}, count, bench_diameter, 1);
  if (!centres) throw NumericsError("bench bed: {} spheres do not fit", count);
  for (const Vector3& centre : *centres) {
    add(block.particles, centre, Vector3::Zero(), 0.5 * bench_diameter);
  }
  Scene scene = bench_scene(block, 1, Precision::full);
  scene.particles.time_step = settling_step;
  scene.coupling.window = settling_step;
  const auto engine =
      make_native_engine(scene, make_box(scene.fluid.mesh), std::move(block.particles));
  const std::vector<Vector3> none(count, Vector3::Zero());
  engine->advance(settling_time, static_cast<int>(std::lround(settling_time / settling_step)), none,
                  {});
  block.particles = engine->particles();
  return block;
}

/// How many cells of `width` [m] a length holds, at least one.
int cells_of(double length, double width) { return std::max(1, static_cast<int>(length / width)); }

}  // namespace

Scene bench_scene(const BenchBed& bed, int threads, Precision precision) {
  Scene scene;
  scene.coupling.window = bench_steps_per_window * bench_time_step;
  scene.fluid.mesh.box = {Vector3::Zero(), bed.upper, {2, 2, 2}};
  scene.fluid.mesh.periodic = bed.periodic;
  scene.particles.time_step = bench_time_step;
  scene.particles.materials["glass"].density = bench_density;
  for (const char* other : {"glass", "walls"}) {
    PairSettings pair;
    pair.between = {"glass", other};
    pair.normal_stiffness = bench_stiffness;
    pair.restitution = bench_restitution;
    pair.friction = bench_friction;
    scene.particles.contact.pairs.push_back(pair);
  }
  scene.particles.numerics.threads = threads;
  scene.particles.numerics.precision = precision;
  return scene;
}

BenchBed read_bed(const std::string& path, const Vector3& upper) {
  BenchBed bed;
  bed.upper = upper;
  if (path.ends_with(".csv")) {
    for (const ListedParticle& row : read_particles(path)) {
      add(bed.particles, row.position, row.velocity, 0.5 * row.diameter.value_or(bench_diameter));
    }
  } else {
    bed.particles = read_hdf5(path);
  }
  return bed;
}

BenchBed settled_bed(int count) {
  const int block_count = std::min(count, bench_block_particles);
  const BenchBed block = settled_block(block_count);
  const int blocks = static_cast<int>(std::lround(static_cast<double>(count) / block_count));
  int rows = static_cast<int>(std::sqrt(blocks));
  while (blocks % rows != 0) --rows;
  const int columns = blocks / rows;
  BenchBed bed{{}, block.upper, block.periodic};
  bed.upper.x() *= columns;
  bed.upper.y() *= rows;
  for (int c = 0; c < columns; ++c) {
    for (int r = 0; r < rows; ++r) {
      const Vector3 shift(c * block.upper.x(), r * block.upper.y(), 0);
      for (int i = 0; i < block_count; ++i) {
        add(bed.particles, block.particles.position[i] + shift, block.particles.velocity[i],
            block.particles.radius[i]);
      }
    }
  }
  return bed;
}

void fluidise(BenchBed& bed) {
  UniformRandom random(1);
  double top = 0;
  for (int i = 0; i < bed.particles.size(); ++i) {
    Vector3& position = bed.particles.position[i];
    position.z() = bed.particles.radius[i] + stretch * (position.z() - bed.particles.radius[i]);
    top = std::max(top, position.z());
  }
  // Up in the middle, down at both sides: the curl of sin(2πx/L) sin(πz/H), so no volume changes.
  const double kx = 2 * std::numbers::pi / bed.upper.x();
  const double kz = std::numbers::pi / top;
  const double scale = roll_speed / std::max(kx, kz);
  for (int i = 0; i < bed.particles.size(); ++i) {
    const Vector3& x = bed.particles.position[i];
    const Vector3 roll(scale * kz * std::sin(kx * x.x()) * std::cos(kz * x.z()), 0,
                       -scale * kx * std::cos(kx * x.x()) * std::sin(kz * x.z()));
    const auto [u, v] = normal_pair(random);
    bed.particles.velocity[i] = roll + speed_deviation * Vector3(u, v, normal_pair(random)[0]);
  }
}

void write_bed(const BenchBed& bed, const std::string& path) {
  auto file = fmt::output_file(path);
  file.print("x,y,z,vx,vy,vz,diameter\n");
  for (int i = 0; i < bed.particles.size(); ++i) {
    const Vector3& x = bed.particles.position[i];
    const Vector3& v = bed.particles.velocity[i];
    file.print("{},{},{},{},{},{},{}\n", x.x(), x.y(), x.z(), v.x(), v.y(), v.z(),
               2 * bed.particles.radius[i]);
  }
}

PairCount count_pairs(const BenchBed& bed, const ParticleState& particles) {
  double reach = 0;
  for (const double radius : particles.radius) reach = std::max(reach, 2 * radius + near_distance);
  const std::array<int, 3> cells{cells_of(bed.upper.x(), reach), cells_of(bed.upper.y(), reach),
                                 cells_of(bed.upper.z(), reach)};
  const auto cell_of = [&](const Vector3& x, int axis) {
    const int cell = static_cast<int>(x[axis] / bed.upper[axis] * cells[axis]);
    return std::clamp(cell, 0, cells[axis] - 1);
  };
  const auto index = [&](int i, int j, int k) { return (i * cells[1] + j) * cells[2] + k; };
  std::vector<int> head(static_cast<std::size_t>(cells[0]) * cells[1] * cells[2], -1);
  std::vector<int> next(particles.id.size());
  for (int p = 0; p < particles.size(); ++p) {
    const Vector3& x = particles.position[p];
    next[p] = std::exchange(head[index(cell_of(x, 0), cell_of(x, 1), cell_of(x, 2))], p);
  }
  PairCount count;
  for (int p = 0; p < particles.size(); ++p) {
    const Vector3& x = particles.position[p];
    for (int offset = 0; offset < 27; ++offset) {
      const std::array<int, 3> at{cell_of(x, 0) + offset % 3 - 1,
                                  cell_of(x, 1) + offset / 3 % 3 - 1,
                                  cell_of(x, 2) + offset / 9 - 1};
      bool inside = true;
      for (int axis = 0; axis < 3; ++axis) inside &= at[axis] >= 0 && at[axis] < cells[axis];
      if (!inside) continue;
      for (int q = head[index(at[0], at[1], at[2])]; q > p; q = next[q]) {  // descending
        const double gap =
            (particles.position[q] - x).norm() - particles.radius[p] - particles.radius[q];
        count.contacts += gap < 0 ? 1 : 0;
        count.near += gap < near_distance ? 1 : 0;
      }
    }
  }
  count.contacts /= std::max(1, particles.size());
  count.near /= std::max(1, particles.size());
  return count;
}

}  // namespace fluxpact
