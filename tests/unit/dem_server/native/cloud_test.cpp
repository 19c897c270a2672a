// Many spheres: conservation, symmetry under renumbering, periodic sides, remaking of the list.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "tests/unit/dem_server/native/random_cloud.hpp"

namespace fluxpact {
namespace {

Vector3 momentum(const ParticleState& state) {
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < state.size(); ++i) {
    sum += state.density[i] * std::pow(state.radius[i], 3) * state.velocity[i];
  }
  return sum;
}

TEST(Cloud, keeps_its_momentum_to_rounding) {
  const Scene scene = cloud_scene({Axis::x, Axis::y, Axis::z});
  const auto engine = make_engine(scene, random_cloud(2000, 0.5));
  double scale = 0;
  for (int i = 0; i < engine->particles().size(); ++i) {
    scale +=
        2250 * std::pow(engine->particles().radius[i], 3) * engine->particles().velocity[i].norm();
  }
  const Vector3 before = momentum(engine->particles());
  run(*engine, 2e-3, 2e-6);
  // 1000 sub-steps round each velocity a few times, with random signs: sqrt(1000) · 1e-16 and some.
  EXPECT_LT((momentum(engine->particles()) - before).norm(), 1e-13 * scale);
  EXPECT_GT(engine->particles().spin[0].norm() + engine->particles().spin[1].norm(), 0);
}

TEST(Cloud, does_not_depend_on_the_numbering) {
  const Scene scene = cloud_scene({Axis::x});
  const ParticleState state = random_cloud(500, 0.3);
  ParticleState renumbered = state;
  const int count = state.size();
  for (int i = 0; i < count; ++i) {  // 7 has no factor in common with 500
    const int from = 7 * i % count;
    renumbered.position[i] = state.position[from];
    renumbered.velocity[i] = state.velocity[from];
    renumbered.radius[i] = state.radius[from];
  }
  std::reverse(renumbered.id.begin(), renumbered.id.end());
  const auto engine = make_engine(scene, state);
  const auto other = make_engine(scene, renumbered);
  run(*engine, 2e-4, 2e-6);
  run(*other, 2e-4, 2e-6);
  for (int i = 0; i < count; ++i) {
    const int from = 7 * (count - 1 - i) % count;
    const Vector3 apart = engine->particles().position[from] - other->particles().position[i];
    // Sums run in another order: rounding of 1e-16 · 0.03 m, grown by some collisions.
    EXPECT_LT(apart.norm(), 1e-10 * 0.03);
  }
}

TEST(Cloud, presents_ascending_ids) {
  const Scene scene = cloud_scene({});
  ParticleState state = random_cloud(200, 0.3);
  const ParticleState ascending = state;
  std::reverse(state.id.begin(), state.id.end());
  const auto engine = make_engine(scene, state);
  EXPECT_EQ(engine->particles().id, ascending.id);
  EXPECT_EQ(engine->particles().position[0], ascending.position[199]);
}

/// Two spheres that hit obliquely, the middle between them at `centre`, in a box of 1 cm.
ParticleState oblique_pair(const Vector3& centre, const Vector3& drift) {
  ParticleState state;
  const Vector3 half(1.01e-3, 0, 0);
  add_sphere(state, centre - half, drift + Vector3(0.02, 0.03, 0), 1e-3);
  add_sphere(state, centre + half, drift + Vector3(-0.02, 0, 0.01), 1e-3);
  return state;
}

void expect_same_motion(const ParticleState& a, const ParticleState& b, const Vector3& drift,
                        double tolerance) {
  for (int i = 0; i < 2; ++i) {
    EXPECT_LT((a.velocity[i] - b.velocity[i] + drift).norm(), tolerance);
    EXPECT_LT((a.spin[i] - b.spin[i]).norm(), tolerance / 1e-3);
  }
}

TEST(Periodic, contact_across_the_boundary_is_like_any_other) {
  Scene scene = box_scene({0.01, 0.01, 0.01}, {Axis::x, Axis::y});
  add_laws(scene, 1000, 0.9, 0.3);
  const auto inside = make_engine(scene, oblique_pair({5e-3, 5e-3, 5e-3}, Vector3::Zero()));
  ParticleState split = oblique_pair({0, 5e-3, 5e-3}, Vector3::Zero());
  split.position[0].x() += 0.01;
  const auto across = make_engine(scene, split);
  run(*inside, 2e-3, 1e-6);
  run(*across, 2e-3, 1e-6);
  EXPECT_GT(inside->particles().spin[0].norm(), 1.0);  // they did touch, with friction
  // Positions of 1e-2 m are rounded at 1e-18 m; over an overlap of 1e-6 m that is 1e-12 of the
  // force.
  expect_same_motion(inside->particles(), across->particles(), Vector3::Zero(), 1e-11);
}

TEST(Periodic, contact_across_any_sides_edges_and_corners_pushes_the_same) {
  // Two spheres that overlap along each of the directions to a neighbouring image.
  const double overlap = 1e-5;
  const auto pushed = [&](const Vector3& middle, const Vector3& direction, bool periodic) {
    Scene scene =
        box_scene(Vector3::Constant(0.01),
                  periodic ? std::vector<Axis>{Axis::x, Axis::y, Axis::z} : std::vector<Axis>{});
    add_laws(scene, 1000, 0.9, 0.3);
    ParticleState state;
    const Vector3 half = (1e-3 - 0.5 * overlap) * direction.normalized();
    for (const Vector3& place : {Vector3(middle - half), Vector3(middle + half)}) {
      Vector3 inside = place;
      for (int axis = 0; axis < 3; ++axis) inside[axis] -= 0.01 * std::floor(place[axis] / 0.01);
      add_sphere(state, inside, Vector3::Zero(), 1e-3);
    }
    const auto engine = make_engine(scene, state);
    run(*engine, 5e-5, 1e-6);
    return std::pair(engine->particles().velocity[0], engine->particles().velocity[1]);
  };
  for (int code = 0; code < 27; ++code) {
    const Vector3 direction(code / 9 - 1, code / 3 % 3 - 1, code % 3 - 1);
    if (direction.isZero()) continue;
    // Across the sides, edge or corner to which it points; inside, nothing is near.
    Vector3 border = Vector3::Constant(5e-3);
    for (int axis = 0; axis < 3; ++axis) {
      if (direction[axis] != 0) border[axis] = 0;
    }
    const auto [a, b] = pushed(Vector3::Constant(5e-3), direction, false);
    const auto [c, d] = pushed(border, direction, true);
    EXPECT_LT(a.dot(direction), -1e-3) << code;
    // Positions are rounded by 1e-18 m: 1e-13 of the overlap.
    EXPECT_LT((c - a).norm(), 1e-10 * a.norm()) << code;
    EXPECT_LT((d - b).norm(), 1e-10 * a.norm()) << code;
  }
}

TEST(Periodic, thin_box_holds_two_images_of_one_pair) {
  // A period of 2.4 radii: each sphere touches the other on both sides, and is pushed by neither.
  Scene scene = box_scene({4.0e-3 - 2e-6, 0.01, 0.01}, {Axis::x});
  scene.fluid.mesh.box.cells = {1, 1, 1};
  add_laws(scene, 1000, 1.0, 0.0);
  ParticleState state;
  add_sphere(state, {1e-3, 5e-3, 5e-3}, Vector3::Zero(), 1e-3);
  add_sphere(state, {3e-3 - 1e-6, 5e-3, 5e-3}, Vector3::Zero(), 1e-3);
  const auto engine = make_engine(scene, state);
  run(*engine, 1e-3, 1e-6);
  // The two pushes are equal up to the rounding of positions: 1e-18 m · 1000 N/m / 1e-5 kg · 1e-3
  // s.
  EXPECT_LT(engine->particles().velocity[0].norm(), 1e-12);
}

TEST(ContactList, springs_survive_remaking_and_wrapping) {
  // The same impact seen from a moving frame: the pair crosses several skins and the periodic
  // boundary while it touches, and the springs must not notice.
  Scene scene = box_scene({0.01, 0.01, 0.01}, {Axis::x, Axis::y, Axis::z});
  add_laws(scene, 1000, 0.9, 0.3);
  const Vector3 drift(4, 3, 2);
  const Vector3 start(9e-3, 9.5e-3, 9.8e-3);
  const auto rest = make_engine(scene, oblique_pair({5e-3, 5e-3, 5e-3}, Vector3::Zero()));
  const auto moving = make_engine(scene, oblique_pair(start, drift));
  run(*rest, 1.2e-3, 1e-6);
  run(*moving, 1.2e-3, 1e-6);
  EXPECT_GT(rest->particles().spin[0].norm(), 1.0);
  // Rounding of positions as above, in each of the 300 sub-steps of the contact and of the drift.
  expect_same_motion(rest->particles(), moving->particles(), drift, 1e-9);
}

/// A cloud of slow and fast spheres, and one that flies to and fro through periodic sides in the
/// empty layer above it.
ParticleState cloud_below_a_flyer(double speed) {
  ParticleState state = random_cloud(500, 0.05);
  for (int i = 0; i < state.size(); ++i) state.velocity[i] *= std::array{0.01, 1.0, 40.0}[i % 3];
  add_sphere(state, {0, 0.015, 0.04}, {speed, 0, 0}, 1e-3);
  return state;
}

Scene cloud_below_a_layer() {
  Scene scene = box_scene({cloud_box, cloud_box, 0.045}, {Axis::x});
  add_laws(scene, 1000, 0.9, 0.3);
  scene.particles.time_step = 1e-5;
  return scene;
}

TEST(ContactList, misses_nobody_however_fast) {
  // The flyer makes lists anew all the time: what happens below must not depend on that.
  const auto engine = make_engine(cloud_below_a_layer(), cloud_below_a_flyer(0));
  const auto relisted = make_engine(cloud_below_a_layer(), cloud_below_a_flyer(20));
  run(*engine, 2e-3, 1e-5);
  run(*relisted, 2e-3, 1e-5);
  EXPECT_GT(relisted->counters().rebuilds, 3 * engine->counters().rebuilds);
  double turned = 0;
  for (int i = 0; i < 500; ++i) {
    const Vector3 apart = engine->particles().position[i] - relisted->particles().position[i];
    // Sums run in another order: rounding of 1e-16 · 0.03 m, grown by some collisions. Who is
    // missed for a sub-step is off by some 1e-8 m.
    EXPECT_LT(apart.norm(), 1e-9 * 0.03) << i;
    turned = std::max(turned, engine->particles().spin[i].norm());
  }
  EXPECT_GT(turned, 1);  // they did touch
}

TEST(ContactList, finds_pairs_where_floats_are_coarser_than_spheres) {
  // In a box of 20 km floats have steps of up to 1 mm, the radius.
  constexpr double length = 2e4;
  Scene scene = box_scene(Vector3::Constant(length), {Axis::y});
  add_laws(scene, 1000, 1.0, 0.0);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> anywhere(0.01 * length, 0.99 * length);
  std::uniform_real_distribution<double> any(-1, 1);
  ParticleState state;
  constexpr double overlap = 1e-5;
  const auto add_pair = [&](const Vector3& middle, const Vector3& direction) {
    const Vector3 half = (1e-3 - 0.5 * overlap) * direction.normalized();
    for (const double side : {-1.0, 1.0}) {
      Vector3 place = middle + side * half;
      if (place.y() < 0) place.y() += length;
      add_sphere(state, place, Vector3::Zero(), 1e-3);
    }
  };
  for (int k = 0; k < 200; ++k) {
    const Vector3 direction(any(random), any(random), any(random));
    // Every fourth pair lies across the periodic side.
    add_pair({anywhere(random), k % 4 == 0 ? 0 : anywhere(random), anywhere(random)}, direction);
  }
  const auto engine = make_engine(scene, state);
  run(*engine, 1e-6, 1e-6);
  // Two kicks of half a step by k δ, the second by k dt²/m = 1e-4 less. (Places of 1e4 m are
  // rounded by 2e-12, 1e-6 of the overlap.)
  const double mass = 2250 * 4.0 / 3.0 * std::numbers::pi * 1e-9;
  const double gained = 1000 * overlap / mass * 1e-6;
  for (const Vector3& velocity : engine->particles().velocity) {
    EXPECT_NEAR(velocity.norm(), gained, 1e-4 * gained);
  }
}

TEST(ContactList, few_fast_ones_make_no_new_list_for_all) {
  // 4 m/s: 0.02 mm in a sub-step, and 0.6 mm (0.3 diameters) are allowed: 30 sub-steps a list. A
  // slow one has 0.15 mm, with which this one would last 8.
  Scene scene = box_scene({0.03, 0.03, 0.03}, {Axis::x});
  add_laws(scene, 1000, 0.9, 0.3);
  scene.particles.time_step = 5e-6;
  ParticleState state;
  for (int k = 0; k < 5; ++k) {
    add_sphere(state, {5e-3 * k + 2e-3, 5e-3, 5e-3}, Vector3::Zero(), 1e-3);
  }
  add_sphere(state, {2e-3, 0.02, 0.02}, {4, 0, 0}, 1e-3);
  const auto engine = make_engine(scene, state);
  const auto before = engine->counters().rebuilds;
  run(*engine, 3e-3, 5e-6);
  EXPECT_LE(engine->counters().rebuilds - before, 600 / 29);
  EXPECT_GE(engine->counters().rebuilds - before, 600 / 31);
}

TEST(ContactList, wall_springs_survive_remaking) {
  // A sphere that rolls along a wall: the spring it starts with is gone if a remade list forgets
  // it.
  Scene scene = box_scene({0.05, 0.01, 0.01});
  scene.scene.gravity = {0, 0, -9.81};
  add_laws(scene, 1000, 0.9, 0.5);
  constexpr double radius = 1e-3;
  ParticleState state;
  add_sphere(state, {5e-3, 5e-3, radius - 9.2e-8}, {1.0, 0, 0}, radius);
  state.spin[0] = {0, 1.0 / radius, 0};
  const auto rolling = make_engine(scene, state);
  state.velocity[0].setZero();
  state.spin[0].setZero();
  const auto resting = make_engine(scene, state);
  // Pushed along the wall by less than friction holds, both gain the same speed: 5/7 of F t / m and
  // a remade list (each 0.15 ms or so for the rolling one) without springs would slip each time.
  const std::vector<Vector3> push{{2e-5, 0, 0}};
  rolling->advance(0.02, 20000, push, {});
  resting->advance(0.02, 20000, push, {});
  const double gain = rolling->particles().velocity[0].x() - 1.0;
  EXPECT_NEAR(gain, resting->particles().velocity[0].x(), 1e-9);
  EXPECT_GT(gain, 1e-3);
}

TEST(Spheres, of_two_materials_and_sizes_exchange_momentum_by_their_masses) {
  Scene scene = box_scene({0.02, 0.02, 0.02});
  scene.particles.materials["steel"].density = 7800;
  add_laws(scene, 1000, 0.9, 0);
  add_pair(scene, "steel", "glass", 3000, 0.5, 0);
  add_pair(scene, "steel", "walls", 3000, 0.5, 0);
  ParticleState state;
  add_sphere(state, {8e-3, 0.01, 0.01}, {0.01, 0, 0}, 1e-3);
  add_sphere(state, {11.01e-3, 0.01, 0.01}, Vector3::Zero(), 2e-3, 7800);
  state.material[1] = 1;
  const auto engine = make_engine(scene, state);
  run(*engine, 2e-3, 2e-7);
  const double m1 = 2250;
  const double m2 = 7800 * 8;
  // Restitution of the pair, not of either material: tolerance γ dt with γ = 7.8e3/s, dt = 2e-7 s.
  const double v1 = 0.01 * (m1 - 0.5 * m2) / (m1 + m2);
  const double v2 = 0.01 * 1.5 * m1 / (m1 + m2);
  EXPECT_NEAR(engine->particles().velocity[0].x(), v1, 2e-3 * std::abs(v1));
  EXPECT_NEAR(engine->particles().velocity[1].x(), v2, 2e-3 * v2);
}

}  // namespace
}  // namespace fluxpact
