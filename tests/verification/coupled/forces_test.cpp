// Forces between the phases in coupled runs: momentum, stability of suspensions in liquids, drift.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "dem_server/backends/native/native_engine.hpp"
#include "dem_server/interphase/drag.hpp"
#include "dem_server/interphase/overlap.hpp"
#include "dem_server/participant/particle_participant.hpp"
#include "dem_server/participant/particle_server.hpp"
#include "proto/scene/names.hpp"
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

void PrintTo(const Combination& c, std::ostream* out) { *out << c.name; }  // NOLINT: GoogleTest's

constexpr auto pressure = InterphaseForce::pressure_gradient;
constexpr auto viscous = InterphaseForce::viscous;
constexpr auto added_mass = InterphaseForce::added_mass;
constexpr auto saffman = InterphaseForce::saffman_lift;
constexpr auto magnus = InterphaseForce::magnus_lift;
constexpr auto dispersion = InterphaseForce::turbulent_dispersion;

class CoupledForces : public testing::TestWithParam<std::tuple<VoidageSettings, Combination>> {};

/// 80 spheres that move and spin in a periodic box of liquid, which shears.
Scene stirred_box(const VoidageSettings& map, const Combination& combination) {
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

const Combination only_drag{"drag", {}};
const Combination all_forces{"all", {pressure, viscous, added_mass, saffman, magnus, dispersion}};

/// Maps that go on from cell to cell, by diffusion or out of cells that hold too much.
VoidageSettings diffusion() {
  VoidageSettings settings(VoidageMap::diffusion);
  settings.width = 0.03;
  return settings;
}
VoidageSettings over_full() {
  VoidageSettings settings(VoidageMap::exact);
  settings.smallest = 0.97;  // two spheres or more in a cell; the mean voidage is 0.99
  return settings;
}

std::string name_of_case(const testing::TestParamInfo<CoupledForces::ParamType>& test) {
  const auto& [map, combination] = test.param;
  const bool full = map.smallest > VoidageSettings().smallest;
  return fmt::format("{}_{}", full ? "over_full" : name_of(map.map), combination.name);
}

INSTANTIATE_TEST_SUITE_P(
    Everywhere, CoupledForces,
    testing::Combine(
        testing::Values(VoidageMap::exact, VoidageMap::centroid),
        testing::Values(only_drag, Combination{"pressure", {pressure}},
                        Combination{"viscous", {pressure, viscous}},
                        Combination{"added_mass", {pressure, added_mass}},
                        Combination{"added_mass_alone", {added_mass}},
                        Combination{"added_mass_b", {pressure, added_mass}, PressureModel::b},
                        Combination{"lifts", {pressure, saffman, magnus}},
                        Combination{"dispersion", {pressure, dispersion}}, all_forces)),
    name_of_case);

INSTANTIATE_TEST_SUITE_P(OtherMaps, CoupledForces,
                         testing::Combine(testing::Values(VoidageSettings(VoidageMap::satellite),
                                                          VoidageSettings(VoidageMap::kernel),
                                                          diffusion(), over_full()),
                                          testing::Values(only_drag, all_forces)),
                         name_of_case);

// ---- suspensions in liquids ----

/// A closed box of liquid in which spheres settle.
Scene settling_box(double ratio, double diameter, double window, int count) {
  Scene scene;
  scene.coupling.window = window;
  scene.particles.time_step = 0.05 * diameter;  // a sixteenth of the contact time
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
  pair.normal_stiffness = 4000 * ratio * diameter;  // contacts of 0.8 ms at 1 mm
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

/// Of one sphere in much liquid [m/s].
double terminal_speed(const Scene& scene, double ratio, double diameter) {
  const FluidProperties fluid{scene.fluid.density, scene.fluid.viscosity};
  const double weight = std::abs(ratio - 1) * fluid.density * ball_volume(diameter / 2) * 9.81;
  double speed = 0;
  for (int i = 0; i < 200; ++i)
    speed = 0.5 * (speed + weight / wen_yu_drag({1, diameter, speed}, fluid));
  return speed;
}

struct SuspensionCase {
  double ratio;     ///< of densities
  double diameter;  ///< [m]
  double window;    ///< [s]
  int windows;
};

void PrintTo(const SuspensionCase& c, std::ostream* out) {  // NOLINT: GoogleTest's name
  *out << "density ratio " << c.ratio << ", " << 1e3 * c.diameter << " mm";
}

class Suspension : public testing::TestWithParam<SuspensionCase> {};

TEST_P(Suspension, stays_calm_however_long_the_window_is_beside_the_response_of_its_particles) {
  // A solid fraction of 0.31, in windows of up to 20 τ: with the pressure gradient of the window
  // before, the first case reaches 18 times the bound.
  const SuspensionCase& c = GetParam();
  const Scene scene = settling_box(c.ratio, c.diameter, c.window, 1200);
  CoupledRun run(scene, make_particle_participant(
                            "native", {{ParticleBackend::native, {}, make_native_engine}}));
  double largest = 0;
  for (int step = 1; step <= c.windows; ++step) {
    run.advance();
    for (const Vector3& v : run.of_particles("velocity")) largest = std::max(largest, v.norm());
  }
  const double alone = terminal_speed(scene, c.ratio, c.diameter);
  EXPECT_LT(largest, alone);  // neighbours hold each other back
  EXPECT_GT(largest, 0.1 * alone);
  EXPECT_LE(run.worst_impulse, 1e-13);
  EXPECT_LE(run.worst_handover, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Liquid, Suspension,
                         testing::Values(SuspensionCase{2.5, 1e-4, 1e-3, 100},
                                         SuspensionCase{2.5, 1e-3, 1e-3, 100},
                                         SuspensionCase{0.1, 1e-3, 1e-4, 150}),
                         [](const auto& test) { return std::to_string(test.index); });

// ---- drift in a shear flow ----

constexpr double shear = 10;       // [1/s] u = γ (y − 0.2) in x
constexpr double diameter = 1e-4;  // [m]
constexpr double spin = 500;       // [rad/s] about z

/// Water between two walls that move, and one sphere of 2500 kg/m³ that is pulled along x.
Scene shear_flow(InterphaseForce lift) {
  Scene scene;
  scene.scene.gravity = {9.81, 0, 0};
  scene.coupling.window = 1e-3;
  scene.particles.numerics.threads = 1;
  scene.fluid.numerics.threads = 1;
  scene.fluid.density = 1000;
  scene.fluid.viscosity = 1e-3;
  scene.fluid.mesh.box = {{0, 0, 0}, {0.4, 0.4, 0.4}, {4, 8, 4}};
  scene.fluid.mesh.periodic = {Axis::x, Axis::z};
  scene.fluid.mesh.patches = {{"low", {Side::y_min, {}}}, {"high", {Side::y_max, {}}}};
  scene.fluid.boundaries["low"].velocity = Vector3(-0.2 * shear, 0, 0);
  scene.fluid.boundaries["high"].velocity = Vector3(0.2 * shear, 0, 0);
  scene.fluid.initial.superficial.components[0] = formula("10*(y - 0.2)");
  scene.interphase.drag = DragLaw::stokes;
  scene.interphase.forces = {pressure, lift};
  return scene;
}

/// The steady velocity across the flow with a lift P(|s|) (−s_y, s_x) for the slip s = u − v:
///   m γ v_y = ζ s_x − P s_y + W,   0 = ζ s_y + P s_x,   v_y = −s_y.
template <class Lift>
double drift(const Lift& lift) {
  const double volume = std::numbers::pi / 6 * diameter * diameter * diameter;
  const double zeta = 3 * std::numbers::pi * 1e-3 * diameter;
  const double pull = 1500 * volume * 9.81;
  double x = -pull / zeta;
  double y = 0;
  for (int i = 0; i < 100; ++i) {
    const double p = lift(std::hypot(x, y));
    y = -p * x / zeta;
    x = (-2500 * volume * shear * y + p * y - pull) / zeta;
  }
  return -y;
}

double coupled_drift(InterphaseForce lift) {
  ParticleState sphere = one_sphere({0.1, 0.23, 0.21}, diameter / 2, 2500);
  sphere.spin[0] = {0, 0, spin};
  CoupledRun run(shear_flow(lift), free_particles(sphere, {0.4, 0, 0.4}));
  // The start dies out as (1 + Δt/τ)^−n = 1.72^−n, a walk through the cells of 0.1 m goes on.
  for (int step = 1; step <= 60; ++step) run.advance();
  EXPECT_LE(run.worst_handover, 1e-12);
  return run.of_particles("velocity")[0].y();
}

TEST(LiftInShear, drives_a_sphere_that_leads_to_the_slower_side_as_saffman_and_mei_say) {
  const double expected = drift([](double slip) {
    const double beta = diameter * shear / (2 * slip);
    const double reynolds = 1e6 * slip * diameter;
    const double mei =
        (1 - 0.3314 * std::sqrt(beta)) * std::exp(-reynolds / 10) + 0.3314 * std::sqrt(beta);
    // 6.46 μ a² √(γ/ν) a slip of one, along s×Ω = γ (−s_y, s_x).
    return 6.46 * 1e-3 * diameter * diameter / 4 * std::sqrt(shear * 1e6) * mei;
  });
  EXPECT_LT(expected, -1e-4);  // [m/s]
  // Flow and slip are known a window or two late: 2 γ Δt v_y beside the slip, with v_y/s = 0.05.
  EXPECT_NEAR(coupled_drift(saffman) / expected, 1, 2e-3);
}

TEST(LiftInShear, bends_the_path_of_a_spinning_sphere_as_oesterle_and_bui_dinh_say) {
  const double expected = drift([](double slip) {
    const double turning = spin + shear / 2;  // relative to the fluid, which turns by −γ/2
    const double reynolds = 1e6 * slip * diameter;
    const double spin_reynolds = 1e6 * diameter * diameter * turning;
    const double c =
        0.45 + (spin_reynolds / reynolds - 0.45) *
                   std::exp(-0.05684 * std::pow(spin_reynolds, 0.4) * std::pow(reynolds, 0.3));
    return -0.5 * 1000 * std::numbers::pi / 4 * diameter * diameter * c * slip;
  });
  EXPECT_GT(expected, 1e-4);  // back spin seen along its way: to the side where its surface lags
  EXPECT_NEAR(coupled_drift(magnus) / expected, 1, 4e-3);  // as above, v_y/s = 0.2
}

}  // namespace
}  // namespace fluxpact
