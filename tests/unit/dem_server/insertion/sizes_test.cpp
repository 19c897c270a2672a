// Sizes of particles: statistics against closed forms, amounts, and what they pack to.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "dem_server/insertion/entry_sizes.hpp"
#include "dem_server/insertion/insertion.hpp"
#include "dem_server/insertion/packing.hpp"
#include "dem_server/insertion/push_apart.hpp"
#include "dem_server/insertion/random.hpp"
#include "proto/base/errors.hpp"
#include "proto/mesh/box.hpp"
#include "proto/scene/size_law.hpp"

namespace fluxpact {
namespace {

constexpr int draws = 100000;

struct Moments {
  double mean = 0, deviation = 0, mass_mean = 0;
};

Moments moments(const SizeLaw& law) {
  UniformRandom random(11);
  double sum = 0, squares = 0, cubes = 0, fourths = 0;
  for (int i = 0; i < draws; ++i) {
    const double d = law.quantile(random.next());
    sum += d;
    squares += d * d;
    cubes += d * d * d;
    fourths += d * d * d * d;
  }
  const double mean = sum / draws;
  return {mean, std::sqrt(squares / draws - mean * mean), fourths / cubes};
}

SizeSettings curve(SizeDistribution distribution, std::array<double, 2> range) {
  SizeSettings sizes;
  sizes.distribution = distribution;
  sizes.range = range;
  sizes.mean = 2e-3;
  sizes.deviation = 0.1;
  return sizes;
}

// Means of 1e5 draws scatter by deviation/sqrt(1e5) = 0.3 % of the deviation: five times that is
// allowed, of the deviation itself twice as much.

TEST(SizeLaw, uniform_by_number_has_its_mean_and_deviation) {
  const SizeLaw law(0, curve(SizeDistribution::uniform, {1e-3, 3e-3}));
  const double deviation = 2e-3 / std::sqrt(12);
  EXPECT_NEAR(moments(law).mean, 2e-3, 0.016 * deviation);
  EXPECT_NEAR(moments(law).deviation, deviation, 0.016 * deviation);
  // Mean of d³ over [1, 3]: (81 - 1)/4/2 = 10.
  EXPECT_NEAR(law.mean_volume(), std::numbers::pi / 6 * 10e-9, 1e-15);
}

TEST(SizeLaw, uniform_by_mass_has_the_mean_of_the_mass) {
  SizeSettings sizes = curve(SizeDistribution::uniform, {1e-3, 3e-3});
  sizes.by = SizeWeight::mass;
  const SizeLaw law(0, sizes);
  // By number the density falls with d^-3: mean of d is (1 - 1/3)/((1 - 1/9)/2) = 1.5. The large
  // ones carry the mass, and few of them are drawn: 1 %.
  EXPECT_NEAR(moments(law).mean, 1.5e-3, 0.016 * 0.5e-3);
  EXPECT_NEAR(moments(law).mass_mean, 2e-3, 0.01 * 2e-3);
}

TEST(SizeLaw, normal_and_lognormal_have_their_parameters) {
  const SizeLaw normal(0, curve(SizeDistribution::normal, {1e-3, 3e-3}));  // cut at 5 deviations
  EXPECT_NEAR(moments(normal).mean, 2e-3, 0.016 * 0.2e-3);
  EXPECT_NEAR(moments(normal).deviation, 0.2e-3, 0.016 * 0.2e-3);
  const SizeLaw lognormal(0, curve(SizeDistribution::lognormal, {1e-3, 4e-3}));
  const double mean = 2e-3 * std::exp(0.5 * 0.01);
  EXPECT_NEAR(moments(lognormal).mean, mean, 0.016 * 0.2e-3);
  EXPECT_NEAR(lognormal.quantile(0.5), 2e-3, 1e-9);  // steps of 0.7 um, linear inside
}

TEST(SizeLaw, a_cut_leaves_nothing_outside) {
  const SizeLaw law(0, curve(SizeDistribution::normal, {1.9e-3, 2.05e-3}));
  EXPECT_EQ(law.quantile(0), 1.9e-3);
  EXPECT_LE(law.quantile(1 - 1e-16), 2.05e-3);
}

TEST(SizeLaw, table_by_mass_shares_out_the_mass) {
  SizeSettings sizes;
  sizes.by = SizeWeight::mass;
  sizes.table = {{1e-3, 3.0}, {2e-3, 1.0}};
  const SizeLaw law(0, sizes);
  // 3 mass of the small are 3 spheres per unit, 1 of the large an eighth: 24 of 25 are small.
  EXPECT_EQ(law.quantile(0.9599), 1e-3);
  EXPECT_EQ(law.quantile(0.9601), 2e-3);
  EXPECT_NEAR(law.mean_volume(), (24 + 8) / 25.0 * sphere_volume(1e-3), 1e-18);
}

Scene box(double length) {
  Scene scene;
  scene.fluid.mesh.box = {Vector3::Zero(), Vector3::Constant(length), {2, 2, 2}};
  scene.particles.materials["glass"].density = 2500;
  InsertionSettings entry;
  entry.material = "glass";
  entry.diameter = 1e-3;
  scene.particles.insertion.push_back(entry);
  return scene;
}

ParticleState insert(const Scene& scene) {
  return insert_particles(scene, make_box(scene.fluid.mesh));
}

double solids(const ParticleState& state) {
  double volume = 0;
  for (const double radius : state.radius) volume += sphere_volume(2 * radius);
  return volume;
}

TEST(Amount, fraction_is_met_to_half_a_sphere) {
  Scene scene = box(0.02);
  scene.particles.insertion[0].fraction = 0.4;
  scene.particles.insertion[0].within.z = {0, 0.01};
  EXPECT_NEAR(solids(insert(scene)), 0.4 * 4e-6, 0.5 * sphere_volume(1e-3));
}

TEST(Amount, number_density_is_that_of_the_region) {
  Scene scene = box(0.02);
  scene.particles.insertion[0].number_density = 1e8;
  EXPECT_EQ(insert(scene).size(), 800);
}

/// Largest difference of the shares below a diameter from those of a uniform law (Kolmogorov and
/// Smirnov).
double off_uniform(std::vector<double> diameters, double low, double high) {
  std::sort(diameters.begin(), diameters.end());
  const auto count = static_cast<double>(diameters.size());
  double worst = 0;
  for (std::size_t k = 0; k < diameters.size(); ++k) {
    const double share = (diameters[k] - low) / (high - low);
    worst = std::max({worst, std::abs(share - static_cast<double>(k) / count),
                      std::abs(share - static_cast<double>(k + 1) / count)});
  }
  return worst;
}

TEST(Amount, however_it_is_given_is_drawn_from_the_law_of_sizes) {
  InsertionSettings entry;
  entry.sizes.emplace();
  entry.sizes->distribution = SizeDistribution::uniform;
  entry.sizes->range = {0.5e-3, 1.5e-3};
  InsertionSettings by_count = entry, by_density = entry, by_fraction = entry;
  by_count.count = 20000;
  by_density.number_density = 2e7;
  by_fraction.fraction = 2e7 * SizeLaw(0, entry.sizes).mean_volume();
  for (const InsertionSettings& settings : {by_count, by_density, by_fraction}) {
    const std::vector<double> drawn = entry_diameters("entry", settings, 1e-3);
    EXPECT_NEAR(static_cast<double>(drawn.size()), 20000, 500);  // 4 deviations of their volume
    // One in 10^5 draws of 20,000 is farther off than 2.5 / sqrt(n).
    EXPECT_LT(off_uniform(drawn, 0.5e-3, 1.5e-3), 2.5 / std::sqrt(20000.0));
  }
}

TEST(Amount, ten_to_one_packs_and_is_reproducible) {
  Scene scene = box(0.01);
  InsertionSettings& entry = scene.particles.insertion[0];
  entry.sizes.emplace();
  entry.sizes->by = SizeWeight::mass;
  entry.sizes->table = {{0.4e-3, 1.0}, {4e-3, 1.0}};
  entry.fraction = 0.35;
  const ParticleState first = insert(scene);  // the placement check holds the overlaps
  EXPECT_NEAR(solids(first), 0.35 * 1e-6, 0.5 * sphere_volume(4e-3));
  EXPECT_EQ(first.position, insert(scene).position);
  EXPECT_EQ(first.radius, insert(scene).radius);
  entry.seed = 2;
  EXPECT_NE(first.position, insert(scene).position);
}

TEST(Overlaps, are_refused_or_relaxed_as_asked) {
  Scene scene = box(0.01);
  scene.particles.insertion[0].count = 300;
  scene.particles.insertion.push_back(scene.particles.insertion[0]);
  scene.particles.insertion[1].seed = 2;
  EXPECT_THROW(insert(scene), ConfigError);
  scene.particles.overlaps = Overlaps::relax;
  const ParticleState state = insert(scene);
  for (int a = 0; a < state.size(); ++a) {
    for (int b = a + 1; b < state.size(); ++b) {
      ASSERT_GE((state.position[b] - state.position[a]).norm(), 0.99e-3 * (1 - 1e-12));
    }
  }
}

TEST(Overlaps, without_room_name_the_pair_that_is_left) {
  Scene scene = box(2.2e-3);
  scene.particles.insertion[0].count = 8;
  for (int seed = 2; seed <= 3; ++seed) {
    scene.particles.insertion.push_back(scene.particles.insertion[0]);
    scene.particles.insertion.back().seed = seed;
  }
  scene.particles.overlaps = Overlaps::relax;
  try {
    insert(scene);
    ADD_FAILURE() << "no error was thrown";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("still overlap by"), std::string::npos);
  }
}

}  // namespace
}  // namespace fluxpact
