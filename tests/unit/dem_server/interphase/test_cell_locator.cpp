#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <random>

#include "boxes.hpp"
#include "dem_server/interphase/cell_locator.hpp"

namespace fluxpact {
namespace {

using testing_boxes::box;
using testing_boxes::sheared;
using testing_boxes::warped;
using testing_boxes::without_lattice;

struct Located {
  explicit Located(const Mesh& mesh) : shapes(mesh), locator(mesh, shapes) {}

  /// Overlap in each cell that shares more than rounding with the ball.
  std::map<int, double> parts(const Ball& ball) const {
    std::vector<CellImage> images;
    locator.touching(ball, images);
    std::map<int, double> volumes;
    for (const CellImage& image : images) {
      const double volume = shapes.overlap(image.cell, {image.point, ball.radius});
      if (std::abs(volume) > 1e-12) volumes[image.cell] += volume;
    }
    return volumes;
  }
  double total(const Ball& ball) const {
    double sum = 0;
    for (const auto& [cell, volume] : parts(ball)) sum += volume;
    return sum;
  }

  CellShapes shapes;
  CellLocator locator;
};

class RandomPoints {
 public:
  Vector3 operator()(double low, double high) {
    std::uniform_real_distribution<double> place(low, high);
    return {place(random_), place(random_), place(random_)};
  }

