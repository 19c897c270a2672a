#include "coordinator/audit/momentum_ledger.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "proto/mesh/box.hpp"

namespace fluxpact {
namespace {

constexpr double window_length = 1e-4;
// Sums of 24 terms, relative to the sum of their sizes.
constexpr double round_off = 10 * std::numeric_limits<double>::epsilon();

// One window of an exact exchange, except that `impulse_given` is that of the window before.
struct Sample {
  explicit Sample(unsigned seed) {
    MeshSettings settings;
    settings.box = {{0, 0, 0}, {0.3, 0.2, 0.8}, {3, 2, 4}};
    mesh = make_box(settings);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> between(-1, 1);
    const auto vector = [&](double size) {
      return Vector3{size * between(random), size * between(random), size * between(random)};
    };
    for (int cell = 0; cell < mesh.cells(); ++cell) {
      voidage.push_back(0.7 + 0.2 * between(random));
      coefficient.push_back(0.1 * (1.1 + between(random)));
      source.push_back(vector(0.3));
      velocity.push_back(vector(5));
      gradient.push_back(vector(1000));
      taken.emplace_back(window_length * (source.back() - coefficient.back() * velocity.back()));
      given.emplace_back(0, 0, 0);
    }
  }

  // Independent of the ledger: plain loops in the order of the formula in the header.
  Vector3 handed_over(bool with_pressure) const {
    Vector3 sum{0, 0, 0};
    for (std::size_t c = 0; c < taken.size(); ++c) {
      sum -= taken[c];
      if (with_pressure)
        sum -= window_length * (1 - voidage[c]) * mesh.cell_volumes[c] * gradient[c];
    }
    return sum;
  }

  MomentumAudit audit(const MomentumTotal& committed, bool with_pressure = true) const {
    return audit_momentum(mesh,
                          {window_length, with_pressure, voidage, coefficient, source, returned,
                           velocity, gradient, taken, given},
                          committed);
  }

  Mesh mesh;
  std::vector<double> voidage;
  std::vector<double> coefficient;
  std::vector<Vector3> source;
  std::vector<double> returned;  // empty: no pressure returns
  std::vector<Vector3> velocity;
  std::vector<Vector3> gradient;
  std::vector<Vector3> taken;
  std::vector<Vector3> given;
};

// Two windows: what the first hands over is given in the second, redistributed over the cells.
struct Exchange {
  Exchange() {
    const Vector3 handed = first.handed_over(true);
    for (std::size_t c = 0; c < second.given.size(); ++c) {
      second.given[c] =
          (c % 2 == 0 ? 3.0 : -1.0) * handed / static_cast<double>(second.given.size());
    }
  }
  MomentumAudit audit() const { return second.audit(first.audit({}).total); }

