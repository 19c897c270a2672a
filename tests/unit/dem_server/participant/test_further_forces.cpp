// Forces beside drag as the particle side applies them: added mass, lift, viscous force,
// dispersion.
#include <gtest/gtest.h>

#include <cmath>
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

const std::vector<InterphaseForce> all_forces{
    InterphaseForce::pressure_gradient, InterphaseForce::viscous,
    InterphaseForce::added_mass,        InterphaseForce::saffman_lift,
    InterphaseForce::magnus_lift,       InterphaseForce::turbulent_dispersion};

/// A fluid that gives what the forces ask for.
struct ForceBench : Bench {
  explicit ForceBench(std::vector<InterphaseForce> forces) {
    scene.interphase.forces = std::move(forces);
    const std::size_t cells = velocity.size();
    viscous.assign(cells, Vector3(0, 0, 5));
    acceleration.assign(cells, Vector3(1, 0, 0));
    vorticity.assign(cells, Vector3(0, 20, 3));
    energy.assign(cells, 0.04);
    dissipation.assign(cells, 0.5);
  }
  Fields fluid() const {
    Fields in = Bench::fluid();
    const AskedFields asked = asked_of_fluid(scene);
    for (const std::string& name : asked.vectors) {
      in.add(name, name == field::viscous_force ? viscous
                   : name == field::vorticity   ? vorticity
                                                : acceleration);
    }
    for (const std::string& name : asked.scalars)
      in.add(name, name == field::turbulent_energy ? energy : dissipation);
    return in;
  }
  void step(ParticleParticipant& side, int number) const {
    Fields out;
    side.advance(window(number), fluid(), out, quiet);
    side.commit();
  }

  std::vector<Vector3> viscous, acceleration, vorticity;
  std::vector<double> energy, dissipation;
};

Vector3 velocity_of(ParticleParticipant& side) {
  Fields state;
  side.snapshot(state);
  return state.vectors("velocity", 1)[0];
}

/// A sphere of 1 mm in a liquid of 1000 kg/m³ at rest, in Stokes drag.
struct Sphere {
  Sphere(double ratio, double over, double window)
      : bench({InterphaseForce::pressure_gradient, InterphaseForce::added_mass}) {
    const double d = 1e-3;
    tau = window / over;
    bench.scene.coupling.window = window;
    bench.scene.fluid.density = 1000;
    bench.scene.fluid.viscosity = 1000 * ratio * d * d / (18 * tau);
    std::ranges::fill(bench.acceleration, Vector3(0, 0, 0));
    terminal = -9.81 * (1 - 1 / ratio) * tau;
    added = 0.5 / ratio;
  }
  ForceBench bench;
  double tau = 0;       ///< m/ζ [s]
  double terminal = 0;  ///< [m/s]
  double added = 0;     ///< M/m
};

TEST(AddedMass, lets_a_sphere_fall_in_a_liquid_as_the_analytic_solution_to_first_order) {
  // (m + M) dv/dt = (m − m_f) g − ζ v, density ratio 2.5.
  std::vector<double> errors;
  for (const int windows : {40, 80, 160, 320}) {
    const double end = 0.02;
    Sphere sphere(2.5, 1.5 / windows, end / windows);
    const auto side = sphere.bench.take_part(one_sphere({0.15, 0.15, 0.15}, 5e-4, 2500));
    Fields out;
    side->start({}, out);
    for (int step = 1; step <= windows; ++step) sphere.bench.step(*side, step);
    const double exact = sphere.terminal * (1 - std::exp(-end / (sphere.tau * (1 + sphere.added))));
    errors.push_back(velocity_of(*side).z() / exact - 1);
  }
  EXPECT_LT(std::abs(errors[3]), 0.01);
  for (int i = 0; i < 3; ++i) {
    const double order = std::log2(errors[i] / errors[i + 1]);
    EXPECT_NEAR(order, 1, 0.1) << i;
  }
}

TEST(AddedMass, brings_any_sphere_to_its_terminal_slip_without_overshoot) {
  for (const double ratio : {0.1, 0.5, 2.5, 1000.0, 1e5}) {
    for (const double over : {1e-3, 0.1, 1.0, 30.0, 1e4}) {  // Δt/τ; the sub-step is Δt/4
      Sphere sphere(ratio, over, 1e-3);
      const auto side = sphere.bench.take_part(one_sphere({0.15, 0.15, 0.15}, 5e-4, 1000 * ratio));
      Fields out;
      side->start({}, out);
      sphere.bench.step(*side, 1);  // the fluid has not answered yet
      double off = velocity_of(*side).z() - sphere.terminal;
      const double factor = (1 + sphere.added) / (1 + sphere.added + over);
      for (int step = 2; step <= 300; ++step) {
        sphere.bench.step(*side, step);
        const double now = velocity_of(*side).z() - sphere.terminal;
        // Implicit Euler of the whole equation; each window rounds v and forces of its size.
        const double size = std::abs(sphere.terminal) * (1 + over) * (1 + sphere.added);
        EXPECT_NEAR(now, factor * off, 1e-14 * size) << ratio << " " << over;
        off = now;
      }
      if (over >= 1 || (over >= 0.1 && sphere.added < 1)) {
        EXPECT_LE(std::abs(off), 1e-6 * std::abs(sphere.terminal)) << ratio << " " << over;
      }
    }
  }
}

