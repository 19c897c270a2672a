// Walls beside the sides of the box in the engine: planes, cylinders and triangles, at rest and
// moving.
#include <cmath>
#include <cstring>
#include <numbers>

#include "proto/base/errors.hpp"
#include "tests/unit/dem_server/native/random_cloud.hpp"
#include "tests/unit/dem_server/walls/surfaces.hpp"

namespace fluxpact {
namespace {

constexpr double g = 9.81;
constexpr double r = 1e-3;
constexpr double stiffness = 1000;
const double mass = 2250 * 4.0 / 3.0 * std::numbers::pi * r * r * r;

/// A box of 4 cm from z = `bottom` on, and one law for all.
Scene scene_above(double bottom, double e, double mu) {
  Scene scene = box_scene(Vector3::Constant(0.04));
  scene.fluid.mesh.box.lower = {0, 0, bottom};
  scene.particles.time_step = 1e-5;
  add_laws(scene, stiffness, e, mu);
  return scene;
}

void add_surface(Scene& scene, const SurfaceSettings& surface) {
  const std::string name = fmt::format("surface{}", scene.particles.surfaces.size());
  scene.particles.surfaces.emplace_back(name, surface);
}

ParticleState one_sphere(const Vector3& position, const Vector3& velocity) {
  ParticleState state;
  add_sphere(state, position, velocity, r);
  return state;
}

/// Position, velocity and spin of the first particle after each window of 1 ms.
std::vector<std::array<Vector3, 3>> flight(const Scene& scene, const ParticleState& start,
                                           int windows) {
  const auto engine = make_engine(scene, start);
  std::vector<std::array<Vector3, 3>> way;
  for (int window = 0; window < windows; ++window) {
    run(*engine, 1e-3, scene.particles.time_step);
    const ParticleState& now = engine->particles();
    way.push_back({now.position[0], now.velocity[0], now.spin[0]});
  }
  return way;
}

/// The floor z = 0 as the side of the box, as a plane, and in triangles of 0.2 mm below the way.
struct Floors {
  Scene side, plane_surface, triangles;
};

Floors floors(double e, double mu, const StlFile& stl) {
  Floors all{scene_above(0, e, mu), scene_above(-0.02, e, mu), scene_above(-0.02, e, mu)};
  add_surface(all.plane_surface, plane(Vector3::Zero(), Vector3::UnitZ()));
  add_surface(all.triangles, stl.surface());
  for (Scene* scene : {&all.side, &all.plane_surface, &all.triangles}) {
    scene->scene.gravity = {0, 0, -g};
  }
  return all;
}

TriangleSurface floor_of_triangles() {
  return sheet({1e-3, 1e-3, 0}, {0.012, 0, 0}, {0, 0.004, 0}, 60, 20);
}

/// Distances are rounded by 1e-19 m, which is 1e-12 of an overlap under weight and less of one in
/// an impact; thousands of sub-steps add to it, and where friction begins to slide a sub-step is
/// decided by it. A spring lost on the way changes spin and velocity by 1e-3 and more.
constexpr double alike = 1e-8;

void expect_same_way(const Scene& a, const Scene& b, const ParticleState& start, int windows) {
  const auto one = flight(a, start, windows);
  const auto other = flight(b, start, windows);
  const double speed = start.velocity[0].norm();
  for (int window = 0; window < windows; ++window) {
    EXPECT_LT((one[window][0] - other[window][0]).norm(), alike * r) << window;
    EXPECT_LT((one[window][1] - other[window][1]).norm(), alike * speed) << window;
    EXPECT_LT(r * (one[window][2] - other[window][2]).norm(), alike * speed) << window;
  }
}

TEST(Floor, of_any_kind_rebounds_a_sphere_as_the_side_of_the_box_does) {
  const StlFile stl(floor_of_triangles());
  const Floors all = floors(0.8, 0.2, stl);
  const ParticleState start = one_sphere({2.03e-3, 2.5e-3, 1.2e-3}, {0.08, 0.013, -0.3});
  EXPECT_GT(flight(all.side, start, 2).back()[1].z(), 0.1) << "it has rebounded";
  expect_same_way(all.side, all.plane_surface, start, 80);
  expect_same_way(all.side, all.triangles, start, 80);
}

TEST(Floor, of_triangles_keeps_the_springs_of_friction_over_edges_and_diagonals) {
  const StlFile stl(floor_of_triangles());
  const Floors all = floors(0.9, 0.3, stl);
  const ParticleState start =
      one_sphere({2.03e-3, 2.5e-3, r - mass * g / stiffness}, {0.1, 0.013, 0});
  const auto way = flight(all.side, start, 60);
  EXPECT_GT(way.back()[0].x() - way.front()[0].x(), 3e-3) << "over some 40 triangles";
  // Slip that has turned to rolling at 5/7 of the speed, and the spring's rest under no load.
  EXPECT_NEAR(way.back()[1].x(), 0.1 * 5 / 7, 1e-3 * 0.1);
  EXPECT_NEAR(way.back()[2].y() * r, 0.1 * 5 / 7, 1e-3 * 0.1);
  expect_same_way(all.side, all.plane_surface, start, 60);
  expect_same_way(all.side, all.triangles, start, 60);
}

TEST(Floor, of_triangles_holds_a_sphere_that_sticks_on_a_slope) {
  // Below the angle of friction: the spring carries the weight for good, over rebuilds too.
  const StlFile stl(floor_of_triangles());
  Floors all = floors(0.5, 0.5, stl);
  all.triangles.scene.gravity = {0.3 * g, 0, -g};
  const ParticleState start =
      one_sphere({5.03e-3, 2.5e-3, r - mass * g / stiffness}, Vector3::Zero());
  // It rolls down with the acceleration 5/7 g sin, without slip.
  const auto way = flight(all.triangles, start, 50);
  EXPECT_NEAR(way.back()[1].x(), 5.0 / 7 * 0.3 * g * 0.05, 1e-3 * 0.105);
  EXPECT_NEAR(way.back()[2].y() * r, way.back()[1].x(), 1e-3 * 0.105);
}

// ---- cylinders ----

constexpr double tube_radius = 0.01;
const Vector3 tube_axis_point(0.02, 0, 0.02);

Scene tube_scene(double e, double mu) {
  Scene scene = scene_above(0, e, mu);
  scene.scene.gravity = {0, 0, -g};
  add_surface(scene, cylinder(tube_axis_point, Vector3::UnitY(), tube_radius));
  return scene;
}

/// At an angle from the bottom, pressed in as its weight does.
ParticleState sphere_in_tube(double angle) {
  const double arm = tube_radius - r + mass * g * std::cos(angle) / stiffness;
  const Vector3 from_axis = arm * Vector3(std::sin(angle), 0, -std::cos(angle));
  return one_sphere(tube_axis_point + Vector3(0, 0.02, 0) + from_axis, Vector3::Zero());
}

TEST(Tube, without_losses_keeps_the_energy_of_a_sphere_that_slides_in_it) {
  const ParticleState start = sphere_in_tube(std::numbers::pi / 3);
  const auto way = flight(tube_scene(1.0, 0.0), start, 300);
  const auto energy = [](const Vector3& x, const Vector3& v) {
    const Vector3 from_axis(x.x() - tube_axis_point.x(), 0, x.z() - tube_axis_point.z());
    const double overlap = std::max(0.0, from_axis.norm() + r - tube_radius);
    return 0.5 * mass * v.squaredNorm() + mass * g * x.z() + 0.5 * stiffness * overlap * overlap;
  };
  const double before = energy(start.position[0], Vector3::Zero());
  const double scale = mass * g * (tube_radius - r) * 0.5;
  double lowest = 1;
  for (const auto& [x, v, spin] : way) {
    // Verlet's error is (w dt)²/8 = 1e-3 of the energy in the spring, which is 4e-5 of the whole.
    EXPECT_NEAR(energy(x, v), before, 1e-6 * scale);
    EXPECT_EQ(x.y(), 0.02);
    lowest = std::min(lowest, x.x());
  }
  EXPECT_LT(lowest, tube_axis_point.x() - 0.99 * (tube_radius - r) * std::sqrt(0.75))
      << "it has been on the other side";
}

TEST(Tube, swings_a_rolling_sphere_with_the_period_of_the_closed_form) {
  constexpr double angle = 0.05;
  const double small = 2 * std::numbers::pi * std::sqrt(7 * (tube_radius - r) / (5 * g));
  const double period = small * (1 + angle * angle / 16);
  const auto way = flight(tube_scene(1.0, 1.0), sphere_in_tube(angle), 300);
  std::vector<double> crossings;  // of the bottom, towards -x
  for (std::size_t n = 1; n < way.size(); ++n) {
    const double before = way[n - 1][0].x() - tube_axis_point.x();
    const double after = way[n][0].x() - tube_axis_point.x();
    if (before > 0 && after <= 0) {
      crossings.push_back(1e-3 * (static_cast<double>(n) + before / (before - after)));
    }
  }
  ASSERT_EQ(crossings.size(), 2U);
  // The springs give way by 1e-5 of the radius, the tangential one likewise; half of that each.
  EXPECT_NEAR(crossings[1] - crossings[0], period, 5e-5 * period);
}

// ---- moving walls ----

SurfaceSettings vibrating(SurfaceSettings surface, const Vector3& amplitude, double frequency) {
  surface.motion.type = MotionType::vibration;
  surface.motion.amplitude = amplitude;
  surface.motion.frequency = frequency;
  return surface;
}

SurfaceSettings translating(SurfaceSettings surface, const Vector3& velocity) {
  surface.motion.type = MotionType::translation;
  surface.motion.velocity = velocity;
  return surface;
}

SurfaceSettings rotating(SurfaceSettings surface, const Vector3& point, const Vector3& direction,
                         double rate) {
  surface.motion.type = MotionType::rotation;
  surface.motion.point = point;
  surface.motion.direction = direction;
  surface.motion.rate = rate;
  return surface;
}

/// As for impacts on walls at rest (friction_test.cpp): the dashpot's lag, and the moment of
/// touching known to a sub-step only, give γ dt = 7e-4 and less of the change of velocity.
constexpr double impact_tolerance = 1e-3;

TEST(MovingWall, that_vibrates_hands_over_its_momentum) {
  constexpr double e = 0.8;
  constexpr double v = 0.5;
  constexpr double angular = 2 * std::numbers::pi;  // 1 Hz: nearly steady over an impact of 0.3 ms
  for (const double amplitude : {0.05, -0.03}) {
    Scene scene = scene_above(-0.02, e, 0.3);
    scene.particles.time_step = 1e-6;
    add_surface(scene, vibrating(plane(Vector3::Zero(), Vector3::UnitZ()), {0, 0, amplitude}, 1));
    const auto way = flight(scene, one_sphere({0.01, 0.01, 2 * r}, {0, 0, -v}), 12);
    // They meet near t = gap / (v + w); there the wall moves with w cos(2 π t).
    const double fastest = angular * amplitude;
    const double meet = r / (v + fastest) + 0.15e-3;
    const double w = fastest * std::cos(angular * meet);
    EXPECT_NEAR(way.back()[1].z(), e * v + (1 + e) * w, impact_tolerance * (1 + e) * (v + w));
    EXPECT_EQ(way.back()[1].x(), 0);
  }
}

TEST(MovingWall, that_runs_like_a_belt_sets_a_sphere_rolling_at_two_sevenths_of_its_speed) {
  Scene scene = scene_above(-0.02, 0.9, 0.3);
  scene.scene.gravity = {0, 0, -g};
  add_surface(scene, translating(plane(Vector3::Zero(), Vector3::UnitZ()), {0.1, 0, 0}));
  const ParticleState start = one_sphere({0.01, 0.02, r - mass * g / stiffness}, Vector3::Zero());
  const auto way = flight(scene, start, 60);
  EXPECT_NEAR(way[4][1].x(), 0.3 * g * 5e-3, 1e-2 * 0.3 * g * 5e-3) << "while it slides";
  EXPECT_NEAR(way.back()[1].x(), 0.1 * 2 / 7, 1e-3 * 0.1);
  EXPECT_NEAR(way.back()[2].y() * r, -0.1 * 5 / 7, 1e-3 * 0.1);
}

TEST(MovingWall, of_a_drum_that_turns_drags_a_sphere_along) {
  constexpr double mu = 0.2;
  for (const double rate : {5.0, -5.0}) {
    Scene scene = scene_above(0, 0.9, mu);
    scene.scene.gravity = {0, 0, -g};
    add_surface(scene, rotating(cylinder(tube_axis_point, Vector3::UnitY(), tube_radius),
                                tube_axis_point, Vector3::UnitY(), rate));
    const auto way = flight(scene, sphere_in_tube(0), 5);
    // The bottom moves with rate ŷ × (−R ẑ), towards −x for a positive rate, at 50 mm/s; friction
    // slides for the first 5 ms, in which the slope stays below 1e-2 of the friction.
    const double pushed = (rate > 0 ? -1 : 1) * mu * g * 5e-3;
    EXPECT_NEAR(way.back()[1].x(), pushed, 2e-2 * std::abs(pushed));
    EXPECT_NEAR(way.back()[2].y() * r, -2.5 * pushed, 2e-2 * std::abs(2.5 * pushed));
    EXPECT_EQ(way.back()[1].y(), 0);
  }
}

/// A sphere at rest, far outside of the reach of the first list, is hit at the speed `w` [m/s].
void expect_hit(const SurfaceSettings& surface, const Vector3& start, const Vector3& w) {
  constexpr double e = 0.8;
  Scene scene = scene_above(0, e, 0.0);
  scene.particles.time_step = 1e-6;
  add_surface(scene, surface);
  const auto engine = make_engine(scene, one_sphere(start, Vector3::Zero()));
  const auto built = engine->counters().rebuilds;
  run(*engine, 4e-3, 1e-6);
  EXPECT_EQ(engine->particles().position[0], start);
  run(*engine, 12e-3, 1e-6);
  const Vector3 expected = (1 + e) * w;
  EXPECT_LT((engine->particles().velocity[0] - expected).norm(), 5e-3 * expected.norm());
  EXPECT_GT(engine->counters().rebuilds, built);
}

TEST(MovingWall, finds_a_sphere_that_rests_beyond_the_skin) {
  const Vector3 start(0.02, 0.02, 0.02);
  const Vector3 w(0, 0, 0.25);
  expect_hit(translating(plane({0, 0, 0.0175}, Vector3::UnitZ()), w), start, w);
  const StlFile stl(sheet({0.01, 0.01, 0.0175}, {0.02, 0, 0}, {0, 0.02, 0}, 7, 7));
  expect_hit(translating(stl.surface(), w), start, w);
  expect_hit(translating(cylinder({0.02, 0, 0.0075}, Vector3::UnitY(), 0.01, 0.04), w), start, w);
}

TEST(MovingWall, that_turns_finds_a_sphere_that_rests_beyond_the_skin) {
  // A paddle about the line x = 0.01, z = 0.02 along y starts 0.3 rad below the sphere's centre,
  // which is 10 mm from the line. They touch where the paddle is asin(r / 10 mm) = 0.1 rad below.
  // A turn about −y lifts what lies at +x.
  constexpr double rate = 25;
  constexpr double away = 0.01;
  const Vector3 line(0.01, 0, 0.02);
  const Vector3 along(0.02 * std::cos(0.3), 0, -0.02 * std::sin(0.3));
  const StlFile stl(sheet(line + Vector3(0, 0.01, 0), along, {0, 0.02, 0}, 7, 7));
  const double below = std::asin(r / away);
  const double speed = rate * away * std::cos(below);
  expect_hit(rotating(stl.surface(), line, -Vector3::UnitY(), rate), line + Vector3(away, 0.02, 0),
             speed * Vector3(std::sin(below), 0, std::cos(below)));
}

// ---- bits ----

void expect_same_bits(const ParticleState& a, const ParticleState& b) {
  const auto same = [](const std::vector<Vector3>& one, const std::vector<Vector3>& other) {
    return one.size() == other.size() &&
           std::memcmp(one.data(), other.data(), one.size() * sizeof(Vector3)) == 0;
  };
  EXPECT_TRUE(same(a.position, b.position));
  EXPECT_TRUE(same(a.velocity, b.velocity));
  EXPECT_TRUE(same(a.spin, b.spin));
}

const Vector3 middle = Vector3::Constant(cloud_box / 2);

/// A box with a floor that shakes, a paddle that turns, and a pipe.
Scene stirred_scene(const StlFile& paddle, int threads) {
  Scene scene = cloud_scene({});
  scene.scene.gravity = {0, 0, -g};
  scene.particles.numerics.threads = threads;
  add_surface(scene, vibrating(plane(Vector3::Zero(), Vector3::UnitZ()), {0, 0, 0.3e-3}, 100));
  add_surface(scene, rotating(paddle.surface(), middle, Vector3::UnitZ(), 30));
  add_surface(scene, cylinder({7e-3, 0, 7e-3}, Vector3::UnitY(), 4e-3));
  return scene;
}

/// A cloud without the spheres that cut the paddle or the pipe.
ParticleState stirred_cloud() {
  const ParticleState all = random_cloud(1000, 1.0);
  ParticleState kept;
  for (int row = 0; row < all.size(); ++row) {
    const Vector3& x = all.position[row];
    const double radius = all.radius[row];
    const double from_pipe = std::abs(std::hypot(x.x() - 7e-3, x.z() - 7e-3) - 4e-3);
    if (std::abs(x.x() - middle.x()) < radius || from_pipe < radius) continue;
    add_sphere(kept, x, all.velocity[row], radius);
  }
  return kept;
}

TriangleSurface paddle_shape() {
  return sheet(middle - Vector3(0, 0.01, 0.01), {0, 0.02, 0}, {0, 0, 0.02}, 9, 9);
}

constexpr double stir_window = 6e-4;  // [s] with several new lists
constexpr int stir_steps = 300;

ParticleState stirred(const StlFile& paddle, int threads) {
  const ParticleState start = stirred_cloud();
  const auto engine = make_engine(stirred_scene(paddle, threads), start);
  for (int window = 0; window < 2; ++window) run(*engine, stir_window, 2e-6);
  EXPECT_GT(engine->counters().rebuilds, 3);
  return engine->particles();
}

TEST(MovingWall, gives_the_same_bits_for_any_number_of_threads) {
  const StlFile paddle(paddle_shape());
  const ParticleState one = stirred(paddle, 1);
  expect_same_bits(one, stirred(paddle, 2));
  expect_same_bits(one, stirred(paddle, 3));
}

TEST(MovingWall, repeats_the_bits_of_a_window_that_was_rolled_back) {
  const StlFile paddle(paddle_shape());
  const ParticleState start = stirred_cloud();
  const std::vector<Vector3> none(start.id.size(), Vector3::Zero());
  const std::vector<Vector3> wind(start.id.size(), Vector3(0, 3e-4, 0));
  const auto straight = make_engine(stirred_scene(paddle, 2), start);
  const auto repeated = make_engine(stirred_scene(paddle, 2), start);
  for (int window = 0; window < 3; ++window) {
    straight->advance(stir_window, stir_steps, none, {});
    straight->commit();
    const ParticleState committed = repeated->particles();
    repeated->advance(1.5 * stir_window, stir_steps, wind, {});  // an attempt that is given up
    repeated->rollback();
    expect_same_bits(committed, repeated->particles());
    repeated->advance(stir_window, stir_steps, none, {});
    repeated->commit();
    expect_same_bits(straight->particles(), repeated->particles());
  }
}

// ---- errors ----

TEST(SurfaceRefusal, names_a_material_without_a_law) {
  Scene scene = scene_above(-0.02, 0.9, 0.3);
  scene.particles.materials["steel"].density = 7800;
  SurfaceSettings floor = plane(Vector3::Zero(), Vector3::UnitZ());
  floor.material = "steel";
  add_surface(scene, floor);
  const ParticleState state = one_sphere({0.01, 0.01, 0.01}, Vector3::Zero());
  expect_contains(message_of<ConfigError>([&] { make_engine(scene, state); }), "[glass, steel]");
  add_pair(scene, "glass", "steel", stiffness, 0.5, 0.3);
  EXPECT_NO_THROW(make_engine(scene, state));
}

TEST(SurfaceLaw, is_that_of_the_material_of_each_surface) {
  Scene scene = scene_above(-0.02, 0.9, 0.3);
  scene.particles.time_step = 1e-6;
  scene.particles.materials["rubber"].density = 1000;
  add_pair(scene, "glass", "rubber", stiffness, 0.4, 0.3);
  SurfaceSettings floor = plane(Vector3::Zero(), Vector3::UnitZ());
  floor.material = "rubber";
  add_surface(scene, floor);
  const auto way = flight(scene, one_sphere({0.01, 0.01, 1.5 * r}, {0, 0, -0.5}), 4);
  // γ dt / 2 of a restitution of 0.4: ln e / contact time = 3e3 per second.
  EXPECT_NEAR(way.back()[1].z(), 0.4 * 0.5, 4e-3 * 0.5);
}

TEST(SurfaceRefusal, names_a_sphere_that_was_pressed_through_triangles) {
  Scene scene = scene_above(-0.02, 0.9, 0.3);
  scene.particles.contact.pairs.back().normal_stiffness = 0.1;
  const StlFile stl(floor_of_triangles());
  add_surface(scene, stl.surface());
  ParticleState state = one_sphere({5e-3, 3e-3, 2e-3}, {0, 0, -1});
  state.id[0] = 42;
  const auto engine = make_engine(scene, state);
  const std::string text = message_of<NumericsError>([&] { run(*engine, 20e-3, 1e-5); });
  expect_contains(text, "particle 42");
  expect_contains(text, "normal_stiffness");
  engine->rollback();
  EXPECT_NO_THROW(run(*engine, 0.5e-3, 1e-5)) << "it has not been lost yet";
}

}  // namespace
}  // namespace fluxpact
