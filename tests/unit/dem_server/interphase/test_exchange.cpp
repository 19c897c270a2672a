#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "boxes.hpp"
#include "dem_server/interphase/prediction.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

using testing_boxes::box;

/// A cloud in a box with the offer of its end, and a fluid that answers.
class Exchange : public testing::Test {
 protected:
  Exchange() {
    std::mt19937_64 random(9);
    std::uniform_real_distribution<double> place(0.05, 0.95);
    std::uniform_real_distribution<double> speed(-1, 1);
    for (int i = 0; i < 100; ++i) {
      particles.id.push_back(i + 1);
      particles.position.emplace_back(place(random), place(random), place(random));
      particles.velocity.emplace_back(speed(random), speed(random), speed(random));
      particles.radius.push_back(0.02 + 0.03 * place(random));
      particles.density.push_back(2000 + 500 * speed(random));
    }
    for (int c = 0; c < mesh.cells(); ++c) {
      velocity.emplace_back(speed(random), speed(random), 3 + speed(random));
      gradient.emplace_back(10 * speed(random), 10 * speed(random), -50 + speed(random));
    }
    settings.fluid = {1.2, 1.8e-5};
    settings.gravity = {0, 0, -9.81};
    settings.drag.law = DragLaw::gidaspow;
    settings.threads = 2;
    measure_bulk(particles, bulk);
    voidage.resize(mesh.cell_volumes.size());
  }

  void make_offer(double window, const Prediction& past = {}) {
    builder.build(particles, 1, offer.weights);
    map_voidage(offer.weights, bulk.volume, mesh.cell_volumes, excess, 1, 1, voidage);
    offer.window = window;
    maker.make(settings, fluid(), voidage, particles, bulk, past, offer);
  }
  FluidSeen fluid() const { return {true, velocity, gradient}; }

  /// Drag coefficient of particle i at the current state, computed one by one.
  double zeta(int i) const {
    const Vector3 u =
        offer.weights.gather(i, std::span<const Vector3>(velocity), Vector3(Vector3::Zero()));
    const double e = offer.weights.gather(i, std::span<const double>(voidage), 0.0);
    return gidaspow_drag({e, 2 * particles.radius[i], (u - particles.velocity[i]).norm()},
                         settings.fluid);
  }

  Mesh mesh = box({1, 1, 1}, {5, 4, 6}, {Axis::x});
  WeightsBuilder builder{mesh, VoidageMap::exact, 2};
  ExcessFinder excess{mesh, VoidageSettings().smallest};
  ParticleState particles;
  ParticleBulk bulk;
  std::vector<Vector3> velocity;
  std::vector<Vector3> gradient;
  std::vector<double> voidage;
  ExchangeSettings settings;
  Offer offer;
  OfferMaker maker;
  WindowForces forces;
};

TEST_F(Exchange, offers_the_drag_of_the_start_and_the_end_of_a_flight) {
  const Vector3 none = Vector3::Zero();
  for (const double window : {1e-4, 0.02, 1.0, 1e4}) {
    make_offer(window);
    window_forces(settings, offer, fluid(), particles, bulk, 1, window, forces);
    for (int i = 0; i < particles.size(); ++i) {
      const double b = zeta(i) * window / bulk.mass[i];
      const double end = std::min(1.0, 0.5 + 1.5 * b);  // half and half, or Euler's implicit rule
      const Vector3 u = offer.weights.gather(i, std::span<const Vector3>(velocity), none);
      const Vector3 pressure = offer.weights.gather(i, std::span<const Vector3>(gradient), none);
      const Vector3 fall =
          settings.gravity * (1 - 1.2 / particles.density[i]) - pressure / particles.density[i];
      // No window before: nothing is known of contacts, so the particle flies freely.
      const Vector3& v0 = particles.velocity[i];
      const Vector3 impulse = forces.drag_impulse[i];
      const Vector3 v1 = v0 + window * fall + impulse / bulk.mass[i];
      const Vector3 drag = window * zeta(i) * (u - end * v1 - (1 - end) * v0);
      // v1 is a difference of terms of the size of fall and drag, and b of them come back.
      const double size = bulk.mass[i] * (1 + b) * (window * fall.norm() + u.norm() + v0.norm());
      EXPECT_LE((impulse - drag).norm(), 1e-14 * size) << window << ' ' << b;
    }
  }
}

