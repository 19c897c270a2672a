// The budget of particles that come in and leave, and what the gate makes of a broken one.
#include "coordinator/audit/particle_ledger.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "coordinator/audit/gate.hpp"

namespace fluxpact {
namespace {

constexpr double limit = 1e-10;

Verdict verdict_of(const ParticleAudit& audit) {
  AuditRow row;
  row.particles = audit;
  return judge(row, limit);
}

/// 10 particles of 0.1 kg; 3 come in, 1 leaves.
ParticleWindow sound_window() {
  ParticleWindow window;
  window.count = 12;
  window.mass = 1.2;
  window.entered = 3;
  window.left = 1;
  window.mass_entered = 0.3;
  window.mass_left = 0.1;
  return window;
}

TEST(ParticleLedger, closes_over_many_windows_to_round_off) {
  ParticleTotal total = start_particles(0, 0);
  CompensatedSum mass;
  for (int step = 1; step <= 1000; ++step) {
    ParticleWindow window;
    window.entered = 2;
    window.left = step > 1 ? 1 : 0;
    window.mass_entered = 1.0 / 3 + 1e-3 * step;
    window.mass_left = step > 1 ? 0.1 / 3 + 1e-4 * step : 0;
    mass.add(window.mass_entered);
    mass.add(-window.mass_left);
    window.mass = mass.value();
    window.count = step + 1;
    const ParticleAudit audit = audit_particles(window, total);
    // The mass as sent is rounded once: 1.1e-16 of itself.
    EXPECT_LT(audit.mass_error, 1.2e-16);
    EXPECT_EQ(audit.count_error, 0);
    EXPECT_TRUE(verdict_of(audit).pass);
    total = audit.total;
  }
  EXPECT_EQ(total.count_entered, 2000);
  EXPECT_EQ(total.count_left, 999);
}

TEST(ParticleLedger, repeats_a_window_from_the_committed_total) {
  const ParticleTotal committed = start_particles(10, 1.0);
  const ParticleAudit first = audit_particles(sound_window(), committed);
  const ParticleAudit again = audit_particles(sound_window(), committed);
  EXPECT_EQ(first.mass_error, again.mass_error);
  EXPECT_EQ(first.total.count, 12);
  EXPECT_EQ(again.total.count, 12);
}

TEST(ParticleLedger, a_mass_that_does_not_add_up_stops_at_the_gate) {
  const ParticleTotal committed = start_particles(10, 1.0);
  EXPECT_TRUE(verdict_of(audit_particles(sound_window(), committed)).pass);
  ParticleWindow window = sound_window();
  window.mass_left = 0;  // one left without a word
  const ParticleAudit audit = audit_particles(window, committed);
  EXPECT_NEAR(audit.mass_error, 0.1 / 1.3, 1e-15);
  const Verdict verdict = verdict_of(audit);
  EXPECT_FALSE(verdict.pass);
  EXPECT_STREQ(verdict.quantity, "particle_mass_error");
  AuditRow row;
  EXPECT_THAT(describe(verdict, row), testing::HasSubstr("the mass of the particles is not"));
}

TEST(ParticleLedger, a_particle_too_many_stops_at_the_gate) {
  const ParticleTotal committed = start_particles(10, 1.0);
  ParticleWindow window = sound_window();
  window.count = 13;
  const Verdict verdict = verdict_of(audit_particles(window, committed));
  EXPECT_FALSE(verdict.pass);
  EXPECT_STREQ(verdict.quantity, "particle_count_error");
  EXPECT_EQ(verdict.value, 1);
}

TEST(ParticleLedger, mass_out_of_nothing_is_infinite_and_no_number_never_passes) {
  ParticleWindow window;
  window.mass = 1e-9;
  EXPECT_FALSE(verdict_of(audit_particles(window, {})).pass);
  window.mass = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(verdict_of(audit_particles(window, start_particles(1, 1))).pass);
  EXPECT_TRUE(verdict_of(audit_particles({}, {})).pass);
}

}  // namespace
}  // namespace fluxpact