TEST(FurtherForces, act_as_their_closed_forms_on_a_sphere_in_a_given_flow) {
  // No drag, no weight: what a window adds to the velocity is Δt F/m with the flow of the last one.
  const double d = 1e-3;
  const double mass = 2500 * ball_volume(d / 2);
  const auto gain = [&](InterphaseForce force) {
    ForceBench bench({force});
    bench.scene.scene.gravity.setZero();
    bench.scene.interphase.drag = DragLaw::none;
    bench.scene.fluid.density = 1000;
    bench.scene.fluid.viscosity = 1e-3;
    std::ranges::fill(bench.velocity, Vector3(5e-3, 0, 0));
    std::ranges::fill(bench.vorticity, Vector3(0, 0, -10));
    const auto side = bench.take_part(one_sphere({0.15, 0.15, 0.15}, d / 2, 2500));
    Fields out;
    side->start({}, out);
    bench.step(*side, 1);
    EXPECT_EQ(velocity_of(*side), Vector3(0, 0, 0));
    bench.step(*side, 2);
    return Vector3(velocity_of(*side) * mass / 1e-3);  // [N]
  };
  const auto near = [](const Vector3& force, const Vector3& expected) {
    EXPECT_LE((force - expected).norm(), 1e-12 * expected.norm())
        << force.transpose() << " is not " << expected.transpose();
  };
  near(gain(InterphaseForce::viscous), ball_volume(d / 2) * Vector3(0, 0, 5));
  // Lagging in u = γ y: upwards (6.46 μ a² √(γ/ν) with Mei's factor).
  near(gain(InterphaseForce::saffman_lift), {0, 1.881770455376576e-08, 0});
  EXPECT_LT(gain(InterphaseForce::magnus_lift).y(), 0);
  // M [(u1 − u0)/Δt + (u·∇)u] of a steady flow: M (1, 0, 0), and M dv/dt against it.
  const double added = 500 * ball_volume(d / 2);
  near(gain(InterphaseForce::added_mass), added * mass / (mass + added) * Vector3(1, 0, 0));
}

TEST(FurtherForces, need_their_fields_and_send_theirs_only_if_asked) {
  for (const InterphaseForce force : all_forces) {
    ForceBench bench({InterphaseForce::pressure_gradient, force});
    const auto side = bench.take_part(cloud());
    Fields out;
    side->start({}, out);
    const bool returns = force == InterphaseForce::added_mass;
    EXPECT_EQ(copy(out).contains(field::pressure_return), returns);
    if (force == InterphaseForce::pressure_gradient) continue;
    Fields with_out;
    EXPECT_THROW(
        side->advance(bench.window(1), static_cast<const Bench&>(bench).fluid(), with_out, quiet),
        ProtocolError);
    Fields next;
    side->advance(bench.window(1), bench.fluid(), next, quiet);
    side->commit();
    EXPECT_EQ(copy(next).contains(field::pressure_return), returns);
    EXPECT_EQ(next.views().size(), returns ? 6U : 5U);
  }
}

/// Three windows with all forces; the last message.
std::map<std::string, std::vector<double>> three_windows(int threads, int seed, bool retried) {
  ForceBench bench(all_forces);
  bench.scene.particles.numerics.threads = threads;
  bench.scene.interphase.dispersion_seed = seed;
  std::ranges::fill(bench.velocity, Vector3(0.2, 0, 0.5));
  const auto side = bench.take_part(cloud());
  Fields begin;
  side->start({}, begin);
  for (int step = 1; step <= 3; ++step) {
    if (retried) {
      Fields refused;
      side->advance({step, 0, 3e-3}, bench.fluid(), refused, quiet);
      side->rollback();
    }
    Fields out;
    side->advance(bench.window(step), bench.fluid(), out, quiet);
    side->commit();
    if (step == 3) return copy(out);
  }
  return {};
}

TEST(FurtherForces, have_the_same_bits_for_any_threads_and_after_a_rollback) {
  const auto expected = three_windows(1, 1, false);
  EXPECT_EQ(three_windows(2, 1, false), expected);
  EXPECT_EQ(three_windows(5, 1, false), expected);
  EXPECT_EQ(three_windows(2, 1, true), expected);
  EXPECT_NE(three_windows(1, 2, false), expected);  // another seed, other eddies
}

TEST(Dispersion, shakes_a_sphere_that_follows_the_fluid_as_much_as_the_eddies) {
  // τ far below the window: v = u + u', and <u'²> = 2/3 k as long as the eddies outlive the window.
  ForceBench bench({InterphaseForce::turbulent_dispersion});
  bench.scene.scene.gravity.setZero();
  bench.scene.fluid.viscosity = 100;
  std::ranges::fill(bench.velocity, Vector3(0.2, 0, 0.5));
  double sum = 0;
  constexpr int seeds = 400;
  for (int seed = 0; seed < seeds; ++seed) {
    bench.scene.interphase.dispersion_seed = seed;
    const auto side = bench.take_part(one_sphere({0.15, 0.15, 0.15}, 1e-3, 100));
    Fields out;
    side->start({}, out);
    for (int step = 1; step <= 3; ++step) bench.step(*side, step);
    sum += (velocity_of(*side) - Vector3(0.2, 0, 0.5)).squaredNorm() / (3 * seeds);
  }
  // 1200 normal components: √(2/1200) = 4 %, four of them.
  EXPECT_NEAR(sum / (2.0 / 3.0 * 0.04), 1, 0.16);
}

}  // namespace
}  // namespace fluxpact
