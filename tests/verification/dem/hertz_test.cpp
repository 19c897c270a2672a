// Impacts of elastic spheres, after Chung & Ooi (Granul. Matter 13, 2011, 643-656): peak force,
// peak overlap and duration against Hertz' closed forms, and oblique impacts that slide throughout.
#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "tests/unit/dem_server/native/spheres_in_a_box.hpp"

namespace fluxpact {
namespace {

struct Solid {
  const char* name;
  double modulus, poisson, density;
};

Scene hertz_scene(const Solid& solid, double wall_stiffer, double e, double mu, double time_step) {
  Scene scene = box_scene({1, 1, 1});
  scene.particles.time_step = time_step;
  scene.coupling.window = time_step;
  scene.particles.contact.law = ContactLaw::hertz;
  scene.particles.materials["glass"] = {solid.density, solid.modulus, solid.poisson};
  scene.particles.contact.walls = {wall_stiffer * solid.modulus, solid.poisson};
  for (const char* other : {"glass", "walls"}) {
    PairSettings pair;
    pair.between = {"glass", other};
    pair.restitution = e;
    pair.friction = mu;
    scene.particles.contact.pairs.push_back(pair);
  }
  return scene;
}

struct Peak {
  double force, overlap, duration;  // N, m, s
};

/// Peaks of an impact that lasts about `expected` [s], in steps of a thousandth of it. `overlap_of`
/// sees the particles; the force is what changes the first one's velocity along `axis`.
template <class Overlap>
Peak impact(ParticleEngine& engine, double expected, int axis, double mass,
            const Overlap& overlap_of) {
  const double time_step = 1e-3 * expected;
  Peak peak{0, 0, 0};
  for (int step = 0; step < 1500; ++step) {
    const double before = engine.particles().velocity[0][axis];
    run(engine, time_step, time_step);
    const double change = engine.particles().velocity[0][axis] - before;
    peak.force = std::max(peak.force, std::abs(mass * change / time_step));
    const double overlap = overlap_of(engine.particles());
    peak.overlap = std::max(peak.overlap, overlap);
    if (overlap > 0) peak.duration += time_step;
  }
  return peak;
}

// A thousand steps a contact: the peaks fall within half a step of a sample (1e-6 of them), the
// duration is counted to two steps, the scheme is second order.
void expect_peak(const std::string& what, const Peak& found, const Peak& exact) {
  fmt::print("{:<22} {:>9.2f} N {:>8.3f} um {:>8.3f} us ({:.2f} {:.3f} {:.3f})\n", what,
             found.force, 1e6 * found.overlap, 1e6 * found.duration, exact.force,
             1e6 * exact.overlap, 1e6 * exact.duration);
  EXPECT_NEAR(found.force, exact.force, 2e-4 * exact.force);
  EXPECT_NEAR(found.overlap, exact.overlap, 1e-4 * exact.overlap);
  EXPECT_NEAR(found.duration, exact.duration, 2.5e-3 * exact.duration);
}

TEST(Hertz, two_equal_spheres_have_the_peaks_of_the_closed_form) {
  struct Row {
    Solid solid;
    Peak exact;
  };
  const Row rows[] = {{{"glass", 4.8e10, 0.20, 2800}, {10697, 274.11e-6, 40.34e-6}},
                      {{"limestone", 2.0e10, 0.25, 2500}, {7108.2, 368.30e-6, 54.20e-6}}};
  constexpr double r = 0.01;
  for (const Row& row : rows) {
    const double mass = 4.0 / 3.0 * std::numbers::pi * r * r * r * row.solid.density;
    ParticleState state;
    add_sphere(state, {0.5 - r, 0.5, 0.5}, {10, 0, 0}, r, row.solid.density);
    add_sphere(state, {0.5 + r, 0.5, 0.5}, {-10, 0, 0}, r, row.solid.density);
    const auto engine =
        make_engine(hertz_scene(row.solid, 1, 1, 0.35, 1e-3 * row.exact.duration), state);
    const Peak found = impact(*engine, row.exact.duration, 0, mass, [&](const ParticleState& now) {
      return 2 * r - (now.position[1] - now.position[0]).norm();
    });
    expect_peak(row.solid.name, found, row.exact);
    EXPECT_NEAR(engine->particles().velocity[1].x(), 10, 1e-4);
  }
}

TEST(Hertz, sphere_on_a_plane_a_thousand_times_stiffer_has_the_peaks_of_the_closed_form) {
  struct Row {
    Solid solid;
    Peak exact;
  };
  // Durations of the rigid plane, longer by the 4e-4 of the softer contact.
  const Row rows[] = {{{"aluminium alloy", 7.0e10, 0.30, 2699}, {11365, 49.737e-6, 731.9e-6}},
                      {{"magnesium alloy", 4.0e10, 0.35, 1800}, {7229.8, 52.144e-6, 767.3e-6}}};
  constexpr double r = 0.1;
  for (const Row& row : rows) {
    const double mass = 4.0 / 3.0 * std::numbers::pi * r * r * r * row.solid.density;
    ParticleState state;
    add_sphere(state, {0.5, 0.5, r}, {0, 0, -0.2}, r, row.solid.density);
    const auto engine =
        make_engine(hertz_scene(row.solid, 1000, 1, 0, 1e-3 * row.exact.duration), state);
    const Peak found = impact(*engine, row.exact.duration, 2, mass,
                              [&](const ParticleState& now) { return r - now.position[0].z(); });
    expect_peak(row.solid.name, found, row.exact);
  }
}

TEST(Hertz, oblique_impact_that_slides_loses_what_friction_takes) {
  constexpr double r = 0.0025;
  constexpr double speed = 3.9;
  constexpr double mu = 0.092;
  constexpr double e = 0.98;
  const Solid solids[] = {{"aluminium oxide", 3.8e11, 0.23, 4000},
                          {"aluminium alloy", 7.0e10, 0.33, 2700}};
  for (const Solid& solid : solids) {
    for (const double degrees : {45.0, 60.0}) {
      const double angle = degrees * std::numbers::pi / 180;
      ParticleState state;
      add_sphere(state, {0.5, 0.5, r + 1e-9}, speed * Vector3(std::sin(angle), 0, -std::cos(angle)),
                 r, solid.density);
      const auto engine = make_engine(hertz_scene(solid, 1000, e, mu, 1e-8), state);
      run(*engine, 1e-4, 1e-8);
      const Vector3 v = engine->particles().velocity[0];
      const double kept = v.x() / (speed * std::sin(angle));
      const double rebound = v.z() / (speed * std::cos(angle));
      const double spin = engine->particles().spin[0].y();
      // 1 − μ (1 + e) / tan θ, and 5/2 of the lost velocity over the radius.
      const double exact = 1 - mu * (1 + e) / std::tan(angle);
      const double exact_spin = 2.5 * mu * (1 + e) * speed * std::cos(angle) / r;
      fmt::print("{:<16} {:.0f} degrees: e_n {:.5f}, e_t {:.5f} ({:.5f}), spin {:.2f} ({:.2f})\n",
                 solid.name, degrees, rebound, kept, exact, spin, exact_spin);
      // Some thousands of steps a contact: the damping fits e to 1e-3; so does friction, which also
      // acts in the attractive end of the contact, a share of (1 - e)² or so.
      EXPECT_NEAR(rebound, e, 1e-3);
      EXPECT_NEAR(1 - kept, 1 - exact, 1e-3 * (1 - exact));
      EXPECT_NEAR(spin, exact_spin, 1e-3 * exact_spin);
    }
  }
}

}  // namespace
}  // namespace fluxpact
