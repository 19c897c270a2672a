#include "coordinator/audit/scalar_ledger.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "proto/mesh/box.hpp"

namespace fluxpact {
namespace {

/// Two cells of 1 m³ side by side; the ten boundary faces come in the order of the mesh.
struct TwoCells {
  Mesh mesh = make_box({.box = {{0, 0, 0}, {2, 1, 1}, {2, 1, 1}, {}},
                        .polymesh = {},
                        .gmsh = {},
                        .periodic = {},
                        .patches = {}});
  std::vector<double> voidage_before{0.5, 1.0}, voidage_after{0.75, 0.5};
  std::vector<double> before{4.0, 1.0}, after{4.0, 2.0};
  std::vector<double> flux = std::vector<double>(10, 0.0);
  ScalarWindow window() const {
    return {.density = 2,
            .length = 0.5,
            .factor = 10,
            .voidage_before = voidage_before,
            .voidage_after = voidage_after,
            .value_before = before,
            .value_after = after,
            .boundary_flux = flux,
            .source = 4};
  }
};

TEST(ScalarLedger, balances_what_came_in_against_what_is_there) {
  TwoCells cells;
  // 10 · 2 · (0.5 · 4 + 1 · 1) = 60 before, 10 · 2 · (0.75 · 4 + 0.5 · 2) = 80 after: 40 a second,
  // of which 4 from the source; 50 in and 14 out make the rest.
  cells.flux[2] = -50;
  cells.flux[7] = 14;
  const ScalarAudit audit = audit_scalar(cells.mesh, cells.window());
  EXPECT_NEAR(audit.amount, 80, 1e-13);  // volumes are known to rounding
  EXPECT_EQ(audit.in, 50);
  EXPECT_EQ(audit.out, 14);
  EXPECT_EQ(audit.source, 4);
  EXPECT_NEAR(audit.imbalance, 0, 1e-15);
  EXPECT_EQ(audit.lowest, 2);
  EXPECT_EQ(audit.highest, 4);
}

TEST(ScalarLedger, shows_what_is_missing_over_what_is_there) {
  TwoCells cells;
  cells.flux[2] = -50;
  cells.flux[7] = 14 + 1.6;  // 0.8 too much has left in the window, of 80
  EXPECT_NEAR(audit_scalar(cells.mesh, cells.window()).imbalance, -0.01, 1e-15);
}

TEST(ScalarLedger, of_nothing_is_balanced) {
  TwoCells cells;
  cells.before = cells.after = {0, 0};
  ScalarWindow window = cells.window();
  window.source = 0;
  EXPECT_EQ(audit_scalar(cells.mesh, window).imbalance, 0);
}

TEST(ScalarLedger, compares_with_the_size_of_what_is_there_not_with_its_sum) {
  TwoCells cells;
  cells.voidage_before = cells.voidage_after = {1, 1};
  cells.before = cells.after = {1, -1};
  cells.flux[0] = 1;
  ScalarWindow window = cells.window();
  window.source = 0;
  EXPECT_NEAR(audit_scalar(cells.mesh, window).imbalance, -0.5 / 40, 1e-15);
}

TEST(ScalarLedger, passes_on_what_is_no_number) {
  TwoCells cells;
  cells.flux[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(audit_scalar(cells.mesh, cells.window()).imbalance));
}

}  // namespace
}  // namespace fluxpact
