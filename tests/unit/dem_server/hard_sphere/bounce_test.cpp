// A few spheres whose every collision is known: bounces under gravity, collisions at closed-form
// times under forces, chains, images, fixed spheres.
#include <cmath>

#include "tests/unit/dem_server/hard_sphere/hard_spheres_in_a_box.hpp"

namespace fluxpact {
namespace {

constexpr double g = 9.81;
constexpr double eps = 2.3e-16;

/// A ball that falls from rest and bounces, all its collisions by their closed form.
struct BouncingBall {
  double height, e;  ///< of its lowest point at first [m]

  double at(double t) const {
    double fall = std::sqrt(2 * height / g);  // half a flight
    double speed = std::sqrt(2 * g * height);
    if (t <= fall) return height - 0.5 * g * t * t;
    double since = t - fall;
    while (true) {
      speed *= e;
      if (since <= 2 * speed / g) return speed * since - 0.5 * g * since * since;
      since -= 2 * speed / g;
    }
  }
  double comes_to_rest() const { return std::sqrt(2 * height / g) * (1 + e) / (1 - e); }
};

TEST(Bounce, follows_the_closed_form_from_bounce_to_bounce) {
  const double radius = 0.1;
  for (const double e : {1.0, 0.9, 0.6}) {
    Scene scene = box_scene({1, 1, 1});
    scene.scene.gravity = {0, 0, -g};
    add_collisions(scene, e, 0.3);
    ParticleState state;
    const BouncingBall ball{0.4, e};
    add_sphere(state, {0.5, 0.5, radius + ball.height}, Vector3::Zero(), radius);
    const auto engine = make_hard(scene, state);
    // Up to the guard: the time between bounces is 1 ms and more, and a contact stands for 10 us.
    const double end = e < 1 ? ball.comes_to_rest() - 1e-3 / (1 - e) : 3.0;
    const int windows = static_cast<int>(end / 1e-3);
    double worst = 0;
    for (int window = 1; window <= windows; ++window) {
      run(*engine, 1e-3, 1e-5);
      worst = std::max(
          worst, std::abs(engine->particles().position[0].z() - radius - ball.at(window * 1e-3)));
    }
    // Each window adds a few roundings of the height and of the speed, which a bounce hands on; the
    // times of the bounces sum up theirs.
    EXPECT_LT(worst, 20 * windows * eps) << e;
  }
}

TEST(Bounce, comes_to_rest_without_endless_collisions) {
  const double radius = 0.1;
  const double contact_time = 1e-5;
  Scene scene = box_scene({1, 1, 1});
  scene.scene.gravity = {0, 0, -g};
  add_collisions(scene, 0.6, 0.3);
  ParticleState state;
  add_sphere(state, {0.5, 0.5, radius + 0.1}, {0.2, 0, 0}, radius);
  state.spin[0] = {0, 2, 0};  // rolls: what would slip has been rubbed away before it rests
  const auto engine = make_hard(scene, state);
  run(*engine, 1.0, contact_time);
  const std::int64_t before = engine->counters().collisions;
  for (int window = 0; window < 20; ++window) {
    run(*engine, 1e-3, contact_time);
    // It hops as long as a contact lasts, or as the memory of the collisions of late does: 8 times
    // that. Both are nothing against its size.
    const double hop = 8 * contact_time;
    const double height = engine->particles().position[0].z() - radius;
    EXPECT_GE(height, -1e-15);
    EXPECT_LE(height, g * hop * hop / 8);
    EXPECT_LE(std::abs(engine->particles().velocity[0].z()), 0.5 * g * hop);
  }
  EXPECT_LE(engine->counters().collisions - before, 2 * 0.02 / contact_time);
}

// It is given a gap of 1e-5 of its radius, and hops in that.
TEST(Bounce, of_a_ball_laid_down_at_rest_does_not_begin) {
  const double radius = 0.1;
  Scene scene = box_scene({1, 1, 1});
  scene.scene.gravity = {0, 0, -g};
  add_collisions(scene, 0.6, 0.3);
  for (const double overlap : {0.0, 1e-6, -1e-15}) {
    ParticleState state;
    add_sphere(state, {0.5, 0.5, radius * (1 - overlap)}, Vector3::Zero(), radius);
    const auto engine = make_hard(scene, state);
    run(*engine, 0.1, 1e-5);
    EXPECT_NEAR(engine->particles().position[0].z(), radius, 1.2e-5 * radius) << overlap;
    EXPECT_LT(engine->particles().velocity[0].norm(), 1e-3) << overlap;
  }
}

// Both know of the collision, by the same time but for its last bits: whoever comes first must have
// the place of the other right.
TEST(Bounce, of_two_of_which_one_crosses_a_periodic_side_first_has_the_right_normal) {
  const double side = 0.02;
  const double radius = 1e-3;
  for (const Axis axis : {Axis::x, Axis::y, Axis::z}) {
    Scene scene = box_scene(Vector3::Constant(side), {axis});
    add_collisions(scene, 1.0, 0.0);
    const Vector3 along = Vector3::Unit(static_cast<int>(axis));
    const Vector3 across = Vector3::Unit((static_cast<int>(axis) + 1) % 3);
    for (const double way : {1.0, -1.0}) {
      for (int place = 0; place < 40; ++place) {
        const double speed = 1 + 0.013 * place;
        const Vector3 centre = Vector3::Constant(0.5 * side);
        ParticleState state;
        add_sphere(state, centre + way * (0.4 * side - 1e-5 * place) * along, Vector3::Zero(),
                   radius);
        add_sphere(state, centre - way * 0.47 * side * along + radius * across,
                   -way * speed * along, radius);
        const auto engine = make_hard(scene, state);
        run(*engine, 2e-3, 1e-6);
        ASSERT_EQ(engine->counters().collisions, 1);
        // The line of centres is at 30 degrees: the one at rest takes cos(30) of the speed along
        // it.
        const Vector3 taken =
            speed * std::sqrt(0.75) * (-way * std::sqrt(0.75) * along - 0.5 * across);
        EXPECT_LT((engine->particles().velocity[0] - taken).norm(), 100 * eps * speed)
            << place << ", axis " << static_cast<int>(axis) << ", way " << way;
      }
    }
  }
}

TEST(Force, acts_from_the_begin_of_a_window_on) {
  Scene scene = box_scene({1, 1, 1});
  scene.scene.gravity = {0, 0, -g};
  add_collisions(scene, 0.9, 0.3);
  ParticleState state;
  add_sphere(state, {0.5, 0.5, 0.5}, {0.1, 0, 0}, 1e-3);
  const auto engine = make_hard(scene, state);
  const double m = mass_of(state, 0);
  Vector3 velocity = state.velocity[0];
  Vector3 position = state.position[0];
  for (int window = 1; window <= 10; ++window) {
    const Vector3 force(1e-5 * window, -2e-5, 1e-6 * window * window);
    engine->advance(1e-3, 50, std::vector<Vector3>{force}, {});
    engine->commit();
    const Vector3 a = force / m + scene.scene.gravity;
    position += 1e-3 * velocity + 0.5e-6 * a;
    velocity += 1e-3 * a;
  }
  // A few roundings in each of ten windows.
  EXPECT_LT((engine->particles().velocity[0] - velocity).norm(), 40 * eps * velocity.norm());
  EXPECT_LT((engine->particles().position[0] - position).norm(), 40 * eps * position.norm());
}

TEST(Force, different_on_two_spheres_brings_them_together_when_the_closed_form_says) {
  const double radius = 1e-3;
  Scene scene = box_scene({1, 1, 1});
  add_collisions(scene, 1.0, 0.0);
  ParticleState state;
  // Apart at first, then drawn together; the gap closes at t = 0.02 s (1 + sqrt(1 + 2 a g / v²)).
  const double gap = 1e-3;
  const double part = 0.05;
  const double pull = 5.0;
  add_sphere(state, {0.5 - radius, 0.5, 0.5}, {-part, 0, 0}, radius);
  add_sphere(state, {0.5 + radius + gap, 0.5, 0.5}, Vector3::Zero(), radius);
  const auto engine = make_hard(scene, state);
  const double m = mass_of(state, 0);
  const double meet = (part + std::sqrt(part * part + 2 * pull * gap)) / pull;
  const double end = 0.05;
  engine->advance(end, 500, std::vector<Vector3>{{pull * m, 0, 0}, Vector3::Zero()}, {});
  ASSERT_EQ(engine->counters().collisions, 1);
  // Equal masses without loss swap their velocities.
  const double hit = pull * meet - part;
  const double since = end - meet;
  const ParticleState& after = engine->particles();
  EXPECT_NEAR(after.velocity[1].x(), hit, 20 * eps * hit);
  EXPECT_NEAR(after.velocity[0].x(), pull * since, 40 * eps * pull * since + 20 * eps);
  EXPECT_NEAR(after.position[1].x(), 0.5 + radius + gap + hit * since, 20 * eps);
}

TEST(Cradle, hands_the_momentum_on_through_a_chain) {
  for (const double gap : {1e-4, 1e-9, 0.0}) {
    Scene scene = box_scene({1, 0.1, 0.1});
    add_collisions(scene, 1.0, 0.0);
    const double radius = 5e-3;
    ParticleState state;
    add_sphere(state, {0.1, 0.05, 0.05}, {1.0, 0, 0}, radius);
    for (int k = 0; k < 6; ++k) {
      add_sphere(state, {0.2 + k * (2 * radius + gap), 0.05, 0.05}, Vector3::Zero(), radius);
    }
    const auto engine = make_hard(scene, state);
    run(*engine, 0.2, 1e-5);
    const ParticleState& after = engine->particles();
    for (int row = 0; row < 6; ++row) EXPECT_LT(after.velocity[row].norm(), 1e-12) << gap;
    EXPECT_NEAR(after.velocity[6].x(), 1, 1e-13) << gap;
    EXPECT_EQ(engine->counters().collisions, 6);
  }
}

TEST(Cradle, of_unequal_masses_follows_one_collision_after_the_other) {
  // e = 0.8, each half as large as the one before: v' = (1 + e) / (1 + m'/m) v down the chain.
  Scene scene = box_scene({1, 0.2, 0.2});
  add_collisions(scene, 0.8, 0.0);
  ParticleState state;
  double x = 0.1;
  double radius = 0.02;
  for (int k = 0; k < 5; ++k) {
    x += radius;
    add_sphere(state, {x, 0.1, 0.1}, {k == 0 ? 1.0 : 0.0, 0, 0}, radius);
    x += radius + 1e-4;
    radius *= 0.5;
  }
  const auto engine = make_hard(scene, state);
  run(*engine, 0.01, 1e-6);
  const double speed = std::pow(1.8 / (1 + 0.125), 4);
  EXPECT_NEAR(engine->particles().velocity[4].x(), speed, 100 * eps * speed);
}

TEST(Image, is_met_through_a_periodic_side) {
  Scene scene = box_scene({0.1, 0.1, 0.1}, {Axis::x, Axis::y});
  add_collisions(scene, 1.0, 0.0);
  const double radius = 4e-3;
  // Through a corner, both near the sides; the line of centres is along (1, 1, 0). In the others
  // one of them gets to the other side first.
  for (const double moved : {0.0, -0.002, 0.006}) {
    ParticleState state;
    add_sphere(state, {0.093 + moved, 0.093 + moved, 0.05}, {0.1, 0.1, 0}, radius);
    add_sphere(state, {0.003 + moved, 0.003 + moved, 0.05}, {-0.1, -0.1, 0}, radius);
    const auto engine = make_hard(scene, state);
    const double gap = 0.01 * std::sqrt(2) - 2 * radius;
    const double meet = gap / (0.2 * std::sqrt(2));
    run(*engine, 0.1, 1e-4);
    ASSERT_EQ(engine->counters().collisions, 1) << moved;
    const ParticleState& after = engine->particles();
    EXPECT_NEAR(after.velocity[0].x(), -0.1, 20 * eps) << moved;
    const double x = 0.093 + moved + 0.1 * meet - 0.1 * (0.1 - meet);
    EXPECT_NEAR(after.position[0].x(), x, 20 * eps) << moved;
    EXPECT_NEAR(after.position[1].y(), 0.003 + moved - 0.1 * meet + 0.1 * (0.1 - meet), 20 * eps)
        << moved;
  }
}

TEST(Image, flies_on_through_many_periods_in_one_window) {
  Scene scene = box_scene({0.1, 0.1, 0.1}, {Axis::x});
  add_collisions(scene, 1.0, 0.0);
  ParticleState state;
  add_sphere(state, {0.05, 0.05, 0.05}, {1.0, 0, 0}, 4e-3);
  add_sphere(state, {0.05, 0.02, 0.05}, {-1.0, 0, 0}, 4e-3);  // another lane
  const auto engine = make_hard(scene, state);
  run(*engine, 1.03, 1e-2);
  EXPECT_EQ(engine->counters().collisions, 0);
  EXPECT_NEAR(engine->particles().position[0].x(), 0.08, 1e-14);
  EXPECT_NEAR(engine->particles().position[1].x(), 0.02, 1e-14);
}

TEST(Fixed, spheres_are_hit_and_stay) {
  Scene scene = box_scene({0.1, 0.1, 0.1});
  scene.scene.gravity = {0, 0, -g};
  add_collisions(scene, 0.9, 0.3);
  ParticleState state;
  add_sphere(state, {0.05, 0.05, 0.03}, Vector3::Zero(), 5e-3);
  add_sphere(state, {0.05, 0.05, 0.06}, Vector3::Zero(), 2e-3);
  state.fixed = {1, 0};
  const auto engine = make_hard(scene, state);
  const double height = 0.03 - 7e-3;
  const double fall = std::sqrt(2 * height / g);
  const double later = 0.02;
  engine->advance(fall + later, 1000, std::vector<Vector3>(2, Vector3::Zero()), {});
  const double up = 0.9 * g * fall;
  EXPECT_EQ(engine->particles().position[0], state.position[0]);
  EXPECT_EQ(engine->particles().velocity[0], Vector3::Zero());
  EXPECT_NEAR(engine->particles().position[1].z(), 0.037 + up * later - 0.5 * g * later * later,
              10 * eps);
}

TEST(Rows, in_any_order_give_the_same) {
  // A break: the cue hits a triangle. What comes out is known to 2^-52 times the growth of an error
  // in each of some ten collisions in a row.
  const auto balls = [](bool reversed) {
    ParticleState state;
    const double radius = 0.02;
    std::vector<Vector3> at;
    for (int row = 0; row < 4; ++row) {
      for (int k = 0; k <= row; ++k) {
        at.emplace_back(0.4 + row * 0.0352, 0.5 + (k - 0.5 * row) * 0.0407 + 1e-3 * row * k, 0.5);
      }
    }
    if (reversed) std::ranges::reverse(at);
    for (const Vector3& x : at) add_sphere(state, x, Vector3::Zero(), radius);
    add_sphere(state, {0.1, 0.503, 0.5}, {2, 0, 0}, radius);
    return state;
  };
  Scene scene = box_scene({1, 1, 1});
  add_collisions(scene, 0.95, 0.1);
  const auto one = make_hard(scene, balls(false));
  const auto other = make_hard(scene, balls(true));
  run(*one, 0.25, 1e-5);
  run(*other, 0.25, 1e-5);
  EXPECT_EQ(one->counters().collisions, other->counters().collisions);
  EXPECT_GT(one->counters().collisions, 10);
  for (int row = 0; row < 10; ++row) {
    EXPECT_LT((one->particles().position[row] - other->particles().position[9 - row]).norm(),
              1e-11);
  }
}

}  // namespace
}  // namespace fluxpact
