#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "boxes.hpp"
#include "mapped.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

using testing_boxes::box;
using testing_boxes::sheared;
using testing_boxes::without_lattice;

void add_ball(ParticleState& particles, const Vector3& position, double radius) {
  particles.id.push_back(particles.size() + 1);
  particles.position.push_back(position);
  particles.velocity.emplace_back(Vector3::Zero());
  particles.spin.emplace_back(Vector3::Zero());
  particles.radius.push_back(radius);
  particles.density.push_back(2500);
  particles.material.push_back(0);
}

ParticleState cloud(int count, double low, double high, double radius, unsigned seed = 3) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(low, high);
  std::uniform_real_distribution<double> size(0.5 * radius, radius);
  ParticleState particles;
  for (int i = 0; i < count; ++i) {
    add_ball(particles, {place(random), place(random), place(random)}, size(random));
    particles.velocity.back() = {place(random), place(random), place(random)};
  }
  return particles;
}

// Particles fill some per cent of the meshes here: rounding 1 − ε costs about 1e-16/0.03 of them.
constexpr double volume_tolerance = 1e-13;

TEST(Weights, of_a_particle_add_up_to_one) {
  const Mesh mesh = box({1, 1, 1}, {6, 5, 4});
  const ParticleState particles = cloud(500, 0, 1, 0.3);  // many poke out of the walls
  for (const auto map : {VoidageMap::exact, VoidageMap::centroid}) {
    Mapped mapped(mesh, map);
    mapped.builder.build(particles, 1, mapped.weights);
    ASSERT_EQ(mapped.weights.particles(), 500);
    const std::vector<double> ones(mesh.cell_volumes.size(), 1.0);
    for (int p = 0; p < 500; ++p) {
      // Up to 100 cells, each share rounded once.
      EXPECT_NEAR(mapped.weights.gather(p, std::span<const double>(ones), 0.0), 1, 1e-14);
    }
    for (const double weight : mapped.weights.row_weights) EXPECT_GT(weight, 0);
  }
}

TEST(Weights, give_what_pokes_out_of_a_wall_to_its_cells_in_proportion) {
  const Mesh mesh = box({2, 1, 1}, {2, 1, 1});
  Mapped mapped(mesh, VoidageMap::exact);
  ParticleState particles;
  add_ball(particles, {1, 0.5, 0.1}, 0.3);  // half in either cell, cut by the floor
  mapped.builder.build(particles, 1, mapped.weights);
  ASSERT_EQ(mapped.weights.row_cells.size(), 2);
  EXPECT_NEAR(mapped.weights.row_weights[0], 0.5, 1e-14);
}

TEST(Weights, of_the_centroid_map_are_all_in_the_cell_of_the_centre) {
  const Mesh mesh = box({1, 1, 1}, {4, 4, 4});
  Mapped mapped(mesh, VoidageMap::centroid);
  ParticleState particles;
  add_ball(particles, {0.26, 0.1, 0.1}, 0.1);
  mapped.builder.build(particles, 1, mapped.weights);
  EXPECT_EQ(mapped.weights.row_cells, std::vector<int>{1});
  EXPECT_EQ(mapped.weights.row_weights, std::vector<double>{1.0});
}

TEST(Weights, by_cells_are_the_adjoint_of_those_by_particles) {
  const Mesh mesh = box({1, 1, 1}, {6, 5, 4}, {Axis::y});
  Mapped mapped(mesh, VoidageMap::exact);
  const ParticleState particles = cloud(300, 0, 1, 0.2);
  mapped.builder.build(particles, 1, mapped.weights);
  std::vector<double> cells(mesh.cell_volumes.size());
  for (std::size_t c = 0; c < cells.size(); ++c) cells[c] = std::sin(1.0 + static_cast<double>(c));
  CompensatedSum difference;
  for (int p = 0; p < 300; ++p) {
    difference.add(particles.velocity[p].x() *
                   mapped.weights.gather(p, std::span<const double>(cells), 0.0));
  }
  for (int c = 0; c < mesh.cells(); ++c) {
    double sum = 0;
    mapped.weights.deposit(
        c, [&](double share) { sum += share; }, [&](int p) { return particles.velocity[p].x(); });
    difference.add(-cells[c] * sum);
  }
  EXPECT_NEAR(difference.value(), 0, 300 * 2e-16);  // a rounding a particle
}