TEST_F(Exchange, gives_the_particles_what_the_fluid_loses) {
  for (const double window : {1e-5, 1e-2, 10.0}) {
    make_offer(window);
    std::vector<double> coefficient(mesh.cell_volumes.size());
    std::vector<Vector3> source(mesh.cell_volumes.size());
    deposit_offer(offer, 2, coefficient, source);
    for (Vector3& u : velocity) u *= 1.3;  // the fluid's answer is another velocity
    window_forces(settings, offer, fluid(), particles, bulk, 2, window, forces);
    Vector3 to_fluid = Vector3::Zero();
    double scale = 0;
    for (int c = 0; c < mesh.cells(); ++c) {
      to_fluid += window * (source[c] - coefficient[c] * velocity[c]);
      scale += window * coefficient[c] * velocity[c].norm();
    }
    Vector3 to_particles = Vector3::Zero();
    for (const Vector3& impulse : forces.drag_impulse) to_particles += impulse;
    // Sums of some hundred terms of this scale.
    EXPECT_LE((to_fluid + to_particles).norm(), 1e-13 * scale);
    EXPECT_GT(to_particles.norm(), 1e-3 * scale);
  }
}

TEST_F(Exchange, remembers_the_window_before_by_row_while_particles_come_and_go) {
  const double window = 0.02;
  make_offer(window);
  window_forces(settings, offer, fluid(), particles, bulk, 1, window, forces);
  // Half of the load was carried, by each in its own measure.
  std::vector<Vector3> before;
  for (int i = 0; i < particles.size(); ++i) {
    const Vector3 load = settings.gravity + forces.force[i] / bulk.mass[i];
    before.push_back(particles.velocity[i] - window * load * (0.3 + 0.005 * i));
  }
  make_offer(window);
  const Offer free_flight = offer;
  make_offer(window, {before, window, &forces, {}});
  const Offer all = offer;
  // The same particles, but the window before is known in other rows, and of one not at all.
  std::vector<int> row_before;
  std::vector<Vector3> shuffled(before.size());
  WindowForces moved = forces;
  for (int i = 0; i < particles.size(); ++i) {
    row_before.push_back((i + 7) % particles.size());
    shuffled[row_before[i]] = before[i];
    moved.force[row_before[i]] = forces.force[i];
    moved.drag_impulse[row_before[i]] = forces.drag_impulse[i];
  }
  row_before[42] = -1;
  make_offer(window, {shuffled, window, &moved, row_before});
  for (int i = 0; i < particles.size(); ++i) {
    EXPECT_EQ(offer.velocity[i], (i == 42 ? free_flight : all).velocity[i]) << i;
    EXPECT_NE(all.velocity[i], free_flight.velocity[i]);
  }
}

TEST_F(Exchange, deposits_every_impulse_once) {
  make_offer(0.01);
  window_forces(settings, offer, fluid(), particles, bulk, 2, 0.01, forces);
  std::vector<Vector3> given(mesh.cell_volumes.size());
  deposit_vectors(offer.weights, forces.impulse, 2, given);
  Vector3 difference = Vector3::Zero();
  double scale = 0;
  for (const Vector3& impulse : forces.impulse) {
    difference += impulse;
    scale += impulse.norm();
  }
  for (const Vector3& impulse : given) difference -= impulse;
  EXPECT_LE(difference.norm(), 100 * 2e-16 * scale);
}

TEST_F(Exchange, makes_the_force_of_drag_pressure_and_buoyancy) {
  make_offer(0.01);
  offer.initial = false;
  // A window of another length: the impulse of drag stays that of the fluid's own step.
  window_forces(settings, offer, fluid(), particles, bulk, 2, 0.04, forces);
  offer.initial = true;
  WindowForces first;
  window_forces(settings, offer, fluid(), particles, bulk, 1, 0.01, first);
  for (int i = 0; i < particles.size(); ++i) {
    const Vector3 zero = Vector3::Zero();
    const Vector3 u = offer.weights.gather(i, std::span<const Vector3>(velocity), zero);
    const Vector3 pressure =
        -bulk.volume[i] * offer.weights.gather(i, std::span<const Vector3>(gradient), zero);
    const Vector3 drag = 0.01 * offer.coefficient[i] * (u - offer.velocity[i]);
    const Vector3 buoyancy = -1.2 * bulk.volume[i] * settings.gravity;
    const double scale = pressure.norm() + drag.norm() / 0.04;
    EXPECT_LE((forces.drag_impulse[i] - drag).norm(), 1e-15 * drag.norm());
    EXPECT_LE((forces.force[i] - drag / 0.04 - pressure - buoyancy).norm(), 1e-14 * scale);
    EXPECT_LE((forces.impulse[i] - drag - 0.04 * pressure).norm(), 1e-14 * scale);
    EXPECT_EQ(first.impulse[i], first.drag_impulse[i]);  // no pressure is known yet
    EXPECT_GT(pressure.norm(), 0);
  }
}