  Sample first{1};
  Sample second{2};
};

TEST(MomentumLedger, finds_no_error_in_an_exact_exchange) {
  const Exchange exchange;
  const MomentumAudit start = exchange.first.audit({});
  EXPECT_LE(start.impulse_error, round_off);
  EXPECT_EQ(start.handover_error, 0);  // nothing was handed over before, nothing was given
  const MomentumAudit audit = exchange.audit();
  EXPECT_LE(audit.impulse_error, round_off);
  EXPECT_LE(audit.handover_error, round_off);
}

TEST(MomentumLedger, holds_what_is_in_flight) {
  const Exchange exchange;
  const MomentumAudit start = exchange.first.audit({});
  const Vector3 first = exchange.first.handed_over(true);
  EXPECT_LE((start.ledger - first).norm(), round_off * start.total.scale);
  EXPECT_LE((start.momentum_to_fluid + first).norm(), round_off * start.total.scale);
  EXPECT_EQ(start.momentum_to_particles, Vector3(0, 0, 0));

  const MomentumAudit audit = exchange.audit();
  EXPECT_LE((audit.ledger - exchange.second.handed_over(true)).norm(),
            round_off * audit.total.scale);
  EXPECT_LE((audit.momentum_to_particles - first).norm(), round_off * start.total.scale);
  // Cumulative −to_fluid − to_particles is the ledger.
  const Vector3 balance =
      -start.momentum_to_fluid - audit.momentum_to_fluid - audit.momentum_to_particles;
  EXPECT_LE((balance - audit.ledger).norm(), round_off * audit.total.scale);
}

TEST(MomentumLedger, leaves_the_pressure_out_where_the_particles_do_not_feel_it) {
  const Sample sample(3);
  const MomentumAudit audit = sample.audit({}, false);
  EXPECT_LE((audit.momentum_to_fluid + sample.handed_over(false)).norm(),
            round_off * audit.total.scale);
  EXPECT_GT((sample.handed_over(false) - sample.handed_over(true)).norm(), 0.1 * audit.total.scale);
}

TEST(MomentumLedger, counts_the_pressure_that_particles_return_as_taken_by_the_fluid) {
  Sample sample(5);
  for (std::size_t c = 0; c < sample.taken.size(); ++c) {
    sample.returned.push_back(0.3 * sample.mesh.cell_volumes[c]);
    sample.taken[c] -= window_length * sample.returned[c] * sample.gradient[c];
  }
  const MomentumAudit audit = sample.audit({});
  EXPECT_LE(audit.impulse_error, round_off);
  EXPECT_LE((audit.momentum_to_fluid + sample.handed_over(true)).norm(),
            round_off * audit.total.scale);
  sample.returned[7] *= 1 + 1e-8;
  EXPECT_GT(sample.audit({}).impulse_error, 1e-11);
  EXPECT_EQ(sample.audit({}).impulse_error_cell, 7);
}

TEST(MomentumLedger, finds_the_cell_of_one_wrong_impulse) {
  Sample sample(1);
  const double scale = sample.audit({}).total.scale;
  const Vector3 error{0, 3e-9, 4e-9};
  sample.taken[13] += error;
  const MomentumAudit audit = sample.audit({});
  EXPECT_EQ(audit.impulse_error_cell, 13);
  EXPECT_GT(audit.impulse_error, 1e-7);
  // The scale changes by as much as the error, so to first order only.
  EXPECT_NEAR(audit.impulse_error, 5e-9 / scale, 1e-4 * audit.impulse_error);
}

TEST(MomentumLedger, sees_one_changed_number_of_the_drag) {
  Sample coefficient(1);
  coefficient.coefficient[2] *= 1 + 1e-8;
  EXPECT_GT(coefficient.audit({}).impulse_error, 1e-11);
  EXPECT_EQ(coefficient.audit({}).impulse_error_cell, 2);
  Sample source(1);
  source.source[23].z() += 1e-8;
  EXPECT_GT(source.audit({}).impulse_error, 1e-11);
  EXPECT_EQ(source.audit({}).impulse_error_cell, 23);
}

TEST(MomentumLedger, sees_one_impulse_that_the_particles_were_not_given) {
  Exchange exchange;
  const double scale = exchange.first.audit({}).total.scale;
  exchange.second.given[7] += Vector3{1e-9, 0, 0};
  EXPECT_NEAR(exchange.audit().handover_error, 1e-9 / scale, round_off);
  EXPECT_GT(exchange.audit().handover_error, 1e-8);
}

TEST(MomentumLedger, sees_a_pressure_force_that_was_not_given) {
  Exchange exchange;
  exchange.first.gradient[7].x() += 1e-2;  // over gradients of 1e3
  EXPECT_GT(exchange.audit().handover_error, 1e-9);
}

TEST(MomentumLedger, takes_any_impulse_from_nowhere_as_an_error_without_bound) {
  Sample sample(1);
  sample.given[0] = {1e-30, 0, 0};
  MomentumTotal nothing;
  nothing.begun = true;
  EXPECT_EQ(sample.audit(nothing).handover_error, std::numeric_limits<double>::infinity());
}

TEST(MomentumLedger, takes_the_first_impulse_as_lent_until_the_second_window) {
  Exchange exchange;
  const Vector3 lent(1e-3, -2e-3, 5e-4);
  exchange.first.given[4] = lent;
  const MomentumAudit start = exchange.first.audit({});
  EXPECT_EQ(start.handover_error, 0);
  EXPECT_LE((start.ledger - exchange.first.handed_over(true) + lent).norm(),
            round_off * start.total.scale);
  // The rest of what the fluid handed over in the first window is due, no more.
  EXPECT_GT(exchange.audit().handover_error, 0.1 * lent.norm() / start.total.scale);
  exchange.second.given[11] -= lent;
  EXPECT_LE(exchange.audit().handover_error, round_off);
}

TEST(MomentumLedger, finds_nothing_where_nothing_is_exchanged) {
  Sample sample(1);
  for (auto* vectors : {&sample.source, &sample.velocity, &sample.gradient, &sample.taken}) {
    std::ranges::fill(*vectors, Vector3{0, 0, 0});
  }
  const MomentumAudit audit = sample.audit(sample.audit({}).total);
  EXPECT_EQ(audit.impulse_error, 0);
  EXPECT_EQ(audit.handover_error, 0);
  EXPECT_EQ(audit.impulse_error_cell, -1);
}

TEST(MomentumLedger, lets_a_value_that_is_no_number_through_to_the_gate) {
  Sample sample(1);
  sample.velocity[9].y() = std::numeric_limits<double>::quiet_NaN();
  const MomentumAudit audit = sample.audit({});
  EXPECT_TRUE(std::isnan(audit.impulse_error));
  EXPECT_EQ(audit.impulse_error_cell, 9);
}

TEST(MomentumLedger, keeps_no_trace_of_an_attempt_that_is_not_committed) {
  const Exchange exchange;
  const MomentumTotal committed = exchange.first.audit({}).total;
  exchange.second.audit(committed);
  EXPECT_EQ(exchange.second.audit(committed).ledger, exchange.second.audit(committed).ledger);
  EXPECT_LE(exchange.second.audit(committed).handover_error, round_off);
}

}  // namespace
}  // namespace fluxpact
