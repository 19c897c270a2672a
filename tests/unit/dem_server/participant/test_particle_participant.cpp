#include "dem_server/participant/particle_participant.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "bench.hpp"
#include "proto/base/errors.hpp"
#include "proto/participant/asked_fields.hpp"

namespace fluxpact {
namespace {

using testing_bench::Bench;
using testing_bench::cloud;
using testing_bench::copy;
using testing_bench::quiet;
using testing_bench::sum;
using testing_bench::velocities;

TEST(ParticleParticipant, gives_all_fields_it_promises_and_needs_those_it_names) {
  Bench bench;
  const auto side = bench.take_part(cloud());
  Fields out;
  side->start({}, out);
  const auto given = copy(out);
  EXPECT_EQ(side->identity().role, Role::particles);
  const auto if_asked = all_asked_of_particles();  // on the wire only if a force asks for them
  for (const std::string& name : side->identity().gives) {
    const bool expected = std::ranges::find(if_asked, name) == if_asked.end();
    EXPECT_EQ(given.contains(name) || name == field::wall_seconds, expected) << name;
  }
  EXPECT_EQ(out.number(field::particle_count), 60);
  EXPECT_NEAR(out.number(field::particle_mass), 100 * out.number(field::particle_volume), 1e-14);
  Fields nothing;
  EXPECT_THROW(side->advance(bench.window(1), nothing, out, quiet), ProtocolError);
}

TEST(ParticleParticipant, starts_with_the_drag_of_the_velocity_it_is_given) {
  Bench bench;
  bench.scene.interphase.drag = DragLaw::ergun;
  std::ranges::fill(bench.velocity, Vector3(0, 0, 2));
  Fields still;
  Fields blown;
  const auto side = bench.take_part(cloud());
  side->start({}, still);
  const auto first = copy(still);
  side->start(bench.fluid(), blown);
  const auto second = copy(blown);
  EXPECT_EQ(first.at(field::voidage), second.at(field::voidage));
  EXPECT_NE(first.at(field::drag_coefficient), second.at(field::drag_coefficient));
}

/// Velocity of one sphere of `radius` [m] and `density` [kg/m³] after `windows` in the bench's
/// flow.
Vector3 velocity_after(Bench& bench, int windows, double radius, double density) {
  const auto side = bench.take_part(one_sphere({0.15, 0.15, 0.15}, radius, density));
  Fields begin;
  side->start({}, begin);
  for (int step = 1; step <= windows; ++step) {
    Fields out;
    side->advance(bench.window(step), bench.fluid(), out, quiet);
    side->commit();
  }
  Fields end;
  side->snapshot(end);
  return end.vectors("velocity", 1)[0];
}

TEST(ParticleParticipant, settles_to_the_exact_terminal_slip_at_any_window) {
  const double radius = 1e-3;
  const double density = 500;
  const double reduced = 9.81 * (1 - 1.2 / density);             // gravity less buoyancy
  for (const double ratio : {1e-2, 0.1, 1.0, 10.0, 1e2, 1e3}) {  // Δt/τ
    Bench bench;
    const double tau = bench.scene.coupling.window / ratio;
    // Stokes: τ = m/(3 π μ d) = ρ_p d²/(18 μ).
    bench.scene.fluid.viscosity = density * 4 * radius * radius / (18 * tau);
    std::ranges::fill(bench.velocity, Vector3(0.3, 0, 0.1));
    // The distance to the terminal velocity falls by 1/(1 + b) a window, or more (θ below 1): to
    // 1e-16 in 37 (1 + b)/b.
    const int windows = 10 + static_cast<int>(40 * (1 + ratio) / ratio);
    const Vector3 slip = Vector3(0.3, 0, 0.1) - velocity_after(bench, windows, radius, density);
    // Velocities of 0.3 and aτ are subtracted; each window rounds v, damped by 1/(1 + b).
    const double tolerance = 1e-15 * (0.3 + reduced * tau) * (1 + 1 / ratio) * 4;
    EXPECT_NEAR(slip.z(), reduced * tau, tolerance) << "window/tau " << ratio;
    EXPECT_NEAR(slip.x(), 0, tolerance) << "window/tau " << ratio;
  }
}

TEST(ParticleParticipant, is_slowed_down_by_a_given_flow_to_second_order_in_the_window) {
  // Stokes: s = s0 exp(−t/τ); at t = τ, in windows of b = Δt/τ.
  std::vector<double> errors;
  for (const int windows : {20, 40, 80}) {
    Bench bench({1, 1, 1});  // much gas, which hardly follows in the first window
    const double b = 1.0 / windows;
    const double radius = 1e-3;
    bench.scene.scene.gravity.setZero();
    bench.scene.fluid.viscosity =
        500 * 4 * radius * radius * b / (18 * bench.scene.coupling.window);
    std::ranges::fill(bench.velocity, Vector3(0.3, 0, 0.1));
    errors.push_back(1 - velocity_after(bench, windows, radius, 500).x() / 0.3 - std::exp(-1));
  }
  // With the weight 1/2 + 3/2 b of the end, b²(17/12) e^−1 is left; of all of the end, b/2 e^−1.
  EXPECT_NEAR(errors[2] * 80 * 80 / std::exp(-1), 17.0 / 12, 0.1);
  for (int k = 0; k < 2; ++k) EXPECT_NEAR(std::log2(errors[k] / errors[k + 1]), 2, 0.1) << k;
}

TEST(ParticleParticipant, does_not_expect_a_supported_particle_to_fall) {
  Bench bench;
  const auto side = bench.take_part(one_sphere({0.15, 0.15, 0.15}, 1e-3, 2500), true);
  Fields out;
  side->start({}, out);
  EXPECT_LT(sum(out.vectors(field::drag_source, 27)).z(), 0);  // nothing known yet: it may fall
  for (int step = 1; step <= 3; ++step) {
    Fields next;
    side->advance(bench.window(step), bench.fluid(), next, quiet);
    side->commit();
    // v* = v = 0: the fluid at rest stays at rest, exactly.
    EXPECT_EQ(sum(next.vectors(field::drag_source, 27)), Vector3(0, 0, 0)) << step;
  }
}

TEST(ParticleParticipant, gives_a_supported_particle_the_full_drag) {
  Bench bench;
  const double radius = 1e-3;
  bench.scene.fluid.viscosity = 0.2;  // window/τ = 0.36
  std::ranges::fill(bench.velocity, Vector3(0, 0, 0.5));
  const auto side = bench.take_part(one_sphere({0.15, 0.15, 0.15}, radius, 2500), true);
  Fields begin;
  side->start({}, begin);
  Vector3 given = Vector3::Zero();
  for (int step = 1; step <= 60; ++step) {
    Fields out;
    side->advance(bench.window(step), bench.fluid(), out, quiet);
    given = sum(out.vectors(field::impulse_given, 27));
    side->commit();
  }
  const double stokes = 3 * std::numbers::pi * 0.2 * 2 * radius * 0.5;
  EXPECT_NEAR(given.z(), 1e-3 * stokes, 1e-14 * 1e-3 * stokes);
}

TEST(ParticleParticipant, hands_over_the_momentum_that_the_fluid_lost_the_window_before) {
  Bench bench;
  bench.scene.scene.gravity.setZero();
  bench.scene.interphase.drag = DragLaw::gidaspow;
  for (const double viscosity : {1.8e-5, 1.0}) {  // Δt/τ from 1e-4 to 60
    bench.scene.fluid.viscosity = viscosity;
    for (std::size_t c = 0; c < bench.velocity.size(); ++c) {
      bench.velocity[c] = {0.1 * static_cast<double>(c % 5), 0, 0.5};
      bench.gradient[c].setZero();
    }
    const auto side = bench.take_part(cloud());
    Fields begin;
    side->start({}, begin);
    Vector3 lost = Vector3::Zero();  // by the fluid in the window before
    double scale = 0;
    for (int step = 1; step <= 30; ++step) {
      const Vector3 before = velocities(*side).momentum;
      Fields out;
      side->advance(bench.window(step), bench.fluid(), out, quiet);
      const Vector3 given = sum(out.vectors(field::impulse_given, 27));
      side->commit();
      const Vector3 gained = velocities(*side).momentum - before;
      if (step == 1) lost = given;  // lent: the fluid loses it in the same window
      scale += velocities(*side).momentum.norm();
      // Sums over 60 particles and 27 cells.
      EXPECT_LE((given - lost).norm(), 1e-13 * scale) << step;
      EXPECT_LE((gained - lost).norm(), 1e-13 * scale) << step;
      // The fluid: in each cell its own mass, with implicit drag.
      const auto coefficient = out.scalars(field::drag_coefficient, 27);
      const auto source = out.vectors(field::drag_source, 27);
      lost.setZero();
      for (int c = 0; c < 27; ++c) {
        const double mass = 1.2 * bench.mesh.cell_volumes[c];
        const Vector3 old = bench.velocity[c];
        bench.velocity[c] = (mass * old + 1e-3 * source[c]) / (mass + 1e-3 * coefficient[c]);
        lost -= 1e-3 * (source[c] - coefficient[c] * bench.velocity[c]);
      }
      EXPECT_GT(given.norm(), 0);
      if (step == 1) lost -= given;
    }
  }
}

TEST(ParticleParticipant, feels_the_fluid_in_the_first_window_as_in_the_others) {
  // Particles that the fluid does not notice: the drag of start and end, then gravity less
  // buoyancy.
  Bench bench({1, 1, 1});
  const double radius = 1e-4;
  const Vector3 stream(0.3, 0, 0.1);
  std::ranges::fill(bench.velocity, stream);
  std::ranges::fill(bench.gradient, Vector3(0, 0, 1e3));  // not of an answer: not felt
  for (const double viscosity : {1.8e-5, 1.0}) {          // Δt/τ of 0.003 and 180
    bench.scene.fluid.viscosity = viscosity;
    const auto side = bench.take_part(one_sphere({0.15, 0.15, 0.15}, radius, 2500));
    Fields begin;
    side->start({}, begin);
    Fields out;
    side->advance(bench.window(1), bench.fluid(), out, quiet);
    side->commit();
    Fields end;
    side->snapshot(end);
    const double b = 1e-3 * 18 * viscosity / (2500 * 4 * radius * radius);
    const double weight = std::min(1.0, 0.5 + 1.5 * b);  // of the end
    const Vector3 expected =
        b / (1 + weight * b) * stream - Vector3(0, 0, 1e-3 * 9.81 * (1 - 1.2 / 2500));
    // The gas weighs 1e6 times as much as what 1e-3 s of drag move at most of it.
    EXPECT_LE((end.vectors("velocity", 1)[0] - expected).norm(), 1e-6 * stream.norm()) << viscosity;
  }
}

TEST(ParticleParticipant, is_not_carried_away_in_the_first_window_by_a_fluid_that_follows_it) {
  // 60 spheres in one cell that weigh more than their fluid: long before the window's end both have
  // one velocity, that of their momentum.
  Bench bench({1, 1, 1});
  bench.scene.scene.gravity.setZero();
  bench.scene.fluid.viscosity = 1e4;
  std::ranges::fill(bench.velocity, Vector3(0.3, 0, 0.1));
  ParticleState heavy = cloud();
  std::ranges::fill(heavy.density, 1e4);
  for (Vector3& velocity : heavy.velocity) velocity = {0, 0, 0.5};
  const auto side = bench.take_part(heavy);
  Fields begin;
  side->start({}, begin);
  const double particles = begin.number(field::particle_mass);
  const double fluid = 1.2 * (0.3 * 0.3 * 0.3 - begin.number(field::particle_volume));
  const Vector3 before = velocities(*side).momentum;
  Fields out;
  side->advance(bench.window(1), bench.fluid(), out, quiet);
  side->commit();
  const Vector3 shared = (before + fluid * bench.velocity[0]) / (particles + fluid);
  // To some τ/Δt of the slip, 0.5 m/s; τ = ρ_p d²/(18 μ) is 2e-5 s at most.
  EXPECT_LE((velocities(*side).momentum / particles - shared).norm(), 0.05 * 0.5);
  EXPECT_GT((before / particles - shared).norm(), 1e-3);
  EXPECT_GT((Vector3(0.3, 0, 0.1) - shared).norm(), 0.3);
}

TEST(ParticleParticipant, hands_over_to_fixed_particles_as_to_free_ones) {
  // What fixed ones are given goes into what holds them: the ledger of fluid and particles closes.
  Bench bench;
  bench.scene.fluid.viscosity = 1.0;
  ParticleState particles = cloud();
  for (int row = 0; row < particles.size(); row += 2) particles.velocity[row].setZero();
  particles.fixed.resize(particles.id.size(), 0);
  for (int row = 0; row < particles.size(); row += 2) particles.fixed[row] = 1;
  for (Vector3& velocity : bench.velocity) velocity = {0.1, 0, 0.5};
  const auto side = bench.take_part(particles);
  Fields begin;
  side->start({}, begin);
  Vector3 lost = Vector3::Zero();
  for (int step = 1; step <= 5; ++step) {
    Fields out;
    side->advance(bench.window(step), bench.fluid(), out, quiet);
    const Vector3 given = sum(out.vectors(field::impulse_given, 27));
    side->commit();
    if (step > 1) {
      EXPECT_LE((given - lost).norm(), 1e-13 * lost.norm()) << step;  // sums over 60 and 27
    }
    const auto coefficient = out.scalars(field::drag_coefficient, 27);
    const auto source = out.vectors(field::drag_source, 27);
    lost.setZero();
    for (int c = 0; c < 27; ++c) lost -= 1e-3 * (source[c] - coefficient[c] * bench.velocity[c]);
    EXPECT_GT(lost.norm(), 0);
    if (step == 1) lost -= given;  // it was lent
  }
}

TEST(ParticleParticipant, gives_the_impulse_where_the_fluid_was_told_of_it) {
  Bench bench;
  bench.scene.interphase.voidage = VoidageMap::centroid;
  bench.scene.scene.gravity.setZero();
  ParticleState bullet = one_sphere({0.05, 0.15, 0.15}, 1e-3, 2500);
  bullet.velocity[0] = {100, 0, 0};  // a cell a window: 12, 13, 14, 12, ...
  const auto side = bench.take_part(bullet);
  Fields begin;
  side->start({}, begin);
  for (int step = 1; step <= 4; ++step) {
    Fields out;
    side->advance(bench.window(step), bench.fluid(), out, quiet);
    const auto given = out.vectors(field::impulse_given, 27);
    for (int c = 0; c < 27; ++c) {
      const bool told = c == 12 + (step - 1) % 3;  // where it was as the fluid solved
      EXPECT_EQ(given[c].x() < 0, told) << "cell " << c << ", step " << step;
    }
    side->commit();
  }
}

TEST(ParticleParticipant, repeats_a_window_with_the_same_bits_after_a_rollback) {
  Bench bench;
  bench.scene.interphase.drag = DragLaw::gidaspow;
  std::ranges::fill(bench.velocity, Vector3(0.2, 0, 0.5));
  std::ranges::fill(bench.gradient, Vector3(0, 3, -20));
  const auto straight = bench.take_part(cloud());
  const auto retried = bench.take_part(cloud());
  Fields begin;
  straight->start({}, begin);
  Fields again;
  retried->start({}, again);
  for (int step = 1; step <= 4; ++step) {
    Fields expected;
    straight->advance(bench.window(step), bench.fluid(), expected, quiet);
    const auto wanted = copy(expected);
    straight->commit();

    const auto fluid = bench.velocity;
    std::ranges::fill(bench.velocity, Vector3(-3, 1, 7));  // an attempt with another answer
    Fields refused;
    retried->advance({step, 0, 3e-3}, bench.fluid(), refused, quiet);
    EXPECT_NE(copy(refused), wanted);
    retried->rollback();
    bench.velocity = fluid;
    Fields out;
    retried->advance(bench.window(step), bench.fluid(), out, quiet);
    EXPECT_EQ(copy(out), wanted) << step;
    retried->commit();
    for (Vector3& u : bench.velocity) u *= 1.1;
  }
  Fields one;
  Fields two;
  straight->snapshot(one);
  retried->snapshot(two);
  EXPECT_EQ(copy(one), copy(two));
}

TEST(ParticleParticipant, has_the_same_bits_for_any_number_of_threads) {
  std::vector<std::map<std::string, std::vector<double>>> results;
  for (const int threads : {1, 2, 5}) {
    Bench bench;
    bench.scene.particles.numerics.threads = threads;
    bench.scene.interphase.drag = DragLaw::gidaspow;
    std::ranges::fill(bench.velocity, Vector3(0.2, 0, 0.5));
    const auto side = bench.take_part(cloud());
    Fields begin;
    side->start({}, begin);
    for (int step = 1; step <= 3; ++step) {
      Fields out;
      side->advance(bench.window(step), bench.fluid(), out, quiet);
      side->commit();
      if (step == 3) results.push_back(copy(out));
    }
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

TEST(ParticleParticipant, keeps_its_committed_state_when_a_window_fails) {
  Bench bench;
  std::ranges::fill(bench.velocity, Vector3(0, 0, 0.5));
  const auto side = bench.take_part(cloud());
  Fields begin;
  side->start({}, begin);
  Fields out;
  side->advance(bench.window(1), bench.fluid(), out, quiet);
  side->commit();
  Fields before;
  side->snapshot(before);
  const auto kept = copy(before);
  const auto good = bench.velocity;
  bench.velocity[5].x() = std::numeric_limits<double>::quiet_NaN();
  std::ranges::fill(bench.velocity, bench.velocity[5]);
  Fields bad;
  EXPECT_THROW(side->advance(bench.window(2), bench.fluid(), bad, quiet), NumericsError);
  side->rollback();
  Fields after;
  side->snapshot(after);
  EXPECT_EQ(copy(after), kept);
  bench.velocity = good;
  Fields retry;
  side->advance(bench.window(2), bench.fluid(), retry, quiet);
  side->commit();
}

TEST(ParticleParticipant, refuses_calls_out_of_order) {
  Bench bench;
  const auto side = bench.take_part(cloud());
  Fields out;
  side->start({}, out);
  EXPECT_THROW(side->commit(), ProtocolError);
  side->advance(bench.window(1), bench.fluid(), out, quiet);
  Fields other;
  EXPECT_THROW(side->advance(bench.window(2), bench.fluid(), other, quiet), ProtocolError);
  EXPECT_THROW(side->snapshot(other), ProtocolError);
  side->commit();
  side->snapshot(other);
}

TEST(ParticleParticipant, cuts_the_window_into_the_sub_steps_of_the_scene) {
  Bench bench;
  FreeFlight* engine = nullptr;
  ParticleParticipant side("test", [&](const Scene& scene, const Mesh&) {
    auto made = std::make_unique<FreeFlight>(cloud(), scene.scene.gravity, Vector3::Constant(0.3));
    engine = made.get();
    return made;
  });
  side.configure(bench.scene, bench.mesh);
  Fields out;
  side.start({}, out);
  side.advance(bench.window(1), bench.fluid(), out, quiet);
  EXPECT_EQ(engine->sub_steps_seen, 4);  // 1e-3/2.5e-4
}

}  // namespace
}  // namespace fluxpact
