// The forces beside drag in the exchange: momentum exact for every map and combination, and the
// eliminations of added mass and pressure gradient against their closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <tuple>

#include "boxes.hpp"
#include "dem_server/interphase/forces.hpp"
#include "dem_server/interphase/own_disturbance.hpp"
#include "dem_server/interphase/prediction.hpp"
#include "proto/base/errors.hpp"
#include "proto/scene/names.hpp"

namespace fluxpact {
namespace {

using testing_boxes::box;

const Vector3 zero = Vector3::Zero();

/// Random fields of a fluid.
struct RandomFluid {
  std::vector<Vector3> velocity, gradient, viscous, acceleration, vorticity;
  std::vector<double> energy, dissipation;

  RandomFluid(int cells, std::mt19937_64& random) {
    std::uniform_real_distribution<double> any(-1, 1);
    const auto vector = [&](double size) {
      return Vector3(size * any(random), size * any(random), size * any(random));
    };
    for (int c = 0; c < cells; ++c) {
      velocity.push_back(vector(1));
      gradient.push_back(vector(1e4));
      viscous.push_back(vector(100));
      acceleration.push_back(vector(10));
      vorticity.push_back(vector(20));
      energy.push_back(0.1 + 0.05 * any(random));
      dissipation.push_back(1 + 0.5 * any(random));
    }
  }
  FluidSeen seen() const {
    return {true, velocity, gradient, viscous, acceleration, vorticity, energy, dissipation};
  }
};

struct Combination {
  std::string name;
  bool viscous, added_mass, pressure_returns, lifts, dispersion;
  PressureModel model;
};

void PrintTo(const Combination& c, std::ostream* out) { *out << c.name; }  // NOLINT: GoogleTest's

const std::vector<Combination> combinations{
    {"drag_alone", false, false, false, false, false, PressureModel::a},
    {"viscous", true, false, false, false, false, PressureModel::a},
    {"added_mass", false, true, true, false, false, PressureModel::a},
    {"added_mass_of_model_b", false, true, false, false, false, PressureModel::b},
    {"lifts", false, false, false, true, false, PressureModel::a},
    {"dispersion", false, false, false, false, true, PressureModel::a},
    {"all", true, true, true, true, true, PressureModel::a},
};

using Case = std::tuple<VoidageMap, Combination>;

class Forces : public testing::TestWithParam<Case> {};

ExchangeSettings settings_of(const Combination& c) {
  ExchangeSettings settings;
  settings.fluid = {1000, 1e-3};
  settings.gravity = {0, 0, -9.81};
  settings.drag.law = DragLaw::gidaspow;
  settings.model = c.model;
  settings.pressure_gradient = c.model == PressureModel::a;
  settings.viscous = c.viscous;
  settings.added_mass = c.added_mass;
  settings.pressure_returns = c.pressure_returns;
  settings.saffman_lift = settings.magnus_lift = c.lifts;
  settings.turbulent_dispersion = c.dispersion;
  settings.crowding = Crowding::zuber;
  settings.threads = 2;
  return settings;
}

/// 60 spheres all over a box of one metre, moving and spinning; every seventh is fixed.
ParticleState cloud(double density, std::mt19937_64& random) {
  std::uniform_real_distribution<double> place(0.05, 0.95);
  std::uniform_real_distribution<double> speed(-1, 1);
  ParticleState particles;
  for (int i = 0; i < 60; ++i) {
    const bool fixed = i % 7 == 0;
    particles.id.push_back(i + 1);
    particles.position.emplace_back(place(random), place(random), place(random));
    particles.velocity.emplace_back(speed(random), speed(random), speed(random));
    if (fixed) particles.velocity.back().setZero();
    particles.spin.emplace_back(10 * speed(random), 10 * speed(random), 10 * speed(random));
    particles.radius.push_back(0.02 + 0.04 * place(random));
    particles.density.push_back(density * place(random));
    particles.fixed.push_back(fixed ? 1 : 0);
  }
  return particles;
}

void expect_momentum_exact(const ExchangeSettings& settings, const Mesh& mesh,
                           WeightsBuilder& builder, const ParticleState& particles,
                           const FluidSeen& before, const FluidSeen& answer, double window) {
  ParticleBulk bulk;
  measure_bulk(particles, bulk);
  Offer offer;
  offer.initial = false;
  offer.window = window;
  builder.build(particles, 1, offer.weights);
  std::vector<double> voidage(mesh.cell_volumes.size());
  ExcessFinder excess(mesh, 0.2);
  map_voidage(offer.weights, bulk.volume, mesh.cell_volumes, excess, 1, 2, voidage);
  OfferMaker maker;
  maker.make(settings, before, voidage, particles, bulk, {}, offer);
  std::vector<double> coefficient(voidage.size());
  std::vector<double> returned(voidage.size(), 0.0);
  std::vector<Vector3> source(voidage.size());
  deposit_offer(offer, 2, coefficient, source);
  if (settings.pressure_returns) deposit_returned(offer, 2, returned);
  WindowForces forces;
  window_forces(settings, offer, answer, particles, bulk, 2, window, forces);

  // What the coordinator sums up of the wire.
  Vector3 difference = Vector3::Zero();
  double scale = 0;
  for (int c = 0; c < mesh.cells(); ++c) {
    const Vector3 drag = coefficient[c] * answer.velocity[c];
    const Vector3 back = returned[c] * answer.pressure_gradient[c];
    Vector3 lost = -(source[c] - drag - back);
    if (settings.pressure_gradient)
      lost -= (1 - voidage[c]) * mesh.cell_volumes[c] * answer.pressure_gradient[c];
    difference += window * lost;
    scale += window * (source[c].norm() + drag.norm() + back.norm() + lost.norm());
  }
  double handed = 0;
  for (const Vector3& impulse : forces.impulse) {
    difference -= impulse;
    handed += impulse.norm();
  }
  // Sums of 60 particles and 120 cells of this scale, and 1 − ε of some 1e-2, known to 1e-16.
  EXPECT_LE(difference.norm(), 1e-13 * scale);
  EXPECT_GT(handed, 1e-4 * scale);
}

TEST_P(Forces, give_the_fluid_the_opposite_of_what_acts_on_the_particles) {
  const auto& [map, combination] = GetParam();
  const ExchangeSettings settings = settings_of(combination);
  const Mesh mesh = box({1, 1, 1}, {5, 4, 6}, {Axis::x});
  WeightsBuilder builder(mesh, map, 2);
  for (const double ratio : {0.1, 2.5, 1e5}) {
    std::mt19937_64 random(11);
    const ParticleState particles = cloud(1000 * ratio, random);
    const RandomFluid before(mesh.cells(), random);
    const RandomFluid answer(mesh.cells(), random);
    for (const double window : {1e-6, 1e-3, 1.0, 1e3}) {
      SCOPED_TRACE(testing::Message() << "density ratio " << ratio << ", window " << window);
      expect_momentum_exact(settings, mesh, builder, particles, before.seen(), answer.seen(),
                            window);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Everywhere, Forces,
                         testing::Combine(testing::Values(VoidageMap::exact, VoidageMap::centroid),
                                          testing::ValuesIn(combinations)),
                         [](const auto& test) {
                           return std::string(name_of(std::get<0>(test.param))) + "_" +
                                  std::get<1>(test.param).name;
                         });

/// One sphere in one cell of fluid, without walls and weight.
struct Pair {
  explicit Pair(double ratio) {
    std::mt19937_64 random(3);
    particles = cloud(0, random);
    for (auto* values : {&particles.position, &particles.velocity, &particles.spin})
      values->resize(1);
    particles.id.resize(1);
    particles.radius.assign(1, 0.05);
    particles.density.assign(1, 1000 * ratio);
    particles.fixed.clear();
    particles.position[0] = {0.5, 0.5, 0.5};
    particles.velocity[0] = Vector3::Zero();
    measure_bulk(particles, bulk);
    settings = settings_of(combinations[3]);
    settings.gravity.setZero();
    settings.buoyancy = false;
    settings.drag.law = DragLaw::stokes;
    settings.model = PressureModel::a;
    settings.pressure_gradient = false;
    settings.crowding = Crowding::none;
  }

  void map() {
    WeightsBuilder(mesh, VoidageMap::exact, 1).build(particles, 1, offer.weights);
    ExcessFinder excess(mesh, 0.2);
    map_voidage(offer.weights, bulk.volume, mesh.cell_volumes, excess, 1, 1, voidage);
  }
  void offer_window(double window, const FluidSeen& fluid) {
    offer.initial = false;
    offer.window = window;
    OfferMaker().make(settings, fluid, voidage, particles, bulk, {}, offer);
  }
  void move(double window, const FluidSeen& fluid) {
    WindowForces forces;
    window_forces(settings, offer, fluid, particles, bulk, 1, window, forces);
    particles.velocity[0] += window * (settings.gravity + forces.force[0] / bulk.mass[0]);
  }

  /// One window: offer, the fluid's own balance (mass `fluid_mass`), impulse.
  void advance(double window) {
    const std::vector<Vector3> none{Vector3::Zero()};
    const std::vector<Vector3> old{velocity};
    offer_window(window, {true, old, none, {}, none});
    std::vector<double> coefficient(1);
    std::vector<Vector3> source(1);
    deposit_offer(offer, 1, coefficient, source);
    velocity =
        (fluid_mass * velocity + window * source[0]) / (fluid_mass + window * coefficient[0]);
    const std::vector<Vector3> now{velocity};
    move(window, {true, now, none, {}, none});
  }

  Mesh mesh = box({1, 1, 1}, {1, 1, 1});
  ParticleState particles;
  ParticleBulk bulk;
  ExchangeSettings settings;
  Offer offer;
  std::vector<double> voidage{1};
  double fluid_mass = 1;  ///< [kg]
  Vector3 velocity{1, 0.5, 0};
};

TEST(AddedMass, brings_slip_down_as_the_closed_form_says_at_any_window_and_density) {
  for (const double ratio : {0.1, 1.0, 2.5, 1000.0, 1e5}) {
    for (const double over : {1e-3, 0.1, 1.0, 30.0, 1e4}) {  // Δt/τ
      for (const double share : {0.1, 10.0, 1e4}) {          // fluid over particle
        Pair pair(ratio);
        pair.map();
        const double mass = pair.bulk.mass[0];
        pair.fluid_mass = share * mass;
        const double zeta = stokes_drag({1, 0.1, 0}, pair.settings.fluid);
        const double window = over * mass / zeta;
        const double added = 0.5 * 1000 * pair.bulk.volume[0];
        const double inverse = 1 / mass + 1 / pair.fluid_mass;
        const double factor = (1 + inverse * added) / (1 + inverse * (added + zeta * window));
        const Vector3 momentum = pair.fluid_mass * pair.velocity;
        for (int i = 0; i < 3; ++i) {
          const Vector3 slip = pair.velocity - pair.particles.velocity[0];
          pair.advance(window);
          const Vector3 now = pair.velocity - pair.particles.velocity[0];
          // The difference of two speeds of 1 that agree in up to (1 + added mass/mass) digits.
          EXPECT_LE((now - factor * slip).norm(), 1e-14 * (1 + added / mass)) << ratio << over;
          EXPECT_GE(now.dot(slip), -1e-14);  // no overshoot
          const Vector3 total = pair.fluid_mass * pair.velocity + mass * pair.particles.velocity[0];
          EXPECT_LE((total - momentum).norm(), 1e-14 * (1 + added / mass) * momentum.norm());
        }
      }
    }
  }
}

TEST(Drag, brings_slip_down_as_the_closed_form_says_at_any_window_and_loading) {
  for (const double over : {1e-3, 0.03, 0.33, 1.0, 30.0, 1e4}) {  // Δt/τ
    for (const double share : {1e-3, 0.1, 10.0, 1e4}) {           // fluid over particle
      Pair pair(1000);
      pair.settings.added_mass = false;
      pair.map();
      const double mass = pair.bulk.mass[0];
      pair.fluid_mass = share * mass;
      const double window = over * mass / stokes_drag({1, 0.1, 0}, pair.settings.fluid);
      // The fluid answers by its end: s1 = u1 − v1 with v1 − v0 = B (u1 − v0).
      const double given = over / (1 + std::min(1.0, 0.5 + 1.5 * over) * over);
      const double factor = (1 - given) * share / (share + given);
      const Vector3 momentum = pair.fluid_mass * pair.velocity;
      for (int i = 0; i < 3; ++i) {
        const Vector3 slip = pair.velocity - pair.particles.velocity[0];
        pair.advance(window);
        const Vector3 now = pair.velocity - pair.particles.velocity[0];
        EXPECT_LE((now - factor * slip).norm(), 1e-14) << over << ' ' << share;
        EXPECT_GE(now.dot(slip), -1e-14);  // no overshoot
        const Vector3 total = pair.fluid_mass * pair.velocity + mass * pair.particles.velocity[0];
        EXPECT_LE((total - momentum).norm(), 1e-14 * momentum.norm());
      }
    }
  }
}

/// One sphere at `place`, in cells of 1 m.
struct InCubes {
  explicit InCubes(const Vector3& place, VoidageMap map = VoidageMap::exact) {
    particles.position[0] = place;
    WeightsBuilder(mesh, map, 1).build(particles, 1, weights);
  }
  double response(const FluidProperties& fluid, const Vector3& slip) const {
    return own.response(weights, 0, fluid, voidage, slip);
  }

  Mesh mesh = box({5, 5, 5}, {5, 5, 5});
  OwnDisturbance own{mesh};
  ParticleState particles = Pair(1).particles;
  ParticleCellWeights weights;
  std::vector<double> voidage = std::vector<double>(125, 1.0);
};

TEST(OwnDisturbance, of_one_cell_is_what_flow_and_viscosity_carry_out_of_it) {
  const InCubes cubes({2.5, 2.5, 2.5});
  const Vector3 slip(0.3, -0.4, 1.2);
  const double out = 1.2 * 1.9 + 6 * 0.7;  // ρ Σ|s_a| h² + 6 μ h
  EXPECT_NEAR(cubes.response({1.2, 0.7}, slip) * 1.5 * out, 1, 1e-14);
}

TEST(OwnDisturbance, of_cells_that_share_a_sphere_is_that_of_their_wake) {
  // Where flow rules the wake counts: not how long, but how wide what makes it is.
  const FluidProperties fluid{1.2, 1e-14};
  const Vector3 slip(0, 0, 1);
  const double centre = InCubes({2.5, 2.5, 2.5}).response(fluid, slip);
  EXPECT_NEAR(InCubes({2.5, 2.5, 2}).response(fluid, slip) / centre, 1, 1e-12);
  EXPECT_NEAR(InCubes({2, 2.5, 2.5}).response(fluid, slip) / centre, 0.5, 1e-12);
  EXPECT_NEAR(InCubes({2, 2, 2}).response(fluid, slip) / centre, 0.25, 1e-12);
  // Against the flow it is the same.
  EXPECT_NEAR(InCubes({2.5, 2.5, 2}).response(fluid, -slip) / centre, 1, 1e-12);
  // Viscosity: half of each cell's faces but one lead out of the two.
  const FluidProperties oil{1.2, 1e14};
  EXPECT_NEAR(
      InCubes({2, 2.5, 2.5}).response(oil, slip) / InCubes({2.5, 2.5, 2.5}).response(oil, slip),
      0.5 * 6 / 5, 1e-12);
}

TEST(OwnDisturbance, gives_the_drag_of_the_flow_without_it) {
  for (const double viscosity : {1e-3, 0.3}) {
    Pair pair(1000);
    pair.settings.added_mass = false;
    pair.settings.mobile = false;
    pair.settings.drag.law = DragLaw::schiller_naumann;
    pair.settings.fluid = {1.2, viscosity};
    const OwnDisturbance own(pair.mesh);
    pair.settings.own = &own;
    pair.map();
    const std::vector<Vector3> none{Vector3::Zero()}, stream{pair.velocity};
    pair.offer_window(1e-3, {true, stream, none, {}, none});
    const double seen = pair.velocity.norm();
    const double force = pair.offer.coefficient[0] * seen;
    const double slip = seen + force * own.response(pair.offer.weights, 0, pair.settings.fluid,
                                                    pair.voidage, pair.velocity);
    EXPECT_GT(slip, 1.001 * seen);
    const double zeta = schiller_naumann_drag({pair.voidage[0], 0.1, slip}, pair.settings.fluid);
    EXPECT_NEAR(force / (zeta * slip), 1, 1e-13) << viscosity;
  }
}

/// Whether the offer of a sphere of that radius, in cells of 1 m of that voidage, is made.
bool is_corrected(double radius, double voidage) {
  Pair pair(1000);
  pair.particles.radius[0] = radius;
  measure_bulk(pair.particles, pair.bulk);
  pair.settings.added_mass = false;
  pair.settings.drag.law = DragLaw::wen_yu;
  pair.settings.fluid = {1.2, 1e3};
  const OwnDisturbance own(pair.mesh);
  pair.settings.own = &own;
  pair.map();
  pair.voidage[0] = voidage;
  const std::vector<Vector3> none{Vector3::Zero()}, stream{pair.velocity};
  try {
    pair.offer_window(1e-3, {true, stream, none, {}, none});
    return true;
  } catch (const NumericsError& error) {
    EXPECT_NE(std::string(error.what()).find("self_disturbance: corrected: particle 1 at"),
              std::string::npos)
        << error.what();
    return false;
  }
}

TEST(OwnDisturbance, is_refused_in_small_cells_and_where_it_hides_most_of_the_slip) {
  EXPECT_TRUE(is_corrected(0.1, 1));     // cells of 5 d; it hides 21 % of the slip
  EXPECT_FALSE(is_corrected(0.11, 1));   // of 4.5 d
  EXPECT_FALSE(is_corrected(0.1, 0.5));  // ε^-3.65 times the drag
}

/// A uniform suspension through which a given flux goes: one sphere in one cell where u = 0, and ∇p
/// is what that takes. Returns the largest |v| over 400 windows, from v = 1.
double largest_speed(double solids, double over, double ratio, bool eliminated,
                     bool added_mass = true) {
  Pair pair(ratio);
  pair.settings.added_mass = added_mass;
  pair.particles.radius[0] = std::cbrt(0.75 * solids / std::numbers::pi);  // in 1 m³
  measure_bulk(pair.particles, pair.bulk);
  pair.particles.velocity[0] = {1, 0, 0};
  pair.settings.pressure_gradient = true;
  pair.settings.pressure_returns = eliminated;
  const double window = 1;
  pair.settings.fluid.viscosity =
      over * pair.bulk.mass[0] / (3 * std::numbers::pi * 2 * pair.particles.radius[0] * window);
  const std::vector<Vector3> still{Vector3::Zero()};
  std::vector<Vector3> gradient{Vector3::Zero()};
  pair.map();
  double largest = 0;
  for (int i = 0; i < 400; ++i) {
    pair.offer_window(window, {true, still, gradient, {}, still});
    std::vector<double> coefficient(1);
    std::vector<double> returned(1, 0.0);
    std::vector<Vector3> source(1);
    deposit_offer(pair.offer, 1, coefficient, source);
    if (eliminated) deposit_returned(pair.offer, 1, returned);
    gradient[0] = source[0] / (pair.voidage[0] + returned[0]);  // (ε V + A) ∇p = S − B u
    pair.move(window, {true, still, gradient, {}, still});
    largest = std::max(largest, pair.particles.velocity[0].norm());
  }
  return largest;
}

TEST(Drag, is_stable_beside_a_lagged_pressure_gradient_as_far_as_that_of_the_end_alone) {
  // B (1 + 2 φ) < 2 ε with B = b/(1 + b).
  for (const double solids : {0.1, 0.3, 0.4, 0.5}) {
    const double room = 3 - 4 * (1 - solids);
    const double limit = room > 0 ? 2 * (1 - solids) / room : 1e5;
    for (const double over : {1e-3, 0.03, 0.1, 0.2, 0.3, 0.34, 0.5, 0.97 * limit}) {
      EXPECT_LE(largest_speed(solids, over, 1000, false, false), 1) << solids << ' ' << over;
    }
    if (room > 0) {
      EXPECT_GT(largest_speed(solids, 1.1 * limit, 1000, false, false), 10) << solids;
    }
  }
}

TEST(PressureReturn, solves_the_whole_equation_of_motion_with_the_gradient_of_the_answer) {
  for (const double window : {1e-4, 1.0, 1e3}) {
    Pair pair(2.5);
    pair.settings.gravity = {0, 0, -9.81};
    pair.settings.buoyancy = true;
    pair.settings.pressure_gradient = true;
    pair.settings.pressure_returns = true;
    pair.settings.fluid.viscosity = 10;
    const Vector3 v0(0.1, 0.2, -0.3);
    pair.particles.velocity[0] = v0;
    const std::vector<Vector3> u0{{1, -0.5, 0.2}}, u1{{0.7, 0.1, 0.9}};
    const std::vector<Vector3> wrong{{1e6, 1e6, 1e6}}, gradient{{3000, -500, 1e4}};
    const std::vector<Vector3> convective{{2, 0, -1}};
    pair.map();
    pair.offer_window(window, {true, u0, wrong, {}, convective});
    pair.move(window, {true, u1, gradient, {}, convective});
    const Vector3 v1 = pair.particles.velocity[0];
    const double volume = pair.bulk.volume[0];
    const double added = 500 * volume;
    const double zeta = 3 * std::numbers::pi * 10 * 0.1;
    const Vector3 forces = zeta * (u1[0] - v1) + 1500 * volume * pair.settings.gravity -
                           volume * gradient[0] +
                           added * ((u1[0] - u0[0]) / window + convective[0] - (v1 - v0) / window);
    const Vector3 inertia = pair.bulk.mass[0] * (v1 - v0) / window;
    // Weight, pressure and drag of the whole window cancel in v1.
    const double free = window * (9.81 + gradient[0].norm() / 2500) + v0.norm();
    const double scale = (zeta + added / window) * free + volume * gradient[0].norm();
    EXPECT_LE((inertia - forces).norm(), 1e-14 * scale) << window;
  }
}

TEST(PressureReturn, keeps_dense_suspensions_stable_that_a_lagged_gradient_does_not) {
  for (const double solids : {0.05, 0.3, 0.5}) {
    for (const double over : {1e-3, 1.0, 1e4}) {
      for (const double ratio : {0.1, 2.5, 1000.0})
        EXPECT_LE(largest_speed(solids, over, ratio, true), 1) << solids << over << ratio;
    }
  }
  // The stability limit of the header: B + 2 φ β < 2 ε.
  EXPECT_GT(largest_speed(0.4, 100, 2.5, false), 1e6);
  EXPECT_LE(largest_speed(0.2, 100, 2.5, false), 2);
}

}  // namespace
}  // namespace fluxpact