TEST(Weights, have_the_same_bits_for_any_number_of_threads) {
  const Mesh mesh = box({1, 1, 1}, {6, 5, 4}, {Axis::x});
  const ParticleState particles = cloud(301, 0, 1, 0.2);
  Mapped one(mesh, VoidageMap::exact, 1);
  one.builder.build(particles, 1, one.weights);
  for (const int threads : {2, 3, 7}) {
    Mapped many(mesh, VoidageMap::exact, threads);
    for (int repeat = 0; repeat < 2; ++repeat) {  // reused buffers, too
      many.builder.build(particles, 1, many.weights);
      EXPECT_EQ(many.weights.row_offsets, one.weights.row_offsets);
      EXPECT_EQ(many.weights.row_cells, one.weights.row_cells);
      EXPECT_EQ(many.weights.row_weights, one.weights.row_weights);
      EXPECT_EQ(many.weights.cell_offsets, one.weights.cell_offsets);
      EXPECT_EQ(many.weights.cell_particles, one.weights.cell_particles);
      EXPECT_EQ(many.weights.cell_weights, one.weights.cell_weights);
    }
  }
}

TEST(Weights, of_no_particle_are_none) {
  const Mesh mesh = box({1, 1, 1}, {2, 2, 2});
  Mapped mapped(mesh, VoidageMap::exact, 2);
  mapped.map({});
  for (const double e : mapped.voidage) EXPECT_EQ(e, 1);
}

std::string refusal(const Mesh& mesh, const ParticleState& particles) {
  try {
    Mapped mapped(mesh, VoidageMap::exact, 2);
    mapped.map(particles);
  } catch (const NumericsError& error) {
    return error.what();
  }
  return "";
}

TEST(Weights, refuse_a_particle_outside_by_name_place_and_step) {
  const Mesh mesh = box({1, 1, 1}, {2, 2, 2});
  ParticleState particles = cloud(20, 0.1, 0.9, 0.05);
  particles.position[12] = {0.5, 1.25, 0.5};
  particles.position[17].x() = std::numeric_limits<double>::quiet_NaN();
  const std::string text = refusal(mesh, particles);
  EXPECT_NE(text.find("particle 13 at (0.5, 1.25, 0.5)"), std::string::npos) << text;
  EXPECT_NE(text.find("step 7"), std::string::npos) << text;
}

TEST(Weights, refuse_a_ball_that_meets_itself_across_the_period) {
  const Mesh mesh = box({0.1, 1, 1}, {1, 2, 2}, {Axis::x});
  ParticleState particles;
  add_ball(particles, {0.05, 0.5, 0.5}, 0.1);
  EXPECT_NE(refusal(mesh, particles).find("shortest period"), std::string::npos);
}

TEST(Voidage, keeps_the_volume_of_a_sphere_that_crosses_anything) {
  struct Path {
    Vector3 from, to;
  };
  const std::vector<Path> paths{{{0.3, 0.37, 0.37}, {0.7, 0.37, 0.37}},    // a face
                                {{0.35, 0.35, 0.37}, {0.65, 0.65, 0.37}},  // an edge
                                {{0.35, 0.35, 0.35}, {0.65, 0.65, 0.65}},  // a corner
                                {{0.37, 0.3, 0.37}, {0.37, 0.0, 0.37}},    // into a wall
                                {{0.37, 0.3, 0.2}, {0.37, 0.0, 0.0}},      // into a corner of walls
                                {{0.8, 0.37, 0.37}, {1.2, 0.37, 0.37}}};   // a periodic side
  const Mesh unit = box({1, 1, 1}, {4, 4, 4}, {Axis::x});
  for (const Mesh& mesh : {unit, without_lattice(unit)}) {
    for (const auto map : {VoidageMap::exact, VoidageMap::centroid}) {
      Mapped mapped(mesh, map);
      for (std::size_t path = 0; path < paths.size(); ++path) {
        for (int k = 0; k <= 1000; ++k) {
          ParticleState particles;
          const double s = k / 1000.0;
          add_ball(particles, (1 - s) * paths[path].from + s * paths[path].to, 0.12);
          mapped.map(particles);
          ASSERT_LE(std::abs(mapped.volume_error()), volume_tolerance) << path << ", step " << k;
        }
      }
    }
  }
}