 private:
  std::mt19937_64 random_{42};
};

TEST(CellLocator, finds_the_cell_by_index_arithmetic_and_by_bins_alike) {
  const Mesh mesh = box({1, 2, 3}, {5, 4, 7});
  const Located lattice(mesh);
  const Located bins(without_lattice(mesh));
  RandomPoints points;
  for (int trial = 0; trial < 2000; ++trial) {
    const Vector3 x = points(0, 1).cwiseProduct(Vector3(1, 2, 3));
    const int cell = lattice.locator.cell_of(x);
    const Vector3 off = (x - mesh.cell_centres[cell]).cwiseAbs();
    EXPECT_TRUE(off.x() <= 0.1 && off.y() <= 0.25 && off.z() <= 1.5 / 7 + 1e-15);
    EXPECT_EQ(bins.locator.cell_of(x), cell);
  }
}

TEST(CellLocator, finds_points_on_the_surface_and_none_beyond) {
  for (const bool lattice : {true, false}) {
    const Mesh mesh = box({1, 1, 1}, {3, 3, 3});
    const Located located(lattice ? mesh : without_lattice(mesh));
    EXPECT_EQ(located.locator.cell_of({0, 0, 0}), 0);
    EXPECT_EQ(located.locator.cell_of({1, 1, 1}), 26);
    EXPECT_EQ(located.locator.cell_of({1.000001, 0.5, 0.5}), -1);
    EXPECT_EQ(located.locator.cell_of({0.5, -0.000001, 0.5}), -1);
    EXPECT_EQ(located.locator.cell_of({0.5, std::numeric_limits<double>::quiet_NaN(), 0.5}), -1);
  }
}

TEST(CellLocator, finds_the_cell_in_a_graded_lattice) {
  const Mesh even = box({1, 1, 1}, {9, 3, 4});
  MeshTopology topology = static_cast<const MeshTopology&>(even);
  for (Vector3& point : topology.points) {
    point.x() *= point.x();
    point.z() = std::sqrt(point.z());
  }
  const Mesh mesh = with_geometry(std::move(topology));
  ASSERT_TRUE(mesh.lattice);
  const Located lattice(mesh);
  const Located bins(without_lattice(mesh));
  RandomPoints points;
  for (int trial = 0; trial < 500; ++trial) {
    const Vector3 x = points(0, 1);
    EXPECT_EQ(lattice.locator.cell_of(x), bins.locator.cell_of(x));
    EXPECT_NEAR(lattice.total({x, 0.1}), bins.total({x, 0.1}), 1e-12 * 60);  // cut-off of `parts`
  }
}

TEST(CellLocator, finds_the_cell_of_oblique_and_of_warped_cells) {
  const Mesh unit = box({1, 1, 1}, {4, 5, 6});
  for (const Mesh& mesh : {sheared(unit), warped(unit, 1.0 / 6)}) {
    const Located located(mesh);
    RandomPoints points;
    int inside = 0;
    for (int trial = 0; trial < 2000; ++trial) {
      const Vector3 x = points(0, 1);
      const int cell = located.locator.cell_of(x);
      if (cell < 0) continue;  // the sheared box leaves parts of the unit cube empty
      ++inside;
      // A speck about the point is wholly in that cell, unless a face is nearer than 1e-7.
      EXPECT_NEAR(located.shapes.overlap(cell, {x, 1e-7}), ball_volume(1e-7), 1e-6 * 1e-21);
    }
    EXPECT_GT(inside, 1000);
  }
}

TEST(CellLocator, finds_every_cell_that_a_ball_overlaps) {
  const Mesh unit = box({1, 1, 1}, {4, 5, 6});
  const std::vector<Mesh> meshes{unit, without_lattice(unit), sheared(unit), warped(unit, 1.0 / 6)};
  for (const Mesh& mesh : meshes) {
    const Located located(mesh);
    RandomPoints points;
    for (int trial = 0; trial < 200; ++trial) {
      const Ball ball{points(-0.1, 1.1), 0.02 + 0.4 * (trial % 4) / 3.0};
      const auto found = located.parts(ball);
      for (int cell = 0; cell < mesh.cells(); ++cell) {  // every one, asked directly
        const double volume = located.shapes.overlap(cell, ball);
        if (std::abs(volume) > 1e-12) {
          ASSERT_TRUE(found.contains(cell)) << "cell " << cell << ", trial " << trial;
          EXPECT_EQ(found.at(cell), volume);
        }
      }
    }
  }
}

TEST(CellLocator, splits_a_ball_inside_into_parts_that_add_up_to_it) {
  const Mesh unit = box({1, 1, 1}, {4, 5, 6});
  const Located oblique(sheared(unit));
  const Located bent(warped(unit, 1.0 / 6));
  RandomPoints points;
  for (int trial = 0; trial < 200; ++trial) {
    const double radius = 0.02 + 0.2 * (trial % 4) / 3.0;
    const Vector3 x = points(0.4, 0.6);
    // Some 10 cells of 36 facets' edges each, a rounding of 1e-16 R³ an edge; cut-off of `parts`.
    EXPECT_NEAR(bent.total({x, radius}), ball_volume(radius), 1e-14 + 4e-12);
    const Vector3 y(x.x() + 0.3 * x.z(), x.y() - 0.2 * x.x() - 0.06 * x.z(), x.z());
    EXPECT_NEAR(oblique.total({y, radius}), ball_volume(radius), 1e-14 + 4e-12);
  }
}

TEST(CellLocator, sees_the_images_of_a_ball_across_periodic_sides) {
  const Mesh mesh = box({1, 1, 1}, {4, 3, 1}, {Axis::x, Axis::y, Axis::z});
  for (const bool lattice : {true, false}) {
    const Located located(lattice ? mesh : without_lattice(mesh));
    EXPECT_EQ(located.locator.shortest_period(), 1.0);
    for (const Vector3& centre : {Vector3(0.01, 0.5, 0.5), Vector3(0.99, 0.02, 0.5),
                                  Vector3(0.98, 0.99, 0.01), Vector3(0, 0, 0)}) {
      for (const double radius : {0.1, 0.45, 0.7}) {
        EXPECT_NEAR(located.total({centre, radius}), ball_volume(radius), 2e-11) << lattice;
      }
    }
    for (const Vector3& centre : {Vector3(0.01, 0.5, 0.5), Vector3(0.6, 0.9, 0.2)}) {
      const Vector3 a_period_away = centre + Vector3(1, -1, 0);
      EXPECT_EQ(located.locator.cell_of(a_period_away), located.locator.cell_of(centre));
      EXPECT_NEAR(located.total({a_period_away, 0.1}), ball_volume(0.1), 2e-11) << lattice;
    }
    const auto parts = located.parts({{0, 0.5, 0.5}, 0.1});
    EXPECT_NEAR(parts.at(4), ball_volume(0.1) / 2, 1e-12);
    EXPECT_NEAR(parts.at(7), ball_volume(0.1) / 2, 1e-12);
  }
}

TEST(CellLocator, sees_images_across_oblique_periodic_sides) {
  const Mesh mesh = box({1, 1, 1}, {4, 3, 3}, {Axis::x, Axis::z});
  MeshTopology topology = static_cast<const MeshTopology&>(mesh);
  const auto shear = [](const Vector3& x) -> Vector3 {
    return {x.x() + 0.3 * x.z(), x.y(), x.z()};
  };
  for (Vector3& point : topology.points) point = shear(point);
  for (Vector3& translation : topology.translations) translation = shear(translation);
  const Located located(without_lattice(with_geometry(std::move(topology))));
  for (const Vector3& x :
       {Vector3(0.01, 0.5, 0.01), Vector3(0.99, 0.5, 0.99), Vector3(0, 0.5, 0.5)}) {
    EXPECT_NEAR(located.total({shear(x), 0.2}), ball_volume(0.2), 2e-11);
  }
}

}  // namespace
}  // namespace fluxpact
