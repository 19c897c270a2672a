// Hertz' law in flight: impacts against closed forms, restitution, and where energy goes.
#include <cmath>
#include <numbers>

#include "tests/unit/dem_server/native/one_contact.hpp"

namespace fluxpact {
namespace {

ParticleSettings solid(double modulus, double nu, double e, double mu) {
  return with(elastic(modulus, nu), [&](PairSettings& pair) {
    pair.restitution = e;
    pair.friction = mu;
  });
}

Ball ball(double radius, double density, const Vector3& x, const Vector3& v) {
  Ball one;
  one.x = x;
  one.v = v;
  one.radius = radius;
  one.mass = 4.0 / 3 * std::numbers::pi * radius * radius * radius * density;
  return one;
}

struct Impact {
  double force, overlap, duration;
};

/// Runs until the surfaces part.
Impact impact(Flight& flight, double dt) {
  double deepest = 0;
  double before = flight.overlap;
  double start = 0;
  for (int i = 1;; ++i) {
    flight.step(dt);
    deepest = std::max(deepest, flight.overlap);
    // Zero overlap within a step, by a straight line.
    const double crossing = (i - 1 + before / (before - flight.overlap)) * dt;
    if (before <= 0 && flight.overlap > 0) start = crossing;
    if (before > 0 && flight.overlap <= 0) {
      return {flight.largest_push, deepest, crossing - start};
    }
    before = flight.overlap;
  }
}

/// Elastic sphere of m* and R* meets another at `speed` (Johnson, Contact Mechanics, 11.4).
Impact closed_form(double modulus, double nu, double mass, double radius, double speed) {
  const double effective = modulus / (2 * (1 - nu * nu));
  const double overlap =
      std::pow(15 * mass * speed * speed / (16 * effective * std::sqrt(radius)), 0.4);
  // 2 ∫ dx / sqrt(1 - x^(5/2)) from 0 to 1 = 4/5 sqrt(π) Γ(2/5) / Γ(9/10)
  const double integral = 0.8 * std::sqrt(std::numbers::pi) * std::tgamma(0.4) / std::tgamma(0.9);
  return {4.0 / 3 * effective * std::sqrt(radius) * std::pow(overlap, 1.5), overlap,
          integral * overlap / speed};
}

struct Solid {
  double modulus, nu, density;
  double force, overlap, duration;  // as published for this impact
};

TEST(HertzImpact, of_two_equal_spheres_is_that_of_hertz) {
  // Chung & Ooi (2011), test 1: glass and limestone, 10 m/s each.
  for (const Solid& is : {Solid{4.8e10, 0.2, 2800, 10697, 274.11e-6, 40.34e-6},
                          Solid{2e10, 0.25, 2500, 7108.2, 368.30e-6, 54.20e-6}}) {
    const double r = 0.01;
    Flight flight(solid(is.modulus, is.nu, 1, 0),
                  {ball(r, is.density, {0, 0, r + 1e-7}, {0, 0, -10}),
                   ball(r, is.density, {0, 0, -r - 1e-7}, {0, 0, 10})});
    const Impact seen = impact(flight, 2e-8);
    const Impact exact = closed_form(is.modulus, is.nu, 0.5 * flight.balls[0].mass, 0.5 * r, 20);
    // Verlet with 2000 steps: the square of a step over the time of contact (2.5e-7) and the sample
    // nearest to the deepest point.
    EXPECT_NEAR(seen.force / exact.force, 1, 2e-6);
    EXPECT_NEAR(seen.overlap / exact.overlap, 1, 2e-6);
    EXPECT_NEAR(seen.duration / exact.duration, 1, 2e-5);
    EXPECT_NEAR(seen.force / is.force, 1, 1e-4);
    EXPECT_NEAR(seen.overlap / is.overlap, 1, 1e-4);
    EXPECT_NEAR(seen.duration / is.duration, 1, 2e-4);
    EXPECT_NEAR(flight.balls[0].v.z(), 10, 1e-5);
  }
}

TEST(HertzImpact, on_a_much_stiffer_wall_is_that_of_hertz) {
  // Chung & Ooi (2011), test 2, with a plane a thousand times stiffer: aluminium, magnesium alloy.
  for (const Solid& is : {Solid{7e10, 0.3, 2699, 11365, 49.737e-6, 731.6e-6},
                          Solid{4e10, 0.35, 1800, 7229.8, 52.144e-6, 767.0e-6}}) {
    const double r = 0.1;
    ParticleSettings settings = solid(is.modulus, is.nu, 1, 0);
    settings.contact.walls->youngs_modulus *= 1000;
    Flight flight(settings, {ball(r, is.density, {0, 0, r + 1e-8}, {0, 0, -0.2})});
    const Impact seen = impact(flight, 5e-7);
    EXPECT_NEAR(seen.force / is.force, 1, 1e-4);
    EXPECT_NEAR(seen.overlap / is.overlap, 1, 1e-4);
    EXPECT_NEAR(seen.duration / is.duration, 1, 1e-3);  // published for a rigid plane: 2/5 of 1e-3
  }
}

/// Rebound over approach of a frictionless impact on the wall at `speed`, in steps of the time of
/// contact over `steps`.
double rebound(double e, double speed, int steps) {
  const double r = 1e-3;
  const Ball start = ball(r, 2500, {0, 0, r}, {0, 0, -speed});
  Flight flight(solid(5e6, 0.3, e, 0), {start});
  const double dt = closed_form(5e6, 0.3, start.mass, r, speed).duration / steps;
  impact(flight, dt);
  return flight.balls[0].v.z() / speed;
}

TEST(HertzImpact, rebounds_with_the_restitution_at_any_speed) {
  for (const double e : {0.1, 0.2, 0.3, 0.5, 0.7, 0.9, 0.99, 1.0}) {
    for (const double speed : {0.01, 1.0}) {
      // The dashpot sees a velocity half a step old: an error in proportion to the step, which two
      // steps remove. What is left is of higher order; the last step of a strongly damped contact
      // ends at random within it.
      const double coarse = rebound(e, speed, 1000);
      const double fine = rebound(e, speed, 2000);
      EXPECT_NEAR(fine, e, 2e-3) << e << ' ' << speed;
      EXPECT_NEAR(2 * fine - coarse, e, 3e-4) << e << ' ' << speed;
    }
  }
}

/// Aluminium oxide on aluminium alloy at 3.9 m/s, `angle` from the normal (Chung & Ooi 2011, test
/// 4).
Flight oblique(double angle, double e, double mu, int steps, double* dt) {
  const double r = 0.0025;
  const double speed = 3.9;
  ParticleSettings settings = solid(3.8e11, 0.23, e, mu);
  settings.contact.walls = WallMaterialSettings{7e10, 0.33};
  const Ball start =
      ball(r, 4000, {0, 0, r}, {speed * std::sin(angle), 0, -speed * std::cos(angle)});
  // Contact with the softer solid alone is longer.
  *dt = closed_form(7e10, 0.33, start.mass, r, speed * std::cos(angle)).duration / steps;
  return Flight(settings, {start});
}

TEST(HertzImpact, that_slides_throughout_takes_the_impulse_of_coulomb) {
  struct Published {
    double degrees, ratio, spin;
  };
  for (const Published& is : {Published{45, 0.81784, 502.35}, Published{60, 0.89483, 355.21}}) {
    const double angle = is.degrees * std::numbers::pi / 180;
    double dt = 0;
    Flight flight = oblique(angle, 0.98, 0.092, 4000, &dt);
    impact(flight, dt);
    // The impulse is μ (1 + e) m v_n, exact but for the short attraction at the end, where |F_n|
    // counts twice: of the order of ζ² = 4e-5.
    const double loss = 1 - flight.balls[0].v.x() / (3.9 * std::sin(angle));
    EXPECT_NEAR(loss / (1 - is.ratio), 1, 2e-4) << is.degrees;
    EXPECT_NEAR(flight.balls[0].w.y() / is.spin, 1, 2e-4) << is.degrees;
  }
}

TEST(HertzImpact, with_friction_creates_no_energy) {
  for (const double mu : {0.1, 0.5, 100.0}) {
    for (int degrees = 5; degrees < 90; degrees += 5) {
      double dt = 0;
      Flight flight = oblique(degrees * std::numbers::pi / 180, 1.0, mu, 500, &dt);
      const double before = flight.energy();
      impact(flight, dt);
      // Verlet's error in energy: a few times (2 π / 1000)².
      EXPECT_LT(flight.energy(), before * (1 + 1e-4)) << mu << ' ' << degrees;
    }
  }
}

/// A contact that is pressed to `overlap` and sheared by `shift` in small steps, without friction's
/// limit. The tangential force on the particle after that.
class Press {
 public:
  explicit Press(const ParticleSettings& settings)
      : laws_(settings), table_(law_table<double>(laws_)) {
    touch_.inverse_radius = 1e3;
  }
  /// Returns the work [J] of the contact on the particle.
  double move(double overlap, double shift) {
    constexpr int steps = 2000;
    constexpr double dt = 1e-9;
    const double sink = (overlap - touch_.overlap) / steps;
    double work = 0;
    touch_.velocity = Vector3(shift / steps / dt, 0, -sink / dt);
    for (int i = 0; i < steps; ++i) {
      const Vector3 before = force_;
      touch_.overlap += sink;
      const Pushed pushed = push(table_, laws_.index(0, laws_.walls()), touch_, springs_, dt);
      springs_ = pushed.springs;
      force_ = pushed.force;
      work += 0.5 * (before + force_).dot(dt * touch_.velocity);
    }
    return work;
  }
  double shear() const { return force_.x(); }

