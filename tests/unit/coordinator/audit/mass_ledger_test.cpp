#include "coordinator/audit/mass_ledger.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "proto/mesh/box.hpp"

namespace fluxpact {
namespace {

constexpr double density = 1.225;
constexpr double window_length = 1e-3;
// Every number below comes from a few additions and multiplications of numbers of size one: 10
// units in the last place are room enough.
constexpr double round_off = 10 * std::numeric_limits<double>::epsilon();

// Random face fluxes, and the voidage that they lead to: conservative in every cell by
// construction.
struct Sample {
  explicit Sample(std::vector<Axis> periodic = {}, std::array<int, 3> cells = {3, 2, 4}) {
    MeshSettings settings;
    settings.box = {{0, 0, 0}, {0.3, 0.2, 0.8}, cells};
    settings.periodic = std::move(periodic);
    mesh = make_box(settings);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> between(-1, 1);
    for (int face = 0; face < mesh.faces(); ++face) flux.push_back(1e-3 * between(random));
    for (int cell = 0; cell < mesh.cells(); ++cell) before.push_back(0.7 + 0.2 * between(random));
    after = before;
    for (int face = 0; face < mesh.faces(); ++face) {
      const auto f = static_cast<std::size_t>(face);
      move(mesh.owner[f], -flux[f]);
      if (face < mesh.internal_faces()) move(mesh.neighbour[f], flux[f]);
    }
    for (std::size_t c = 0; c < after.size(); ++c) {
      particle_volume += (1 - after[c]) * mesh.cell_volumes[c];
    }
  }

  void move(int cell, double gain) {
    const auto c = static_cast<std::size_t>(cell);
    after[c] += gain * window_length / (density * mesh.cell_volumes[c]);
  }

  MassAudit audit() const { return audit_mass(mesh, window(), start_mass(mesh, density, before)); }
  MassWindow window() const {
    return {density, window_length, before, after, flux, particle_volume};
  }
  double capacity_rate() const { return density * 0.3 * 0.2 * 0.8 / window_length; }

