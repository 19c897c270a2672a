// What every map between particles and cells must keep, on every kind of mesh; then what is special
// to some: the points of `satellite`, the spread of `kernel` and `diffusion`, over-full cells.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "boxes.hpp"
#include "dem_server/interphase/satellites.hpp"
#include "mapped.hpp"
#include "proto/scene/names.hpp"
#include "tests/unit/cfd_server/test_meshes.hpp"

namespace fluxpact {
namespace {

void add_ball(ParticleState& particles, const Vector3& position, double radius) {
  particles.id.push_back(particles.size() + 1);
  particles.position.push_back(position);
  particles.velocity.emplace_back(position.y(), 1.0, -position.x());
  particles.spin.emplace_back(Vector3::Zero());
  particles.radius.push_back(radius);
  particles.density.push_back(2500);
  particles.material.push_back(0);
}

VoidageSettings settings_of(VoidageMap map, double width = 0) {
  VoidageSettings settings(map);
  settings.width = width;
  return settings;
}

// ---- all maps, on all meshes ----

constexpr double edge = 0.125;  // of a cell

Mesh mesh_named(const std::string& name) {
  TestBox unit{.cells = {8, 8, 8}};
  if (name == "box") return testing_boxes::box({1, 1, 1}, {8, 8, 8});
  if (name == "periodic") return testing_boxes::box({1, 1, 1}, {8, 8, 8}, {Axis::x, Axis::z});
  if (name == "graded") {
    MeshSettings settings;
    settings.box = {{0, 0, 0}, {1, 1, 1}, {8, 8, 8}};
    settings.box.grading.x = {{1, 1, 4}};
    settings.box.grading.z = {{0.5, 0.7, 1}, {0.5, 0.3, 0.25}};
    return make_box(settings);
  }
  if (name == "hexahedra") {
    unit.periodic = {true, false, false};
    unit.share = 0.15;
    return hexahedra(unit);
  }
  return name == "tetrahedra" ? tetrahedra(unit) : polyhedra(unit);
}

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

// ---- the spread of the smooth maps ----

/// Variance of the weights of one particle along each axis, and how far their centre is off it.
struct Spread {
  Vector3 offset{0, 0, 0};
  Vector3 variance{0, 0, 0};
};

Spread spread_of(const Mesh& mesh, const VoidageSettings& settings, const Vector3& at,
                 double radius) {
  ParticleState particles;
  add_ball(particles, at, radius);
  Mapped mapped(mesh, settings);
  mapped.map(particles);
  const std::vector<double> shares = mapped.deposited(std::vector<double>{1});
  Spread spread;
  for (int c = 0; c < mesh.cells(); ++c) spread.offset += shares[c] * (mesh.cell_centres[c] - at);
  for (int c = 0; c < mesh.cells(); ++c) {
    const Vector3 off = mesh.cell_centres[c] - at - spread.offset;
    spread.variance += shares[c] * off.cwiseProduct(off);
  }
  return spread;
}

TEST(Diffusion, spreads_a_point_as_far_as_its_width_says) {
  // A Gaussian of full width w at half height has the variance w²/(8 ln 2).
  const Mesh mesh = testing_boxes::box({1, 1, 1}, {25, 25, 25});
  VoidageSettings settings = settings_of(VoidageMap::diffusion);
  settings.from = DiffusedMap::centroid;
  for (const double width : {0.04, 0.08, 0.16, 0.3}) {
    settings.width = width;
    const Spread spread = spread_of(mesh, settings, {0.5, 0.5, 0.5}, 0.001);
    const double expected = width * width / (8 * std::numbers::ln2);
    fmt::print("diffusion over {} cells: variance {:.4f} of what it should be, {} steps\n",
               width / 0.04, spread.variance.x() / expected, CellDiffusion(mesh, width, 1).steps());
    EXPECT_LE(spread.offset.norm(), 0.01 * width);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(spread.variance[axis] / expected, 1, 0.1) << width;  // splitting of second order
    }
  }
}

TEST(Diffusion, has_the_same_bits_by_threads_and_without_them) {
  const Mesh mesh = testing_boxes::box({1, 1, 1}, {64, 64, 40});  // enough to share out
  std::vector<double> one(mesh.cell_volumes.size());
  for (std::size_t c = 0; c < one.size(); ++c) one[c] = std::sin(static_cast<double>(c));
  std::vector<double> three = one;
  CellDiffusion(mesh, 0.03, 1).spread(one);
  CellDiffusion(mesh, 0.03, 3).spread(three);
  EXPECT_EQ(one, three);
}

TEST(Kernel, spreads_a_particle_as_far_as_its_width_says) {
  // (1 − q²)³ on a ball of radius h: variance h²/11 along an axis; half height at 0.4542 h.
  const double width = 0.3;
  const double expected = std::pow(0.5 * width / 0.454202, 2) / 11;
  const Vector3 at(0.51, 0.52, 0.485);
  const Mesh mesh = testing_boxes::box({1, 1, 1}, {25, 25, 25});
  const Spread fine = spread_of(mesh, settings_of(VoidageMap::kernel, width), at, 0.01);
  // Cells add the variance of their own width, 0.04²/12.
  EXPECT_NEAR(fine.variance.x() / (expected + 0.04 * 0.04 / 12), 1, 0.02);
  EXPECT_LE(fine.offset.norm(), 0.001);
  // In diameters of the particle without a width: the same bell.
  const Spread same = spread_of(mesh, settings_of(VoidageMap::kernel), at, width / 8);
  EXPECT_NEAR((same.variance - fine.variance).norm(), 0, 1e-12);
}

TEST(Kernel, is_the_same_in_cells_of_any_kind_as_the_meshes_get_finer) {
  // The share of the lower half space, cut by a face of each mesh.
  const Vector3 at(0.5, 0.5, 0.47);
  const auto below = [&](const Mesh& mesh) {
    ParticleState particles;
    add_ball(particles, at, 0.01);
    Mapped mapped(mesh, settings_of(VoidageMap::kernel, 0.25));
    mapped.map(particles);
    const std::vector<double> shares = mapped.deposited(std::vector<double>{1});
    double sum = 0;
    for (int c = 0; c < mesh.cells(); ++c) sum += mesh.cell_centres[c].z() < 0.5 ? shares[c] : 0.0;
    return sum;
  };
  const double lattice = below(testing_boxes::box({1, 1, 1}, {20, 20, 20}));
  EXPECT_NEAR(below(tetrahedra({.cells = {10, 10, 10}})), lattice, 0.01);
  EXPECT_NEAR(below(hexahedra({.cells = {4, 4, 4}})), lattice, 0.01);  // larger than the bell
}

TEST(Centroid, keeps_rows_and_columns_when_the_number_of_particles_changes) {
  const Mesh mesh = mesh_named("box");
  Mapped mapped(mesh, settings_of(VoidageMap::centroid));
  for (const int count : {3, 5, 5, 2, 0, 4}) {
    ParticleState particles;
    for (int i = 0; i < count; ++i) add_ball(particles, {0.19 * i + 0.1, 0.3, 0.6}, 0.02);
    mapped.map(particles);
    ASSERT_EQ(mapped.weights.particles(), count);
    EXPECT_EQ(mapped.weights.row_weights, std::vector<double>(particles.id.size(), 1.0));
    EXPECT_EQ(mapped.weights.cell_weights, mapped.weights.row_weights);
    EXPECT_EQ(mapped.weights.cell_particles.size(), particles.id.size());
    for (int i = 0; i < count; ++i) {
      ASSERT_EQ(mapped.weights.row_offsets[i + 1], i + 1);
      const Vector3& centre = mesh.cell_centres[mapped.weights.row_cells[i]];
      EXPECT_LE((particles.position[i] - centre).cwiseAbs().maxCoeff(), 0.5 * edge);
    }
    EXPECT_LE(std::abs(count == 0 ? 0.0 : mapped.volume_error()), 1e-12);
  }
}

/// What a box has of the bell of radius h: by midpoints of equal pieces no larger than h/2.
double bell_in_box(const std::array<std::array<double, 2>, 3>& box, const Vector3& centre,
                   double h) {
  std::array<int, 3> parts{};
  Vector3 step;
  for (int k = 0; k < 3; ++k) {
    parts[k] = std::max(1, static_cast<int>(std::ceil((box[k][1] - box[k][0]) / (0.5 * h))));
    step[k] = (box[k][1] - box[k][0]) / parts[k];
  }
  double sum = 0;
  for (int n = 0; n < parts[0] * parts[1] * parts[2]; ++n) {
    const std::array<int, 3> at{n % parts[0], n / parts[0] % parts[1], n / parts[0] / parts[1]};
    Vector3 point;
    for (int k = 0; k < 3; ++k) point[k] = box[k][0] + (at[k] + 0.5) * step[k];
    sum += std::pow(std::max(0.0, 1 - (point - centre).squaredNorm() / (h * h)), 3);
  }
  return sum * step.prod();
}

TEST(Kernel, on_a_lattice_is_the_sum_over_the_midpoints_of_all_cells_and_images) {
  for (const char* name : {"box", "periodic", "graded"}) {
    const Mesh mesh = mesh_named(name);
    const Lattice& lattice = *mesh.lattice;
    for (const Vector3& at : {Vector3(0.5, 0.44, 0.61), Vector3(0.02, 0.03, 0.97),
                              Vector3(0.999, 0.5, 0.001), Vector3(0.25, 0.375, 0.5)}) {
      for (const double width : {0.1, 0.3, 0.8}) {
        ParticleState particles;
        add_ball(particles, at, 0.02);
        Mapped mapped(mesh, settings_of(VoidageMap::kernel, width));
        mapped.map(particles);
        const std::vector<double> shares = mapped.deposited(std::vector<double>{1});
        const double h = 0.5 * width / std::sqrt(1 - 1 / std::cbrt(2.0));
        std::vector<double> expected(shares.size());
        double total = 0;
        for (int c = 0; c < mesh.cells(); ++c) {
          const std::array<int, 3> index{c % 8, c / 8 % 8, c / 64};
          std::array<std::array<double, 2>, 3> box{};
          for (int k = 0; k < 3; ++k) {
            box[k] = {lattice.nodes[k][index[k]], lattice.nodes[k][index[k] + 1]};
          }
          for (int image = 0; image < 27; ++image) {
            const Vector3 shift(image % 3 - 1, image / 3 % 3 - 1, image / 9 - 1);
            bool there = true;
            for (int k = 0; k < 3; ++k) there = there && (shift[k] == 0 || lattice.periodic[k]);
            if (there) expected[c] += bell_in_box(box, at + shift, h);
          }
          total += expected[c];
        }
        for (int c = 0; c < mesh.cells(); ++c) {
          // Rounding of midpoints, at the steepest of the bell.
          EXPECT_NEAR(shares[c], expected[c] / total, 1e-13) << name << ' ' << c;
        }
      }
    }
  }
}

/// The largest change of a cell's solids over V_p while a sphere moves by `step` radii, steadily.
double largest_change(const Mesh& mesh, const VoidageSettings& settings, double step) {
  Mapped mapped(mesh, settings);
  std::vector<double> last;
  double largest = 0;
  for (double s = 0; s < 2.5; s += step) {
    ParticleState particles;
    const double radius = 0.3 * edge;
    add_ball(particles, Vector3(0.33, 0.44, 0.45) + s * radius * Vector3(1, 0.1, 0.2).normalized(),
             radius);
    mapped.map(particles);
    for (std::size_t c = 0; c < last.size(); ++c) {
      largest = std::max(largest, std::abs(mapped.voidage[c] - last[c]) * mesh.cell_volumes[c] /
                                      mapped.volumes[0]);
    }
    last = mapped.voidage;
  }
  return largest;
}

TEST(SmoothMaps, change_in_proportion_to_the_path_and_the_others_jump) {
  for (const char* name : {"box", "tetrahedra"}) {
    const Mesh mesh = mesh_named(name);
    for (const VoidageSettings& settings :
         {settings_of(VoidageMap::exact), settings_of(VoidageMap::kernel),
          settings_of(VoidageMap::diffusion, 0.2)}) {
      // The first is at most the sphere's section over its volume, 3/4, a radius.
      const double coarse = largest_change(mesh, settings, 0.01);
      EXPECT_LE(coarse, 0.0076) << name << ", " << name_of(settings.map);
      EXPECT_NEAR(largest_change(mesh, settings, 0.001) / coarse, 0.1, 0.01) << name;
    }
    EXPECT_NEAR(largest_change(mesh, settings_of(VoidageMap::centroid), 0.01), 1, 1e-11) << name;
    const double jump = largest_change(mesh, settings_of(VoidageMap::satellite), 0.001);
    EXPECT_GE(jump, 0.99 / 32) << name;
    EXPECT_LE(jump, 3.01 / 32) << name;
  }
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
