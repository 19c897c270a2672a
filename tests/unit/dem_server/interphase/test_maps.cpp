// What every map between particles and cells must keep, on every kind of mesh; then what is special
// to some: small balls in a lattice, the points of `satellite`, over-full cells.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "dem_server/interphase/satellites.hpp"
#include "map_cases.hpp"
#include "proto/scene/names.hpp"

namespace fluxpact {
namespace {

// ---- all maps, on all meshes ----

struct Case {
  VoidageSettings settings;
  std::string mesh;
};

std::vector<Case> all_cases() {
  VoidageSettings from_centroid = settings_of(VoidageMap::diffusion, 0.3);
  from_centroid.from = DiffusedMap::centroid;
  std::vector<Case> cases;
  for (const char* mesh : {"box", "periodic", "graded", "hexahedra", "tetrahedra", "polyhedra"}) {
    for (const VoidageSettings& settings :
         {settings_of(VoidageMap::centroid), settings_of(VoidageMap::satellite),
          settings_of(VoidageMap::exact), settings_of(VoidageMap::kernel),
          settings_of(VoidageMap::kernel, 0.3), settings_of(VoidageMap::diffusion, 0.3),
          from_centroid}) {
      cases.push_back({settings, mesh});
    }
  }
  return cases;
}

/// Spheres on faces, edges, corners, walls and anywhere, from far smaller than a cell to larger.
ParticleState spheres_everywhere() {
  ParticleState particles;
  const double on = 3 * edge;
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> place(0, 1);
  for (const double radius : {1e-4 * edge, 0.1 * edge, 0.3 * edge, 0.9 * edge}) {
    add_ball(particles, {on, 0.44, 0.44}, radius);                // a face
    add_ball(particles, {on, on, 0.44}, radius);                  // an edge
    add_ball(particles, {on, on, on}, radius);                    // a corner
    add_ball(particles, {0.44, 0.01 * radius, 0.44}, radius);     // a wall
    add_ball(particles, {0.0, 0.44, 1.0}, radius);                // a wall, or across the period
    add_ball(particles, {1e-9, 1 - 1e-9, 0.3 * radius}, radius);  // a corner of the domain
    for (int k = 0; k < 5; ++k)
      add_ball(particles, {place(random), place(random), place(random)}, radius);
  }
  return particles;
}

class AllMaps : public ::testing::TestWithParam<Case> {};

TEST_P(AllMaps, keep_volume_momentum_and_uniform_fields) {
  const Mesh mesh = mesh_named(GetParam().mesh);
  const ParticleState particles = spheres_everywhere();
  Mapped mapped(mesh, GetParam().settings, 2);
  mapped.map(particles);
  // The solids are 1e-2 of the domain: rounding 1 − ε costs 1e-16 over that.
  EXPECT_LE(std::abs(mapped.volume_error()), 1e-13);
  for (const double weight : mapped.weights.row_weights) ASSERT_GT(weight, 0);

  // Any amount, and the adjoint: Σ_p a_p Σ_c W f_c = Σ_c f_c Σ_p W a_p.
  std::vector<double> amounts;
  for (int p = 0; p < particles.size(); ++p) amounts.push_back(1 + std::sin(p));
  std::vector<double> field;
  for (int c = 0; c < mesh.cells(); ++c) field.push_back(1 + std::cos(3.0 * c));
  const std::vector<double> cells = mapped.deposited(amounts);
  std::vector<double> room;
  const auto seen = mapped.weights.seen(std::span<const double>(field), room);
  CompensatedSum whole;
  CompensatedSum product;
  double size = 0;
  for (int c = 0; c < mesh.cells(); ++c) {
    ASSERT_GE(cells[c], 0) << c;
    whole.add(cells[c]);
    product.add(cells[c] * field[c]);
  }
  for (int p = 0; p < particles.size(); ++p) {
    whole.add(-amounts[p]);
    product.add(-amounts[p] * mapped.weights.gather(p, seen, 0.0));
    size += amounts[p];
  }
  // A few roundings for each of up to some hundred cells and exchanges that a part passes.
  EXPECT_LE(std::abs(whole.value()), 1e-13 * size);
  EXPECT_LE(std::abs(product.value()), 1e-13 * size);

  const std::vector<Vector3> uniform(mesh.cell_volumes.size(), Vector3(0.1, -7, 3));
  std::vector<Vector3> vectors;
  const auto constant = mapped.weights.seen(std::span<const Vector3>(uniform), vectors);
  for (int p = 0; p < particles.size(); ++p) {
    const Vector3 got = mapped.weights.gather(p, constant, Vector3(Vector3::Zero()));
    ASSERT_LE((got - uniform[0]).norm(), 1e-13) << p;
  }
}

TEST_P(AllMaps, have_the_same_bits_for_any_number_of_threads) {
  const Mesh mesh = mesh_named(GetParam().mesh);
  const ParticleState particles = spheres_everywhere();
  Mapped one(mesh, GetParam().settings, 1);
  one.map(particles, 1);
  Mapped three(mesh, GetParam().settings, 3);
  for (int repeat = 0; repeat < 2; ++repeat) {  // reused buffers, too
    three.map(particles, 3);
    EXPECT_EQ(one.voidage, three.voidage);
    EXPECT_EQ(one.weights.row_weights, three.weights.row_weights);
    EXPECT_EQ(one.weights.cell_particles, three.weights.cell_particles);
  }
}

INSTANTIATE_TEST_SUITE_P(Everywhere, AllMaps, ::testing::ValuesIn(all_cases()),
                         [](const auto& made) {
                           return fmt::format("{}_{}_{}", name_of(made.param.settings.map),
                                              made.param.mesh, made.index);
                         });

// ---- exact, small balls in a lattice ----

TEST(LatticeShares, are_those_of_the_sum_over_all_faces) {
  MeshSettings settings;
  settings.box = {{0, 0, 0}, {1, 2, 1}, {4, 5, 3}};
  settings.box.grading.y = {{1, 1, 3}};
  settings.periodic = {Axis::x};
  const Mesh mesh = make_box(settings);
  const CellShapes shapes(mesh);
  const CellLocator locator(mesh, shapes);
  const LatticeOverlap overlap(*mesh.lattice);
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> place(0, 1);
  int found = 0;
  std::vector<CellImage> images;
  for (int k = 0; k < 4000; ++k) {
    Ball ball{{place(random), 2 * place(random), place(random)}, 0.3 * place(random)};
    if (k % 5 == 0) ball.centre.x() = 0.25 * (k % 4);   // in a plane of the mesh
    if (k % 7 == 0) ball.centre.z() = 1 - ball.radius;  // touches it
    LatticeShares shares;
    if (!overlap.find(ball, shares)) continue;
    ++found;
    images.clear();
    locator.touching(ball, images);
    std::vector<double> slow(mesh.cell_volumes.size());
    for (const CellImage& image : images) {
      slow[image.cell] += shapes.overlap(image.cell, {image.point, ball.radius});
    }
    for (int i = 0; i < shares.count; ++i) slow[shares.cells[i]] -= shares.volumes[i];
    const double tolerance = 2e-14 * std::pow(ball.radius, 3);
    for (const double left : slow) ASSERT_LE(std::abs(left), tolerance) << k;
  }
  EXPECT_GT(found, 2000);
}

// ---- satellite ----

TEST(Satellites, integrate_as_the_ball_does) {
  for (const int count : {6, 7, 27, 32, 100, 1000}) {
    const std::vector<Vector3> points = satellite_points(count);
    ASSERT_EQ(points.size(), static_cast<std::size_t>(count));
    Vector3 first = Vector3::Zero();
    Matrix3 second = Matrix3::Zero();
    for (const Vector3& point : points) {
      EXPECT_LE(point.norm(), 1.06);
      first += point / count;
      second += point * point.transpose() / count;
    }
    EXPECT_LE(first.norm(), 1e-15);
    EXPECT_LE((second - 0.2 * Matrix3::Identity()).norm(), 1e-14) << count;
  }
  // Against the shares of a ball cut by a plane anywhere along the axes.
  const std::vector<Vector3> points = satellite_points(VoidageSettings().points);
  double square = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (int k = 0; k < 100; ++k) {
      const double height = (k + 0.5) / 50 - 1;
      double below = 0;
      for (const Vector3& point : points) below += point[axis] < height ? 1.0 / 32 : 0.0;
      square += std::pow(below - cut_ball_volume(1, height) / ball_volume(1), 2) / 300;
    }
  }
  // Points at random would have 0.4/sqrt(32) = 0.07; jumps of 1/32 alone 0.009.
  EXPECT_LE(std::sqrt(square), 0.035);
}

// ---- over-full cells ----

struct Heap {
  std::string name;
  Mesh mesh;
  ParticleState particles;
};

std::vector<Heap> heaps() {
  std::vector<Heap> all;
  // A sphere five cells wide, one in a corner, and a swarm that fills a corner and its cells.
  all.push_back({"large", testing_boxes::box({1, 1, 1}, {12, 12, 12}), {}});
  add_ball(all.back().particles, {0.41, 0.52, 0.5}, 0.21);
  add_ball(all.back().particles, {0.95, 0.97, 0.1}, 0.21);
  all.push_back({"tetrahedra", tetrahedra({.cells = {6, 6, 6}}), {}});
  add_ball(all.back().particles, {0.5, 0.5, 0.5}, 0.25);
  all.push_back({"heap", testing_boxes::box({1, 1, 1}, {4, 4, 4}, {Axis::x}), {}});
  for (int k = 0; k < 300; ++k) {
    add_ball(all.back().particles, {0.02 + 0.0003 * k, 0.05, 0.1 + 0.0001 * k}, 0.06);
  }
  return all;
}

TEST(OverFullCells, pass_on_just_what_they_cannot_hold) {
  for (const Heap& heap : heaps()) {
    for (const VoidageMap map : {VoidageMap::exact, VoidageMap::centroid, VoidageMap::satellite}) {
      VoidageSettings settings(map);
      settings.smallest = 0.3;
      Mapped mapped(heap.mesh, settings);
      mapped.map(heap.particles);
      EXPECT_GT(mapped.moved, 0) << heap.name;
      EXPECT_LE(std::abs(mapped.volume_error()), 1e-13) << heap.name;
      for (int c = 0; c < heap.mesh.cells(); ++c) {
        ASSERT_GE(mapped.voidage[c], 0.3 - 1e-11) << heap.name << ", cell " << c;
        ASSERT_LE(mapped.voidage[c], 1);
      }
      // The weights have followed: the volume deposited by them is that of the voidage.
      const std::vector<double> solids = mapped.deposited(mapped.volumes);
      for (int c = 0; c < heap.mesh.cells(); ++c) {
        const double volume = heap.mesh.cell_volumes[c];
        ASSERT_NEAR(solids[c] / volume, 1 - mapped.voidage[c], 1e-12) << heap.name;
      }
      // The adjoint, and a uniform field.
      std::vector<double> field;
      for (int c = 0; c < heap.mesh.cells(); ++c) field.push_back(2 + std::sin(2.0 * c));
      std::vector<double> room;
      const auto seen = mapped.weights.seen(std::span<const double>(field), room);
      CompensatedSum difference;
      for (int p = 0; p < heap.particles.size(); ++p) {
        difference.add(mapped.volumes[p] * mapped.weights.gather(p, seen, 0.0));
      }
      for (int c = 0; c < heap.mesh.cells(); ++c) difference.add(-solids[c] * field[c]);
      EXPECT_NEAR(difference.value(), 0, 1e-14) << heap.name;
    }
  }
}

TEST(OverFullCells, pass_on_to_the_nearest_room) {
  // One cell of a row holds 1.7 of 0.8 that it may: its two neighbours take 0.45 each.
  const Mesh mesh = testing_boxes::box({7, 1, 1}, {7, 1, 1});
  ExcessFinder finder(mesh, 0.2);
  std::vector<double> solids{0, 0, 0, 1.7, 0, 0, 0};
  ExcessMoves moves;
  EXPECT_NEAR(finder.move(1, solids, moves), 0.9, 1e-15);
  const std::vector<double> near{0, 0, 0.45, 0.8, 0.45, 0, 0};
  for (int c = 0; c < 7; ++c) EXPECT_NEAR(solids[c], near[c], 1e-15);
  solids = {0, 0, 0.5, 1.0, 0.3, 0, 0};  // 0.2 too much for rooms of 0.3 and 0.5
  finder.move(1, solids, moves);
  EXPECT_NEAR(solids[2], 0.575, 1e-15);
  EXPECT_NEAR(solids[4], 0.425, 1e-15);
  // In proportion to room, as far as it goes; the rest to the next.
  solids = {0, 0.8, 0.8, 2.4, 0.6, 0, 0};
  finder.move(1, solids, moves);
  double sum = 0;
  for (int c = 0; c < 7; ++c) {
    EXPECT_LE(solids[c], 0.8 + 1e-12);
    sum += solids[c];
  }
  EXPECT_NEAR(sum, 4.6, 1e-14);
  // Nothing to do: nothing is noted.
  solids = {0.8, 0.8, 0, 0, 0, 0, 0.8};
  EXPECT_EQ(finder.move(1, solids, moves), 0);
  EXPECT_TRUE(moves.empty());
}

TEST(OverFullCells, pass_on_more_and_more_as_they_get_fuller_without_a_jump) {
  const Mesh mesh = testing_boxes::box({1, 1, 1}, {6, 6, 6});
  Mapped mapped(mesh, VoidageSettings(VoidageMap::exact));
  double last = 0;
  for (int k = 0; k < 500; ++k) {
    ParticleState particles;
    for (int i = 0; i < 6; ++i) add_ball(particles, {0.41, 0.42, 0.43}, 0.06 + 1e-5 * k);
    mapped.map(particles);
    if (k > 0) {
      EXPECT_GE(mapped.moved, last);
      EXPECT_LE(mapped.moved, last + 6 * 4 * std::numbers::pi * 0.065 * 0.065 * 1e-5);
    }
    last = mapped.moved;
  }
  EXPECT_GT(last, 0);
}

}  // namespace
}  // namespace fluxpact