TEST_F(Exchange, leaves_pressure_and_buoyancy_out_when_they_are_off) {
  settings.pressure_gradient = false;
  settings.buoyancy = false;
  make_offer(0.01);
  window_forces(settings, offer, fluid(), particles, bulk, 2, 0.01, forces);
  for (int i = 0; i < particles.size(); ++i) {
    EXPECT_EQ(forces.impulse[i], forces.drag_impulse[i]);
    // Two roundings against one.
    EXPECT_LE((forces.force[i] - forces.drag_impulse[i] / 0.01).norm(),
              4e-16 * forces.force[i].norm());
    const double b = zeta(i) * 0.01 / bulk.mass[i];
    const Vector3 fall = std::min(1.0, 0.5 + 1.5 * b) * 0.01 * settings.gravity;
    EXPECT_LE((offer.velocity[i] - particles.velocity[i] - fall).norm(), 1e-14);
  }
}

TEST_F(Exchange, acts_with_buoyancy_only_before_the_first_fluid_step) {
  make_offer(0.01);
  FluidSeen unsolved = fluid();
  unsolved.solved = false;
  window_forces(settings, offer, unsolved, particles, bulk, 1, 0.01, forces);
  for (int i = 0; i < particles.size(); ++i) {
    EXPECT_EQ(forces.drag_impulse[i], Vector3(0, 0, 0));
    EXPECT_EQ(forces.impulse[i], Vector3(0, 0, 0));
    EXPECT_EQ(forces.force[i], Vector3(-(1.2 * bulk.volume[i]) * settings.gravity));
  }
}

TEST_F(Exchange, takes_particles_that_cannot_move_as_infinitely_heavy) {
  settings.mobile = false;
  make_offer(0.01);
  for (int i = 0; i < particles.size(); ++i) {
    EXPECT_EQ(offer.velocity[i], particles.velocity[i]);
    EXPECT_NEAR(offer.coefficient[i], zeta(i), 1e-14 * zeta(i));
  }
}

TEST_F(Exchange, takes_fixed_particles_as_infinitely_heavy_and_no_others) {
  make_offer(0.01);
  const Offer all_free = offer;
  particles.fixed.assign(particles.id.size(), 0);
  for (int i = 0; i < particles.size(); i += 3) {
    particles.fixed[i] = 1;
  }
  make_offer(0.01);
  for (int i = 0; i < particles.size(); ++i) {
    if (!particles.is_fixed(i)) {
      EXPECT_EQ(offer.velocity[i], all_free.velocity[i]);
      EXPECT_EQ(offer.coefficient[i], all_free.coefficient[i]);
      continue;
    }
    EXPECT_EQ(offer.velocity[i], particles.velocity[i]);
    EXPECT_NEAR(offer.coefficient[i], zeta(i), 1e-14 * zeta(i));
    EXPECT_GT(offer.coefficient[i], all_free.coefficient[i]);
  }
}

TEST_F(Exchange, expects_contacts_to_carry_what_they_carried) {
  const double window = 0.01;
  settings.drag.law = DragLaw::none;
  make_offer(window);
  std::ranges::fill(gradient, Vector3(0, 0, 0));
  window_forces(settings, offer, fluid(), particles, bulk, 2, window, forces);
  const std::vector<Vector3> before = particles.velocity;
  const auto load = [&](int i) {
    return Vector3(settings.gravity * (1 - 1.2 / particles.density[i]));
  };
  // By turns: contacts carried nothing, all, a quarter, and more than all (a bounce).
  const std::array<double, 4> shares{0, 1, 0.25, 3};
  for (int i = 0; i < particles.size(); ++i) {
    particles.velocity[i] = before[i] + window * (1 - shares[i % 4]) * load(i);
  }
  make_offer(window, {before, window, &forces});
  for (int i = 0; i < particles.size(); ++i) {
    const double carried = std::min(shares[i % 4], 1.0);
    // Half of the window's start, half of its end: there is no drag.
    const Vector3 expected = particles.velocity[i] + 0.5 * window * (1 - carried) * load(i);
    // The share comes from a difference of velocities of the order 1 over a change of 0.1.
    EXPECT_LE((offer.velocity[i] - expected).norm(), 1e-15 + 1e-14) << i;
  }
}

TEST_F(Exchange, refuses_a_force_that_is_not_finite_and_names_the_particle) {
  make_offer(0.01);
  const int cell = offer.weights.row_cells[offer.weights.row_offsets[40]];
  velocity[cell].y() = std::numeric_limits<double>::quiet_NaN();
  int first = 0;
  for (; first < particles.size(); ++first) {
    const auto begin = offer.weights.row_cells.begin() + offer.weights.row_offsets[first];
    const auto end = offer.weights.row_cells.begin() + offer.weights.row_offsets[first + 1];
    if (std::find(begin, end, cell) != end) break;
  }
  try {
    window_forces(settings, offer, fluid(), particles, bulk, 5, 0.01, forces);
    FAIL() << "accepted";
  } catch (const NumericsError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("particle " + std::to_string(first + 1) + " "), std::string::npos) << text;
    EXPECT_NE(text.find("step 5"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace fluxpact
