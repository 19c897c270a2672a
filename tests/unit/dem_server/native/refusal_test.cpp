// What the engines refuse, and that they say what, where and what to do.
#include <limits>

#include "dem_server/backends/domain.hpp"
#include "dem_server/backends/kinematic/kinematic_engine.hpp"
#include "proto/base/errors.hpp"
#include "tests/unit/dem_server/native/spheres_in_a_box.hpp"

namespace fluxpact {
namespace {

Scene small_scene() {
  Scene scene = box_scene({0.01, 0.01, 0.01});
  add_laws(scene, 1000, 0.9, 0.3);
  return scene;
}

ParticleState sphere_at(const Vector3& position, const Vector3& velocity) {
  ParticleState state;
  add_sphere(state, position, velocity, 1e-3);
  state.id[0] = 42;
  return state;
}

const Vector3 middle(5e-3, 5e-3, 5e-3);

void give_patch(Scene& scene, Side side, BoundaryType type) {
  PatchSettings patch;
  patch.side = side;
  scene.fluid.mesh.patches.emplace_back("patch", patch);
  scene.fluid.boundaries["patch"].type = type;
}

TEST(Refusal, of_a_time_step_that_does_not_resolve_a_contact) {
  Scene scene = small_scene();
  scene.particles.time_step = 1e-4;
  ParticleState state = sphere_at(middle, Vector3::Zero());
  add_sphere(state, {1e-3, 1e-3, 1e-3}, Vector3::Zero(), 1e-3);
  const std::string text = message_of<ConfigError>([&] { make_engine(scene, state); });
  expect_contains(text, "particles.time_step");
  expect_contains(text, "[glass, glass]");
  // π sqrt(m / 2 / 1000 N/m) = 2.157e-4 s for m = 9.42e-6 kg.
  expect_contains(text, "2.157e-05 s");
  scene.particles.time_step = 2.15e-5;
  scene.coupling.window = 2.15e-3;
  EXPECT_NO_THROW(make_engine(scene, state));
}

TEST(Refusal, of_a_pair_without_a_law) {
  Scene scene = small_scene();
  scene.particles.materials["steel"].density = 7800;
  ParticleState state = sphere_at(middle, Vector3::Zero());
  EXPECT_NO_THROW(make_engine(scene, state));  // no steel is present
  add_sphere(state, {1e-3, 1e-3, 1e-3}, Vector3::Zero(), 1e-3);
  state.material[1] = 1;
  expect_contains(message_of<ConfigError>([&] { make_engine(scene, state); }), "[glass, steel]");
  add_pair(scene, "steel", "glass", 1000, 0.9, 0.3);
  expect_contains(message_of<ConfigError>([&] { make_engine(scene, state); }), "[steel, walls]");
}

TEST(Refusal, of_laws_that_make_no_sense) {
  const ParticleState state = sphere_at(middle, Vector3::Zero());
  Scene scene = small_scene();
  add_pair(scene, "walls", "glass", 1000, 0.9, 0.3);
  expect_contains(message_of<ConfigError>([&] { make_engine(scene, state); }), "twice");
  scene = small_scene();
  add_pair(scene, "glas", "walls", 1000, 0.9, 0.3);
  expect_contains(message_of<ConfigError>([&] { make_engine(scene, state); }), "`glas`");
  scene = small_scene();
  scene.particles.contact.pairs[0].restitution = 1.1;
  expect_contains(message_of<ConfigError>([&] { make_engine(scene, state); }), "restitution = 1.1");
}

TEST(Refusal, of_particles_that_are_not_sound) {
  const Scene scene = small_scene();
  ParticleState state = sphere_at(middle, Vector3::Zero());
  add_sphere(state, {1e-3, 1e-3, 1e-3}, Vector3::Zero(), 1e-3);
  state.id[1] = 42;
  expect_contains(message_of<ConfigError>([&] { make_engine(scene, state); }),
                  "particle 42: the id stands twice");
  state.id[1] = 43;
  state.radius[1] = 0;
  expect_contains(message_of<ConfigError>([&] { make_engine(scene, state); }),
                  "particle 43: radius");
  state.radius[1] = 1e-3;
  state.velocity[1].y() = std::numeric_limits<double>::quiet_NaN();
  expect_contains(message_of<ConfigError>([&] { make_engine(scene, state); }), "finite");
}

TEST(Refusal, of_a_period_shorter_than_a_particle) {
  Scene scene = box_scene({0.01, 2e-3, 0.01}, {Axis::y});
  add_laws(scene, 1000, 0.9, 0.3);
  const ParticleState state = sphere_at({5e-3, 1e-3, 5e-3}, Vector3::Zero());
  expect_contains(message_of<ConfigError>([&] { make_engine(scene, state); }), "the period in y");
}

TEST(Lost, particle_through_an_open_side_that_lets_none_out_is_named) {
  Scene scene = small_scene();
  give_patch(scene, Side::z_max, BoundaryType::pressure);
  scene.particles.outflow.emplace();
  const auto engine = make_engine(scene, sphere_at(middle, {0, 0, 1}));
  const ParticleState committed = engine->particles();
  const std::string text = message_of<NumericsError>([&] { run(*engine, 6e-3, 1e-5); });
  expect_contains(text, "particle 42");
  expect_contains(text, "z_max");
  expect_contains(text, "fluid.mesh.box");
  engine->rollback();
  EXPECT_EQ(engine->particles().position, committed.position);
  EXPECT_NO_THROW(run(*engine, 4e-3, 1e-5));
}

TEST(Lost, particle_beyond_a_side_that_lets_out_flies_on) {
  Scene scene = small_scene();
  give_patch(scene, Side::z_max, BoundaryType::pressure);
  const auto engine = make_engine(scene, sphere_at(middle, {0, 0, 1}));
  EXPECT_NO_THROW(run(*engine, 6e-3, 1e-5));
  const Domain domain = particle_domain(scene, make_box(scene.fluid.mesh));
  EXPECT_EQ(left_through(domain, engine->particles().position[0]), 5);
  EXPECT_EQ(left_through(domain, middle), -1);
}

TEST(Lost, only_named_patches_let_particles_out) {
  Scene scene = small_scene();
  give_patch(scene, Side::z_max, BoundaryType::pressure);
  const std::string patch = scene.fluid.mesh.patches[0].first;
  const auto lets_out = [&] { return particle_domain(scene, make_box(scene.fluid.mesh)).lets_out; };
  const std::array<bool, 6> top{false, false, false, false, false, true};
  EXPECT_EQ(lets_out(), top);
  scene.particles.outflow = std::vector<std::string>{patch};
  EXPECT_EQ(lets_out(), top);
  scene.particles.outflow->clear();
  EXPECT_EQ(lets_out(), (std::array<bool, 6>{}));
}

TEST(Lost, inlets_and_partly_open_sides_are_walls) {
  Scene scene = small_scene();
  give_patch(scene, Side::z_max, BoundaryType::velocity);
  const auto below_inlet = make_engine(scene, sphere_at(middle, {0, 0, 0.1}));
  EXPECT_NO_THROW(run(*below_inlet, 0.05, 1e-5));
  EXPECT_LT(below_inlet->particles().velocity[0].z(), 0);
  scene = small_scene();
  give_patch(scene, Side::z_max, BoundaryType::pressure);
  scene.fluid.mesh.patches[0].second.within.x = {0, 5e-3};  // the rest of the side is `walls`
  EXPECT_EQ(particle_domain(scene, make_box(scene.fluid.mesh)).sides[5], SideKind::wall);
}

TEST(Lost, nothing_holds_particles_without_walls) {
  Scene scene = small_scene();
  scene.particles.walls = WallSource::none;
  scene.particles.outflow.emplace();
  const auto engine = make_engine(scene, sphere_at(middle, {0, -1, 0}));
  expect_contains(message_of<NumericsError>([&] { run(*engine, 6e-3, 1e-5); }), "y_min");
}

TEST(Lost, particle_pressed_through_a_wall_is_named) {
  const auto engine = make_engine(small_scene(), sphere_at(middle, {50, 0, 0}));
  const std::string text = message_of<NumericsError>([&] { run(*engine, 1e-3, 1e-5); });
  expect_contains(text, "pressed through the wall x_max");
  expect_contains(text, "normal_stiffness");
}

TEST(Lost, particle_too_fast_for_its_contacts_is_named) {
  const auto engine = make_engine(small_scene(), sphere_at(middle, {200, 0, 0}));
  const std::string text = message_of<NumericsError>([&] { run(*engine, 1e-4, 1e-5); });
  expect_contains(text, "2 of its radius in one sub-step");
  expect_contains(text, "5e-06 s");
}

TEST(Lost, force_that_is_not_finite_is_named) {
  const auto engine = make_engine(small_scene(), sphere_at(middle, Vector3::Zero()));
  const std::vector<Vector3> force{{0, std::numeric_limits<double>::quiet_NaN(), 0}};
  expect_contains(message_of<NumericsError>([&] { engine->advance(1e-3, 100, force, {}); }),
                  "particle 42");
}

TEST(Lost, centres_in_one_place_are_named) {
  ParticleState state = sphere_at(middle, Vector3::Zero());
  add_sphere(state, middle, Vector3::Zero(), 1e-3);
  const auto engine = make_engine(small_scene(), state);
  expect_contains(message_of<NumericsError>([&] { run(*engine, 1e-4, 1e-6); }), "not finite");
}

TEST(Kinematic, particles_keep_their_velocity_and_wrap) {
  Scene scene = box_scene({0.01, 0.01, 0.01}, {Axis::x});
  const Mesh mesh = make_box(scene.fluid.mesh);
  const auto engine = make_kinematic_engine(scene, mesh, sphere_at(middle, {1, 0, 0}));
  EXPECT_FALSE(engine->mobile());
  const std::vector<Vector3> force{{1e3, 1e3, 1e3}};
  engine->advance(8e-3, 1, force, {});
  EXPECT_NEAR(engine->particles().position[0].x(), 3e-3, 1e-17);
  EXPECT_EQ(engine->particles().velocity[0], Vector3(1, 0, 0));
  engine->rollback();
  EXPECT_EQ(engine->particles().position[0], middle);
  engine->advance(1e-3, 1, force, {});
  engine->advance(2e-3, 1, force, {});  // again from the committed state
  engine->commit();
  EXPECT_NEAR(engine->particles().position[0].x(), 7e-3, 1e-17);
}

TEST(Kinematic, particle_that_leaves_is_named) {
  const Scene scene = box_scene({0.01, 0.01, 0.01});
  const auto engine =
      make_kinematic_engine(scene, make_box(scene.fluid.mesh), sphere_at(middle, {0, 0, 1}));
  const std::vector<Vector3> force{Vector3::Zero()};
  const std::string text = message_of<NumericsError>([&] { engine->advance(1e-2, 1, force, {}); });
  expect_contains(text, "particle 42");
  expect_contains(text, "z_max");
}

/// Planes that touch a sphere of 1 mm in the middle of a box, one at each of these directions.
Scene wedge(const std::vector<Vector3>& directions) {
  Scene scene = box_scene(Vector3::Constant(0.02));
  add_laws(scene, 1000, 0.9, 0.3);
  for (const Vector3& direction : directions) {
    SurfaceSettings plane;
    plane.type = SurfaceType::plane;
    plane.normal = -direction.normalized();
    plane.point = Vector3::Constant(0.01) + 0.999e-3 * direction.normalized();
    scene.particles.surfaces.emplace_back(fmt::format("plane{}", scene.particles.surfaces.size()),
                                          plane);
  }
  return scene;
}

TEST(Refusal, of_a_particle_wedged_into_more_places_than_a_particle_can_touch) {
  // The corners of a dodecahedron, 42 degrees apart; without some of them there is room.
  std::vector<Vector3> corners;
  const double golden = 0.5 * (1 + std::sqrt(5.0));
  for (int i = 0; i < 8; ++i) {
    corners.emplace_back(i % 2 * 2 - 1, i / 2 % 2 * 2 - 1, i / 4 * 2 - 1);
  }
  for (int i = 0; i < 4; ++i) {
    const double a = (i % 2 * 2 - 1) / golden;
    const double b = (i / 2 * 2 - 1) * golden;
    for (const Vector3& corner : {Vector3(0, a, b), Vector3(a, b, 0), Vector3(b, 0, a)}) {
      corners.push_back(corner);
    }
  }
  ParticleState state;
  add_sphere(state, Vector3::Constant(0.01), Vector3::Zero(), 1e-3);
  state.id[0] = 12;
  const auto wedged = make_engine(wedge(corners), state);
  const std::string text = message_of<NumericsError>([&] { run(*wedged, 1e-5, 1e-6); });
  expect_contains(text, "particle 12");
  expect_contains(text, "more than 16 places");
  corners.resize(16);
  const auto held = make_engine(wedge(corners), state);
  EXPECT_NO_THROW(run(*held, 1e-5, 1e-6));
}

}  // namespace
}  // namespace fluxpact