 private:
  ContactLaws laws_;
  LawTable<double> table_;
  Touch touch_;
  Springs springs_;
  Vector3 force_{0, 0, 0};
};

TEST(HertzFriction, keeps_its_force_when_pressed_and_loses_it_with_the_area) {
  const ParticleSettings settings = solid(5e6, 0.3, 1, 1e6);
  const double stiffness = 8 * 5e6 / (4 * 1.7 * 1.3) * std::sqrt(1e-3);  // S_t over sqrt(δ)
  Press press(settings);
  press.move(4e-6, 0);
  press.move(4e-6, 1e-7);
  const double sheared = -stiffness * std::sqrt(4e-6) * 1e-7;
  EXPECT_NEAR(press.shear() / sheared, 1, 1e-10);
  press.move(16e-6, 0);
  EXPECT_NEAR(press.shear() / sheared, 1, 1e-10);
  press.move(9e-6, 0);
  EXPECT_NEAR(press.shear() / sheared, 0.75, 1e-10);
  press.move(1e-6, 0);
  EXPECT_NEAR(press.shear() / sheared, 0.25, 1e-10);
}

TEST(HertzFriction, gives_no_work_in_a_cycle) {
  // Press, shear, press more, shear back, and the other order, with and without lifting off: around
  // each closed path the contact must not have given work. Its springs alone would give 1e-10 J.
  for (const double start : {1e-6, 4e-6}) {
    for (const double pressed : {4e-6, 16e-6}) {
      for (const int order : {0, 1}) {
        Press press(solid(5e6, 0.3, 1, 1e6));
        press.move(start, 0);
        const double first = order == 0 ? start : pressed;
        const double second = order == 0 ? pressed : start;
        double work = press.move(first, 0);
        work += press.move(first, 1e-6);
        work += press.move(second, 0);
        work += press.move(second, -1e-6);
        work += press.move(start, 0);
        EXPECT_LT(work, 1e-15) << start << ' ' << pressed << ' ' << order;
      }
    }
  }
}

}  // namespace
}  // namespace fluxpact