TEST(Voidage, keeps_the_volume_of_many_spheres_larger_than_a_cell) {
  const Mesh unit = box({1, 1, 1}, {12, 12, 12}, {Axis::z});
  const Mesh oblique = sheared(box({1, 1, 1}, {8, 8, 8}));
  Mapped mapped(unit, VoidageMap::exact);
  ParticleState particles;
  for (int i = 0; i < 8; ++i) {
    add_ball(particles, {0.25 + 0.5 * (i & 1), 0.25 + 0.5 * (i >> 1 & 1), 0.1 + 0.5 * (i >> 2)},
             0.2);
  }
  // Cells inside a ball are solid: that is the error of the next test, so only the weights here.
  mapped.builder.build(particles, 1, mapped.weights);
  double sum = 0;
  for (const double weight : mapped.weights.row_weights) sum += weight;
  EXPECT_NEAR(sum, 8, 1e-13);

  Mapped small(oblique, VoidageMap::exact);
  ParticleState cloudlet;
  for (int i = 0; i < 200; ++i) {
    add_ball(cloudlet, oblique.cell_centres[(i * 37) % oblique.cells()] + Vector3(0.05, 0.03, 0.04),
             0.03);
  }
  small.map(cloudlet);
  EXPECT_LE(std::abs(small.volume_error()), volume_tolerance);
}

TEST(Voidage, of_the_exact_map_changes_by_no_more_than_the_sphere_moves) {
  const Mesh mesh = box({1, 1, 1}, {4, 4, 4});
  Mapped mapped(mesh, VoidageMap::exact);
  const double radius = 0.12;
  const double step = 1e-4;
  std::vector<double> last;
  for (int k = 0; k < 3000; ++k) {
    ParticleState particles;
    add_ball(particles, Vector3(0.3, 0.31, 0.32) + k * step * Vector3(1, 0.9, 0.8), radius);
    mapped.map(particles);
    for (std::size_t c = 0; c < last.size(); ++c) {
      // What a cell gains or loses is at most what the ball sweeps: π R² times the path.
      const double change = std::abs(mapped.voidage[c] - last[c]) * mesh.cell_volumes[c];
      ASSERT_LE(change, std::numbers::pi * radius * radius * 1.57 * step) << k;
    }
    last = mapped.voidage;
  }
}

TEST(Voidage, refuses_more_than_a_closed_box_can_hold_by_name_place_and_cure) {
  const Mesh mesh = box({1, 1, 1}, {3, 3, 3});
  ParticleState particles;
  for (int i = 0; i < 8; ++i) {  // 0.84 of the box
    add_ball(particles, {0.5, 0.5, 0.5}, 0.2926);
  }
  const std::string text = refusal(mesh, particles);
  EXPECT_NE(text.find("cell 13 at (0.5, 0.5, 0."), std::string::npos) << text;
  EXPECT_NE(text.find("step 7"), std::string::npos) << text;
  EXPECT_NE(text.find("fewer particles"), std::string::npos) << text;
}

TEST(Voidage, gives_the_mean_velocity_by_volume) {
  const Mesh mesh = box({1, 1, 1}, {2, 1, 1});
  Mapped mapped(mesh, VoidageMap::exact);
  ParticleState particles;
  add_ball(particles, {0.2, 0.5, 0.5}, 0.1);
  add_ball(particles, {0.2, 0.5, 0.2}, 0.2 * std::cbrt(0.25));  // twice the volume
  particles.velocity[0] = {3, 0, 0};
  particles.velocity[1] = {0, 6, 0};
  mapped.map(particles);
  std::vector<Vector3> mean(2);
  std::vector<double> solids;
  map_velocity(mapped.weights, mapped.volumes, particles.velocity, 2, solids, mean);
  EXPECT_NEAR(solids[0], ball_volume(0.1) + ball_volume(particles.radius[1]), 1e-16);
  EXPECT_LE((mean[0] - Vector3(1, 4, 0)).norm(), 1e-14);
  EXPECT_EQ(mean[1], Vector3(0, 0, 0));
}

}  // namespace
}  // namespace fluxpact