  Mesh mesh;
  std::vector<double> flux;
  std::vector<double> before;
  std::vector<double> after;
  double particle_volume = 0;
};

TEST(MassLedger, finds_no_error_where_there_is_none) {
  const Sample sample;
  const MassAudit audit = sample.audit();
  EXPECT_GT(audit.mass_in, 1e-3);
  EXPECT_GT(audit.mass_out, 1e-3);
  // The voidage is stored to 1.1e-16, which as a rate is that share of the domain's content.
  EXPECT_LE(std::abs(audit.net_imbalance), round_off * sample.capacity_rate());
  EXPECT_LE(audit.max_cell_residual, round_off);
  EXPECT_LE(std::abs(audit.cumulative_drift), round_off);
  EXPECT_LE(audit.voidage_volume_error, round_off);
}

TEST(MassLedger, tells_in_from_out_by_the_sign_of_each_face) {
  Sample sample;
  std::ranges::fill(sample.flux, 0.0);
  const auto first = static_cast<std::size_t>(sample.mesh.internal_faces());
  sample.flux[first] = -0.5;
  sample.flux[first + 1] = 0.25;
  sample.flux[first + 2] = -0.125;
  sample.flux[0] = 7;  // internal: of no concern to the boundary
  const MassAudit audit = sample.audit();
  EXPECT_EQ(audit.mass_in, 0.625);
  EXPECT_EQ(audit.mass_out, 0.25);
}

TEST(MassLedger, counts_a_periodic_face_as_internal) {
  // One cell across the period as well: the same cell on both sides of a face.
  for (const std::array<int, 3> cells : {std::array{3, 2, 4}, std::array{1, 1, 4}}) {
    const Sample sample({Axis::x, Axis::y}, cells);
    const MassAudit audit = sample.audit();
    double boundary = 0;
    for (int face = sample.mesh.internal_faces(); face < sample.mesh.faces(); ++face) {
      boundary += std::abs(sample.flux[static_cast<std::size_t>(face)]);
      EXPECT_NE(sample.mesh.face_areas[static_cast<std::size_t>(face)].z(), 0);
    }
    EXPECT_NEAR(audit.mass_in + audit.mass_out, boundary, round_off * boundary);
    EXPECT_LE(audit.max_cell_residual, round_off);
    EXPECT_LE(std::abs(audit.net_imbalance), round_off * sample.capacity_rate());
  }
}

TEST(MassLedger, gives_rate_and_mass_of_a_uniform_change) {
  Sample sample;
  std::ranges::fill(sample.flux, 0.0);
  std::ranges::fill(sample.before, 0.5);
  std::ranges::fill(sample.after, 0.75);
  const MassAudit audit = sample.audit();
  const double content = density * 0.3 * 0.2 * 0.8;
  EXPECT_NEAR(audit.storage_rate, 0.25 * content / window_length,
              round_off * content / window_length);
  EXPECT_NEAR(audit.fluid_mass, 0.75 * content, round_off * content);
  EXPECT_NEAR(audit.max_cell_residual, 0.25, round_off);
  EXPECT_NEAR(audit.cumulative_drift, 1.0 / 3, round_off);
  // Nothing flows in, so the floor stands below: 1e-5 of the content, per window.
  EXPECT_NEAR(audit.relative_imbalance, -0.25 / audit_floor, round_off * 0.25 / audit_floor);
  EXPECT_EQ(audit.epsilon_min, 0.75);
  EXPECT_EQ(audit.epsilon_max, 0.75);
}

TEST(MassLedger, finds_the_cell_of_one_wrong_flux) {
  Sample sample;
  constexpr double error = 1e-6;  // [kg/s] over fluxes of 1e-3
  const auto boundary = static_cast<std::size_t>(sample.mesh.internal_faces()) + 3;
  sample.flux[boundary] += error;
  const MassAudit audit = sample.audit();
  const int cell = sample.mesh.owner[boundary];
  const double capacity =
      density * sample.mesh.cell_volumes[static_cast<std::size_t>(cell)] / window_length;
  EXPECT_EQ(audit.max_cell_residual_cell, cell);
  EXPECT_NEAR(audit.max_cell_residual, error / capacity, round_off);
  EXPECT_NEAR(audit.net_imbalance, -error, round_off * sample.capacity_rate());
  EXPECT_NEAR(audit.relative_imbalance, -error / audit.mass_in,
              1e-9);  // 1e-16 of 0.6 kg/s over 1e-2 kg/s
  EXPECT_NEAR(audit.cumulative_drift, error * window_length / audit.fluid_mass, round_off);
}

TEST(MassLedger, sees_a_wrong_internal_flux_in_a_cell_though_it_cancels_in_the_sum) {
  Sample sample;
  sample.flux[5] += 1e-6;
  const MassAudit audit = sample.audit();
  EXPECT_GT(audit.max_cell_residual, 1e-8);
  EXPECT_LE(std::abs(audit.net_imbalance), round_off * sample.capacity_rate());
  EXPECT_TRUE(audit.max_cell_residual_cell == sample.mesh.owner[5] ||
              audit.max_cell_residual_cell == sample.mesh.neighbour[5]);
}

TEST(MassLedger, sees_one_wrong_voidage) {
  Sample sample;
  constexpr double error = 1e-9;
  sample.after[11] -= error;
  const MassAudit audit = sample.audit();
  EXPECT_EQ(audit.max_cell_residual_cell, 11);
  EXPECT_NEAR(audit.max_cell_residual, error, round_off);
  EXPECT_NEAR(audit.voidage_volume_error,
              error * sample.mesh.cell_volumes[11] / sample.particle_volume, round_off);
}

TEST(MassLedger, judges_the_voidage_that_was_sent_last_where_the_fluid_is_late) {
  const Sample sample;
  std::vector<double> sent = sample.after;
  for (double& voidage : sent) voidage -= 0.01;  // particles have come in
  MassWindow window = sample.window();
  window.voidage_sent = sent;
  const double volume = 0.3 * 0.2 * 0.8;
  const MassTotal begin = start_mass(sample.mesh, density, sample.before);
  // Continuity is that of the fluid's own voidage, the volume that of the one sent.
  EXPECT_LE(audit_mass(sample.mesh, window, begin).max_cell_residual, round_off);
  EXPECT_GT(audit_mass(sample.mesh, window, begin).voidage_volume_error, 0.01);
  window.particle_volume += 0.01 * volume;
  const MassAudit audit = audit_mass(sample.mesh, window, begin);
  EXPECT_LE(audit.voidage_volume_error, round_off);
  EXPECT_NEAR(audit.displaced, density * 0.01 * volume, 10 * round_off * density * volume);
  EXPECT_EQ(sample.audit().displaced, 0);
}

TEST(MassLedger, does_not_mistake_the_round_off_of_a_voidage_for_lost_particles) {
  Sample sample;
  std::ranges::fill(sample.flux, 0.0);
  std::ranges::fill(sample.before, 1.0);
  sample.after = sample.before;
  // A grain of 1e-9 of its cell: as a voidage it is known to 1e-7 of itself only.
  const double grain = 1e-9 * sample.mesh.cell_volumes[4];
  sample.particle_volume = grain;
  sample.after[4] = 1 - grain / sample.mesh.cell_volumes[4];
  EXPECT_LE(sample.audit().voidage_volume_error, 1.1e-16 / audit_floor);
  // None, and none expected.
  sample.particle_volume = 0;
  sample.after[4] = 1;
  EXPECT_EQ(sample.audit().voidage_volume_error, 0);
}

TEST(MassLedger, accumulates_over_windows_and_only_what_is_committed) {
  const Sample sample;
  MassTotal total = start_mass(sample.mesh, density, sample.before);
  const std::vector<double> start = sample.before;
  MassWindow window = sample.window();
  // An attempt that is not committed leaves no trace.
  audit_mass(sample.mesh, window, total);
  const MassAudit first = audit_mass(sample.mesh, window, total);
  total = first.total;
  EXPECT_NEAR(total.gained.value(), (first.mass_in - first.mass_out) * window_length, round_off);
  // A window that lets through the same again, without storing it: the drift is what was lost.
  window.voidage_before = sample.after;
  const MassAudit second = audit_mass(sample.mesh, window, total);
  const double lost = (first.mass_in - first.mass_out) * window_length;
  EXPECT_NEAR(second.cumulative_drift, -lost / second.fluid_mass, round_off);
}

TEST(MassLedger, lets_a_value_that_is_no_number_through_to_the_gate) {
  Sample sample;
  sample.flux[5] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(sample.audit().max_cell_residual));
  Sample other;
  other.after[3] = std::numeric_limits<double>::quiet_NaN();
  const MassAudit audit = other.audit();
  EXPECT_TRUE(std::isnan(audit.max_cell_residual));
  EXPECT_EQ(audit.max_cell_residual_cell, 3);
  EXPECT_TRUE(std::isnan(audit.epsilon_min));
  EXPECT_TRUE(std::isnan(audit.epsilon_max));
  EXPECT_TRUE(std::isnan(audit.voidage_volume_error));
}

TEST(MassLedger, sums_without_losing_small_terms) {
  // 1 + 1e6 · 1e-16 in plain doubles is 1: the millionfold small flux would vanish.
  MeshSettings settings;
  settings.box = {{0, 0, 0}, {1, 1, 1}, {100, 100, 1}};
  settings.patches = {{"in", {Side::z_min, {}}}};
  const Mesh mesh = make_box(settings);
  const std::vector<double> voidage(10000, 1.0);
  std::vector<double> flux(static_cast<std::size_t>(mesh.faces()), 0.0);
  const auto first = static_cast<std::size_t>(mesh.find_patch("in")->first);
  std::fill_n(flux.begin() + static_cast<std::ptrdiff_t>(first), 10000, -1e-16);
  flux[first] = -1;
  const MassAudit audit =
      audit_mass(mesh, {1, 1, voidage, voidage, flux, 0}, start_mass(mesh, 1, voidage));
  EXPECT_EQ(audit.mass_in, 1 + 9999e-16);
}

}  // namespace
}  // namespace fluxpact
