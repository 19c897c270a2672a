// How far `kernel` and `diffusion` spread a particle, and how all maps change as it moves or others
// come and go.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "map_cases.hpp"
#include "proto/scene/names.hpp"

namespace fluxpact {
namespace {

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

}  // namespace
}  // namespace fluxpact
