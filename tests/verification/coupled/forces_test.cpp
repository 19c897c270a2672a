// Forces between the phases in coupled runs: momentum, stability of suspensions in liquids, drift.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "dem_server/participant/particle_participant.hpp"
#include "tests/unit/dem_server/participant/free_flight.hpp"
#include "tests/verification/coupled/coupled_run.hpp"

namespace fluxpact {
namespace {

Formula formula(const std::string& text) {
  Formula result;
  result.text = text;
  return result;
}

std::unique_ptr<Participant> free_particles(const ParticleState& initial, const Vector3& period) {
  return std::make_unique<ParticleParticipant>("test", [=](const Scene& scene, const Mesh&) {
    return std::make_unique<FreeFlight>(initial, scene.scene.gravity, period);
  });
}

// ---- momentum ----

struct Combination {
  std::string name;
  std::vector<InterphaseForce> forces;
  PressureModel model = PressureModel::a;
};

constexpr auto pressure = InterphaseForce::pressure_gradient;
constexpr auto viscous = InterphaseForce::viscous;
constexpr auto added_mass = InterphaseForce::added_mass;
constexpr auto saffman = InterphaseForce::saffman_lift;
constexpr auto magnus = InterphaseForce::magnus_lift;
constexpr auto dispersion = InterphaseForce::turbulent_dispersion;

class CoupledForces : public testing::TestWithParam<std::tuple<VoidageMap, Combination>> {};

/// 80 spheres that move and spin in a periodic box of liquid, which shears.
Scene stirred_box(VoidageMap map, const Combination& combination) {
  Scene scene;
  scene.scene.gravity = {0, 0, -9.81};
  scene.coupling.window = 2e-3;
  scene.particles.numerics.threads = 1;
  scene.fluid.numerics.threads = 1;
  scene.fluid.density = 1000;
  scene.fluid.viscosity = 1e-2;
  scene.fluid.mesh.box = {{0, 0, 0}, {0.1, 0.08, 0.12}, {5, 4, 6}};
  scene.fluid.mesh.periodic = {Axis::x, Axis::y, Axis::z};
  scene.fluid.initial.superficial.components = {formula("0.2*sin(2*pi*y/0.08)"), Formula(0),
                                                formula("0.1*sin(2*pi*x/0.1)")};
  scene.interphase.voidage = map;
  scene.interphase.model = combination.model;
  scene.interphase.forces = combination.forces;
  scene.interphase.added_mass_crowding = Crowding::zuber;
  if (has_force(scene, dispersion)) {
    scene.fluid.turbulence.model = TurbulenceModel::k_epsilon;
    scene.fluid.turbulence.kinetic_energy = 1e-3;
    scene.fluid.turbulence.dissipation = 1e-3;
  }
  return scene;
}

ParticleState spheres(double density) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> share(0, 1);
  ParticleState particles;
  for (int i = 0; i < 80; ++i) {
    particles.id.push_back(i + 1);
    particles.position.emplace_back(0.1 * share(random), 0.08 * share(random),
                                    0.12 * share(random));
    particles.velocity.emplace_back(0.2 * share(random), 0, -0.1 * share(random));
    particles.spin.emplace_back(0, 30 * share(random), 0);
    particles.radius.push_back(2e-3 + 2e-3 * share(random));
    particles.density.push_back(density);
    particles.material.push_back(0);
  }
  return particles;
}

TEST_P(CoupledForces, hand_over_momentum_to_the_last_digits_in_every_window) {
  const auto& [map, combination] = GetParam();
  for (const double density : {100.0, 2500.0, 1e7}) {
    CoupledRun run(stirred_box(map, combination),
                   free_particles(spheres(density), {0.1, 0.08, 0.12}));
    for (int step = 1; step <= 8; ++step) {
      run.advance();
      EXPECT_GT(run.newest.total.scale, 0);
    }
    // Sums over 80 particles and 120 cells.
    EXPECT_LE(run.worst_impulse, 1e-13) << density;
    EXPECT_LE(run.worst_handover, 1e-12) << density;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Everywhere, CoupledForces,
    testing::Combine(
        testing::Values(VoidageMap::exact, VoidageMap::centroid),
        testing::Values(Combination{"drag", {}}, Combination{"pressure", {pressure}},
                        Combination{"viscous", {pressure, viscous}},
                        Combination{"added_mass", {pressure, added_mass}},
                        Combination{"added_mass_alone", {added_mass}},
                        Combination{"added_mass_b", {pressure, added_mass}, PressureModel::b},
                        Combination{"lifts", {pressure, saffman, magnus}},
                        Combination{"dispersion", {pressure, dispersion}},
                        Combination{"all",
                                    {pressure, viscous, added_mass, saffman, magnus, dispersion}})),
    [](const auto& test) {
      return std::string(std::get<0>(test.param) == VoidageMap::exact ? "exact_" : "centroid_") +
             std::get<1>(test.param).name;
    });

// ---- suspensions in liquids ----

/// A closed box of liquid in which spheres settle.
Scene settling_box(double ratio, double diameter, double window, int count) {
  Scene scene;
  scene.coupling.window = window;
  scene.scene.end_time = window;
  scene.scene.gravity = {0, 0, -9.81};
  scene.fluid.density = 1000;
  scene.fluid.viscosity = 1e-3;
  const double side = 10 * diameter;
  scene.fluid.mesh.box = {{0, 0, 0}, {side, side, 2 * side}, {4, 4, 8}};
  scene.fluid.boundaries["walls"] = BoundarySettings{};
  scene.fluid.numerics.threads = 1;
  scene.particles.numerics.threads = 1;
  scene.particles.materials["glass"].density = 1000 * ratio;
  PairSettings pair;
  pair.between = {"glass", "glass"};
  pair.normal_stiffness = 20;
  scene.particles.contact.pairs = {pair, pair};
  scene.particles.contact.pairs[1].between = {"glass", "walls"};
  InsertionSettings spheres;
  spheres.type = InsertionType::packing;
  spheres.material = "glass";
  spheres.diameter = diameter;
  spheres.count = count;
  scene.particles.insertion = {spheres};
  scene.interphase.forces = {pressure, added_mass};
  scene.interphase.added_mass_crowding = Crowding::zuber;
  return scene;
}

double largest_speed(CoupledRun& run) {
  double largest = 0;
  for (const Vector3& v : run.of_particles("velocity")) largest = std::max(largest, v.norm());
  return largest;
}

TEST(Suspension, stays_stable_in_a_liquid_for_windows_far_beyond_the_response_of_its_particles) {
  for (const double diameter : {1e-4, 1e-3}) {
    const double window = 1e-3;
    Scene scene = settling_box(2.5, diameter, window, 1200);
    scene.particles.time_step = diameter < 5e-4 ? 5e-6 : 5e-5;
    CoupledRun run(scene, make_particle_participant("native"));
    double largest = 0;
    for (int step = 1; step <= 60; ++step) {
      run.advance();
      largest = std::max(largest, largest_speed(run));
    }
    std::printf("d %g: largest speed %g, at the end %g, handover %g\n", diameter, largest,
                largest_speed(run), run.worst_handover);
  }
}

}  // namespace
}  // namespace fluxpact
