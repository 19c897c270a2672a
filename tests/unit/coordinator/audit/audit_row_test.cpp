#include "coordinator/audit/audit_row.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

namespace fluxpact {
namespace {

TEST(AuditColumns, are_those_that_users_rely_on) {
  EXPECT_EQ(
      audit_csv_header(),
      "step,time,mass_in,mass_out,storage_rate,net_imbalance,relative_imbalance,max_cell_residual,"
      "cumulative_drift,fluid_mass,particle_count,particle_mass,voidage_volume_error,epsilon_min,"
      "epsilon_max,momentum_to_fluid_x,momentum_to_fluid_y,momentum_to_fluid_z,"
      "momentum_to_particles_x,momentum_to_particles_y,momentum_to_particles_z,ledger_x,ledger_y,"
      "ledger_z,solver_iterations,attempts,wall_cfd,wall_dem,wall_exchange,excess_moved\n");
}

TEST(AuditColumns, each_show_a_member_of_their_own) {
  AuditRow row;
  row.step = 1;
  row.time = 2;
  row.mass.mass_in = 3;
  row.mass.mass_out = 4;
  row.mass.storage_rate = 5;
  row.mass.net_imbalance = 6;
  row.mass.relative_imbalance = 7;
  row.mass.max_cell_residual = 8;
  row.mass.cumulative_drift = 9;
  row.mass.fluid_mass = 10;
  row.particles.window.count = 11;
  row.particles.window.mass = 12;
  row.mass.voidage_volume_error = 13;
  row.mass.epsilon_min = 14;
  row.mass.epsilon_max = 15;
  row.momentum.momentum_to_fluid = {16, 17, 18};
  row.momentum.momentum_to_particles = {19, 20, 21};
  row.momentum.ledger = {22, 23, 24};
  row.solver_iterations = 25;
  row.attempts = 26;
  row.wall_cfd = 27;
  row.wall_dem = 28;
  row.wall_exchange = 29;
  row.particles.window.excess_moved = 30;
  int expected = 0;
  for (const AuditColumn& column : audit_columns()) {
    ++expected;
    const double value =
        std::visit([&](const auto get) { return static_cast<double>(get(row)); }, column.value);
    EXPECT_EQ(value, expected) << column.name;
  }
  EXPECT_EQ(expected, 30);
}

TEST(AuditColumns, keep_wall_times_out_of_what_two_runs_must_share) {
  std::set<std::string> apart;
  for (const AuditColumn& column : audit_columns()) {
    if (!column.reproducible) apart.insert(column.name);
  }
  EXPECT_EQ(apart, (std::set<std::string>{"wall_cfd", "wall_dem", "wall_exchange"}));
}

TEST(AuditColumns, of_scalars_come_last_with_their_names) {
  Scene scene;
  scene.fluid.scalars["heat"].kind = ScalarKind::temperature;
  scene.fluid.scalars["tracer"];
  const std::vector<ScalarName> names = scalar_names(scene);
  const std::string header = audit_csv_header(names);
  EXPECT_THAT(header,
              testing::HasSubstr("wall_exchange,excess_moved,scalar_heat_amount,scalar_heat_in,"));
  EXPECT_THAT(header, testing::EndsWith("scalar_tracer_imbalance,scalar_tracer_min,"
                                        "scalar_tracer_max\n"));
  EXPECT_STREQ(column_unit(names[0], scalar_columns().front()), "J");
  EXPECT_STREQ(column_unit(names[1], scalar_columns().front()), "kg");
}

TEST(AuditColumns, of_a_scalar_each_show_a_member_of_their_own) {
  const ScalarAudit audit{1, 2, 3, 4, 5, 6, 7};
  double expected = 0;
  for (const ScalarColumn& column : scalar_columns())
    EXPECT_EQ(column.value(audit), ++expected) << column.name;
  EXPECT_EQ(expected, 7);
}

TEST(AuditReference, has_a_line_with_unit_for_every_column) {
  const std::string text = audit_reference();
  for (const AuditColumn& column : audit_columns()) {
    EXPECT_THAT(
        text, testing::HasSubstr("| `" + std::string(column.name) + "` | " + column.unit + " | "));
  }
}

}  // namespace
}  // namespace fluxpact
