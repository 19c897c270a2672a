// Random packings: no overlap, inside, dense, reproducible.
#include "dem_server/insertion/packing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "dem_server/insertion/random.hpp"

namespace fluxpact {
namespace {

constexpr double diameter = 2e-3;

int count_for(const PackingBox& box, double fraction) {
  return static_cast<int>(fraction * box.volume() / (std::numbers::pi / 6 * std::pow(diameter, 3)));
}

/// Largest overlap [diameters] by looking at every pair with its nearest image.
double largest_overlap(const PackingBox& box, const std::vector<Vector3>& centres) {
  double largest = 0;
  for (std::size_t a = 0; a < centres.size(); ++a) {
    for (std::size_t b = a + 1; b < centres.size(); ++b) {
      Vector3 apart = centres[b] - centres[a];
      for (int axis = 0; axis < 3; ++axis) {
        const double period = box.upper[axis] - box.lower[axis];
        if (box.periodic[axis]) apart[axis] -= period * std::round(apart[axis] / period);
      }
      largest = std::max(largest, 1 - apart.norm() / diameter);
    }
  }
  return largest;
}

void expect_inside(const PackingBox& box, const std::vector<Vector3>& centres) {
  for (const Vector3& centre : centres) {
    for (int axis = 0; axis < 3; ++axis) {
      const double margin = box.periodic[axis] ? 0 : 0.5 * diameter;
      // One rounding of a sum of a side and a radius.
      EXPECT_GE(centre[axis], box.lower[axis] + margin - 1e-17);
      EXPECT_LE(centre[axis], box.upper[axis] - margin + 1e-17);
    }
  }
}

void expect_packs(const PackingBox& box, double fraction) {
  const int count = count_for(box, fraction);
  const auto centres = random_packing(box, count, diameter, 7);
  ASSERT_TRUE(centres.has_value()) << fraction;
  EXPECT_EQ(static_cast<int>(centres->size()), count);
  EXPECT_LE(largest_overlap(box, *centres), packing_overlap);
  expect_inside(box, *centres);
}

const Vector3 corner(0.01, -0.02, 0.03);
const PackingBox hard{corner, corner + Vector3::Constant(0.04), {}};
const PackingBox round{corner, corner + Vector3::Constant(0.03), {true, true, true}};

TEST(Packing, fills_a_periodic_box_to_0_60) { expect_packs(round, 0.60); }
TEST(Packing, fills_a_walled_box_to_0_58) { expect_packs(hard, 0.58); }
TEST(Packing, fills_a_thin_bed_to_0_55) {
  expect_packs({corner, corner + Vector3(0.05, 0.02, 0.08), {false, false, false}}, 0.55);
}
TEST(Packing, fills_a_mixed_box_dilutely) {
  expect_packs({corner, corner + Vector3::Constant(0.03), {true, false, true}}, 0.05);
}
TEST(Packing, fills_a_layer_just_one_sphere_thick) {
  expect_packs({corner, corner + Vector3(0.05, diameter, 0.05), {}}, 0.4);
}
TEST(Packing, of_one_sphere_fits_a_box_of_its_size) {
  const PackingBox box{corner, corner + Vector3::Constant(diameter), {}};
  const auto centre = random_packing(box, 1, diameter, 3);
  ASSERT_TRUE(centre.has_value());
  EXPECT_LT((centre->front() - corner - Vector3::Constant(0.5 * diameter)).norm(), 1e-17);
}

TEST(Packing, is_the_same_for_the_same_seed_only) {
  const auto first = random_packing(hard, 2000, diameter, 1).value();
  const auto again = random_packing(hard, 2000, diameter, 1).value();
  const auto other = random_packing(hard, 2000, diameter, 2).value();
  EXPECT_EQ(std::memcmp(first.data(), again.data(), first.size() * sizeof(Vector3)), 0);
  EXPECT_NE(first, other);
}

TEST(Packing, is_disordered) {
  // On a lattice the number of neighbours within 1.2 diameters would be the same for all.
  const auto centres = random_packing(round, count_for(round, 0.5), diameter, 1).value();
  std::vector<int> with(13, 0);
  for (const Vector3& a : centres) {
    int near = -1;
    for (const Vector3& b : centres) near += (a - b).norm() < 1.2 * diameter ? 1 : 0;
    ++with.at(near);
  }
  int kinds = 0;
  for (const int particles : with) kinds += particles > 10 ? 1 : 0;
  EXPECT_GE(kinds, 5);
}

TEST(Packing, gives_nothing_where_nothing_fits) {
  EXPECT_FALSE(random_packing(hard, count_for(hard, 0.75), diameter, 1).has_value());
  EXPECT_FALSE(
      random_packing({corner, corner + Vector3(1, 1, 0.9 * diameter), {}}, 1, diameter, 1));
  const PackingBox small{corner, corner + Vector3::Constant(5 * diameter), {}};
  EXPECT_FALSE(random_packing(small, count_for(small, 0.66), diameter, 1).has_value());
}

TEST(Packing, names_a_count_that_does_fit) {
  const PackingBox small{corner, corner + Vector3::Constant(5 * diameter), {}};
  const int asked = count_for(small, 0.8);
  const int fits = largest_packing(small, asked, diameter, 1);
  EXPECT_TRUE(random_packing(small, fits, diameter, 1).has_value());
  EXPECT_GT(fits, count_for(small, 0.45));
}

// std::mt19937_64 seeded with 5489 gives 14514284786278117030 first ([rand.predef] fixes the
// engine); the double is its upper 53 bits.
TEST(UniformRandom, is_the_upper_bits_of_the_engine) {
  UniformRandom random(5489);
  EXPECT_EQ(random.next(), static_cast<double>(14514284786278117030ULL >> 11) / 9007199254740992.0);
}

}  // namespace
}  // namespace fluxpact
