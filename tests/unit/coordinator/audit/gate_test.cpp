#include "coordinator/audit/gate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace fluxpact {
namespace {

constexpr double limit = 1e-10;

AuditRow good_row() {
  AuditRow row;
  row.step = 12;
  row.time = 0.0012;
  row.mass.relative_imbalance = 1e-15;
  row.mass.max_cell_residual = 2e-15;
  row.mass.max_cell_residual_cell = 5;
  row.mass.voidage_volume_error = 3e-16;
  return row;
}

TEST(Gate, passes_what_is_within_the_limit_and_names_the_largest) {
  const Verdict verdict = judge(good_row(), limit);
  EXPECT_TRUE(verdict.pass);
  EXPECT_STREQ(verdict.quantity, "max_cell_residual");
  EXPECT_EQ(verdict.value, 2e-15);
  EXPECT_EQ(verdict.limit, limit);
  EXPECT_EQ(verdict.cell, 5);
}

TEST(Gate, passes_a_value_at_the_limit) {
  AuditRow row = good_row();
  row.mass.relative_imbalance = -limit;
  EXPECT_TRUE(judge(row, limit).pass);
}

TEST(Gate, names_the_worst_of_several_scalars) {
  AuditRow row = good_row();
  row.scalars.resize(3);
  row.scalars[1].imbalance = -1e-9;
  row.scalars[2].imbalance = 1e-11;
  const Verdict verdict = judge(row, limit);
  EXPECT_FALSE(verdict.pass);
  EXPECT_STREQ(verdict.quantity, "scalar_imbalance");
  EXPECT_EQ(verdict.value, 1e-9);
  EXPECT_THAT(describe(verdict, row), testing::HasSubstr("scalar"));
  row.scalars[0].imbalance = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(judge(row, limit).pass);
}

struct Fault {
  const char* quantity;
  void (*set)(AuditRow&, double);
  std::optional<int> cell;
};

void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.quantity; }

class GateRefuses : public testing::TestWithParam<Fault> {};

TEST_P(GateRefuses, one_quantity_over_the_limit_or_without_a_value) {
  const Fault& fault = GetParam();
  for (const double value : {1.1e-10, 0.08, std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::quiet_NaN()}) {
    AuditRow row = good_row();
    fault.set(row, value);
    const Verdict verdict = judge(row, limit);
    EXPECT_FALSE(verdict.pass) << value;
    EXPECT_STREQ(verdict.quantity, fault.quantity);
    EXPECT_EQ(verdict.cell, fault.cell);
  }
}

INSTANTIATE_TEST_SUITE_P(
    each_quantity, GateRefuses,
    testing::Values(Fault{"relative_imbalance",
                          [](AuditRow& row, double v) { row.mass.relative_imbalance = v; },
                          {}},
                    Fault{"relative_imbalance",
                          [](AuditRow& row, double v) { row.mass.relative_imbalance = -v; },
                          {}},
                    Fault{"max_cell_residual",
                          [](AuditRow& row, double v) { row.mass.max_cell_residual = v; }, 5},
                    Fault{"voidage_volume_error",
                          [](AuditRow& row, double v) { row.mass.voidage_volume_error = v; },
                          {}},
                    Fault{"impulse_error",
                          [](AuditRow& row, double v) {
                            row.momentum.impulse_error = v;
                            row.momentum.impulse_error_cell = 8;
                          },
                          8},
                    Fault{"handover_error",
                          [](AuditRow& row, double v) { row.momentum.handover_error = v; },
                          {}}));

TEST(Gate, says_what_where_how_much_and_what_to_do) {
  AuditRow row = good_row();
  row.mass.max_cell_residual = 3e-4;
  EXPECT_THAT(describe(judge(row, limit), row),
              testing::AllOf(testing::HasSubstr("window 12"), testing::HasSubstr("0.0012"),
                             testing::HasSubstr("max_cell_residual is 0.0003 in cell 5"),
                             testing::HasSubstr("1e-10"), testing::HasSubstr("fluid's face fluxes"),
                             testing::HasSubstr("coupling.audit.limit")));
}

}  // namespace
}  // namespace fluxpact
