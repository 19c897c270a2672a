// The state of an engine, stored in a file and taken back: as if nothing had been in between.
#include <algorithm>
#include <span>

#include "dem_server/backends/engine_state.hpp"
#include "dem_server/backends/kinematic/kinematic_engine.hpp"
#include "proto/io/hdf5.hpp"
#include "tests/unit/dem_server/native/random_cloud.hpp"
#include "tests/unit/dem_server/walls/surfaces.hpp"
#include "tests/unit/proto/io/scratch_folder.hpp"

namespace fluxpact {
namespace {

using MakeEngine = std::unique_ptr<ParticleEngine> (*)(const Scene&, const Mesh&, ParticleState);

void write(const Fields& fields, Hdf5File& file) {
  for (const FieldView& view : fields.views()) {
    const auto columns = static_cast<std::size_t>(view.components);
    file.write("/state/" + view.name, view.values, {view.values.size() / columns, columns}, "1");
  }
  file.make_group("/state");
  for (const auto& [name, value] : fields.numbers()) file.set_attribute("/state", name, value);
}

/// Through a file: what comes out is in nothing but it.
void pass_through_file(const EngineState& state, EngineState& read) {
  const ScratchFolder folder;
  const auto path = folder.path() / "state.h5";
  const Fields fields = state.fields();
  {
    Hdf5File file = Hdf5File::create(path);
    write(fields, file);
    file.close();
  }
  const Hdf5File file = Hdf5File::open(path);
  for (const std::string& name : file.members("/state")) {
    const std::string dataset = "/state/" + name;
    const std::vector<double> values = file.read_doubles(dataset);
    if (file.shape(dataset)[1] == 1) {
      read.add_scalars(name) = values;
    } else {
      const auto rows = as_vectors(values);
      read.add_vectors(name).assign(rows.begin(), rows.end());
    }
  }
  for (const auto& [name, value] : fields.numbers()) {
    read.add_number(name, file.real_attribute("/state", name));
  }
}

/// Everything that the two hold: positions, velocities, spins, forces, springs, lists, clocks.
void expect_same_state(const ParticleEngine& a, const ParticleEngine& b) {
  EngineState one;
  EngineState other;
  a.store(one);
  b.store(other);
  const Fields left = one.fields();
  const Fields right = other.fields();
  for (const auto& [name, value] : left.numbers()) {
    if (name == "sub_steps" || name == "rebuilds") continue;  // the work done, repeats included
    EXPECT_EQ(value, right.number(name)) << name;
  }
  ASSERT_EQ(left.views().size(), right.views().size());
  for (std::size_t k = 0; k < left.views().size(); ++k) {
    const FieldView& x = left.views()[k];
    const FieldView& y = right.views()[k];
    ASSERT_EQ(x.name, y.name);
    ASSERT_EQ(x.values.size(), y.values.size()) << x.name;
    EXPECT_TRUE(std::ranges::equal(std::as_bytes(x.values), std::as_bytes(y.values))) << x.name;
  }
  const auto same = [](std::span<const Vector3> x, std::span<const Vector3> y) {
    return std::ranges::equal(std::as_bytes(x), std::as_bytes(y));
  };
  EXPECT_TRUE(same(a.particles().position, b.particles().position));
  EXPECT_TRUE(same(a.particles().velocity, b.particles().velocity));
  EXPECT_TRUE(same(a.particles().spin, b.particles().spin));
}

/// A scene, who is in it at time 0, and whether some leave and enter in every window.
struct Life {
  Scene scene;
  ParticleState start;
  bool flow = false;
};

constexpr int count = 800;

Life life(std::vector<Axis> periodic) {
  Life life{cloud_scene(std::move(periodic)), random_cloud(count, 1.0)};
  life.scene.scene.gravity = {0, 0, -9.81};
  life.scene.particles.insertion.emplace_back();
  return life;
}

/// Of several laws: contacts tell which is theirs.
Life with_rough_walls() {
  Life life = fluxpact::life({Axis::y});
  life.scene.particles.contact.pairs.back().friction = 0.8;
  return life;
}

Life with_liquid_and_rolling_springs() {
  Life life = fluxpact::life({Axis::x, Axis::y});
  ContactSettings& contact = life.scene.particles.contact;
  contact.rolling = RollingLaw::spring_dashpot;
  contact.cohesion = CohesionLaw::liquid_bridge;
  for (PairSettings& pair : contact.pairs) {
    pair.rolling_friction = 0.1;
    pair.liquid_volume = 1e-12;
    pair.surface_tension = 0.07;
    pair.contact_angle = 0.1;
  }
  return life;
}

Life with_adhesion() {
  Life life = fluxpact::life({Axis::y});
  MaterialSettings& glass = life.scene.particles.materials["glass"];
  glass.youngs_modulus = 5e6;
  glass.poisson_ratio = 0.3;
  ContactSettings& contact = life.scene.particles.contact;
  contact.law = ContactLaw::hertz;
  contact.walls = WallMaterialSettings{5e6, 0.3};
  contact.cohesion = CohesionLaw::jkr;
  for (PairSettings& pair : contact.pairs) {
    pair.normal_stiffness.reset();
    pair.work_of_adhesion = 0.05;
  }
  return life;
}

Life without_friction() {
  Life life = fluxpact::life({});
  for (PairSettings& pair : life.scene.particles.contact.pairs) pair.friction = 0;
  return life;
}

Life with_coming_and_going() {
  Life life = fluxpact::life({Axis::y});
  life.scene.particles.inflow.emplace_back();
  life.flow = true;
  return life;
}

/// A floor that shakes and a paddle that turns.
Life stirred(const StlFile& paddle) {
  Life life = fluxpact::life({});
  SurfaceSettings floor = plane(Vector3(0, 0, 2e-3), Vector3::UnitZ());
  floor.motion.type = MotionType::vibration;
  floor.motion.amplitude = {0, 0, 0.3e-3};
  floor.motion.frequency = 100;
  SurfaceSettings blade = paddle.surface();
  blade.motion.type = MotionType::rotation;
  blade.motion.point = Vector3::Constant(cloud_box / 2);
  blade.motion.direction = Vector3::UnitZ();
  blade.motion.rate = 30;
  life.scene.particles.surfaces.emplace_back("floor", floor);
  life.scene.particles.surfaces.emplace_back("blade", blade);
  ParticleState kept;
  for (int row = 0; row < life.start.size(); ++row) {
    const Vector3& x = life.start.position[row];
    const double radius = life.start.radius[row];
    if (x.z() - 2.3e-3 < radius || std::abs(x.x() - cloud_box / 2) < radius) continue;
    add_sphere(kept, x, life.start.velocity[row], radius);
  }
  life.start = kept;
  return life;
}

TriangleSurface paddle_shape() {
  const Vector3 corner(cloud_box / 2, 5e-3, 5e-3);
  return sheet(corner, {0, 0.02, 0}, {0, 0, 0.02}, 9, 9);
}

/// Windows `first` ... `last`, each with forces of its own, several new lists (speeds of 1 m/s,
/// skins of 0.3 mm, 0.3 ms) and, with flow, two that leave and one that enters.
void advance(ParticleEngine& engine, const Life& life, int first, int last) {
  for (int window = first; window <= last; ++window) {
    std::vector<Vector3> force;
    for (int i = 0; i < engine.particles().size(); ++i) {
      force.emplace_back(1e-6 * (i % 3), 1e-6 * window, 2e-6 * (i % 5));
    }
    engine.advance(3e-4, 150, force, {});
    if (life.flow) {
      const ParticleState& now = engine.particles();
      ParticleState entering;
      add_sphere(entering, now.position[7], {0.1, 0, -0.2}, 0.5 * now.radius[7]);
      entering.id[0] = 5000 + window;
      engine.exchange(std::vector<int>{3, 7}, entering);
    }
    engine.commit();
  }
}

struct Setting {
  Precision precision;
  int threads_before, threads_after;
};

/// 4 windows, and 2 windows, a file, a new engine, 2 windows: all bits are the same.
void expect_no_seam(Life life, const Setting& setting, MakeEngine make = &make_native_engine) {
  const auto engine_with = [&](int threads, const ParticleState& particles) {
    life.scene.particles.numerics.precision = setting.precision;
    life.scene.particles.numerics.threads = threads;
    return make(life.scene, make_box(life.scene.fluid.mesh), particles);
  };
  const auto straight = engine_with(setting.threads_before, life.start);
  advance(*straight, life, 1, 2);
  EngineState stored;
  straight->store(stored);
  EngineState read;
  pass_through_file(stored, read);
  const auto restored = engine_with(setting.threads_after, life.start);
  restored->restore(read.fields());
  expect_same_state(*straight, *restored);
  advance(*straight, life, 3, 4);
  advance(*restored, life, 3, 4);
  expect_same_state(*straight, *restored);
  EXPECT_EQ(straight->counters().sub_steps, restored->counters().sub_steps);
  EXPECT_EQ(straight->counters().rebuilds, restored->counters().rebuilds);
  // And back: rolled back, the restored state is there again.
  restored->restore(read.fields());
  const std::vector<Vector3> none(restored->particles().size(), Vector3::Zero());
  restored->advance(3e-4, 150, none, {});
  restored->rollback();
  advance(*restored, life, 3, 4);
  expect_same_state(*straight, *restored);
}

void PrintTo(const Setting& setting, std::ostream* out) {
  *out << (setting.precision == Precision::full ? "double" : "mixed");
}

class StoredState : public testing::TestWithParam<Setting> {};

TEST_P(StoredState, goes_on_with_liquid_bridges_and_rolling_springs_over_periodic_sides) {
  expect_no_seam(with_liquid_and_rolling_springs(), GetParam());
}
TEST_P(StoredState, goes_on_with_several_laws) { expect_no_seam(with_rough_walls(), GetParam()); }
TEST_P(StoredState, goes_on_with_adhesion_and_friction_of_elastic_spheres) {
  expect_no_seam(with_adhesion(), GetParam());
}
TEST_P(StoredState, goes_on_without_friction) { expect_no_seam(without_friction(), GetParam()); }
TEST_P(StoredState, goes_on_while_particles_come_and_go) {
  expect_no_seam(with_coming_and_going(), GetParam());
}
TEST_P(StoredState, goes_on_between_moving_walls) {
  const StlFile paddle(paddle_shape());
  expect_no_seam(stirred(paddle), GetParam());
}
TEST_P(StoredState, goes_on_with_fixed_particles) {
  Life life = fluxpact::life({});
  life.start.fixed.assign(life.start.id.size(), 0);
  for (std::size_t row = 0; row < life.start.fixed.size(); row += 5) {
    life.start.fixed[row] = 1;
    life.start.velocity[row].setZero();
  }
  expect_no_seam(life, GetParam());
}

INSTANTIATE_TEST_SUITE_P(Settings, StoredState,
                         testing::Values(Setting{Precision::full, 1, 2},
                                         Setting{Precision::mixed, 2, 1}),
                         [](const auto& setting) {
                           return setting.index == 0 ? "double_1_to_2_threads"
                                                     : "mixed_2_to_1_threads";
                         });

TEST(StoredStateOfKinematicParticles, goes_on_with_the_same_bits) {
  Life life = with_coming_and_going();
  for (Vector3& velocity : life.start.velocity) velocity *= 0.3;  // nobody reaches a wall
  expect_no_seam(life, {Precision::full, 1, 1}, &make_kinematic_engine);
}

TEST(StateStored, of_nobody_and_of_one_is_fine) {
  for (const int spheres : {0, 1}) {
    Life life = fluxpact::life({});
    life.start = {};
    if (spheres == 1) add_sphere(life.start, Vector3::Constant(0.01), {0.1, 0, 0}, 1e-3);
    expect_no_seam(life, {Precision::full, 1, 1});
  }
}

// ---- refusals ----

std::unique_ptr<ParticleEngine> engine_of(const Life& life) {
  return make_native_engine(life.scene, make_box(life.scene.fluid.mesh), life.start);
}

class RefusedState : public testing::Test {
 protected:
  void SetUp() override {
    const auto engine = engine_of(life_);
    advance(*engine, life_, 1, 1);
    engine->store(state_);
  }
  /// What an engine for `life` says to the state, and that it is unharmed.
  static std::string said(const Life& life, const Fields& state) {
    const auto engine = engine_of(life);
    const auto other = engine_of(life);
    std::string text = message_of<ConfigError>([&] { engine->restore(state); });
    expect_same_state(*engine, *other);
    return text;
  }
  /// The state without or with another content of an array.
  Fields with(const std::string& name, std::span<const double> values, bool keep) const {
    Fields changed;
    const Fields all = state_.fields();
    for (const FieldView& view : all.views()) {
      if (view.name != name) {
        if (view.components == 1) changed.add(view.name, view.values);
        if (view.components == 3) changed.add(view.name, as_vectors(view.values));
      } else if (keep) {
        changed.add(view.name, values);
      }
    }
    for (const auto& [number, value] : all.numbers()) changed.add_number(number, value);
    return changed;
  }
  std::vector<double> array(const std::string& name) const {
    const Fields all = state_.fields();
    for (const FieldView& view : all.views()) {
      if (view.name == name) return {view.values.begin(), view.values.end()};
    }
    ADD_FAILURE() << name;
    return {};
  }

  Life life_ = with_rough_walls();
  EngineState state_;
};

TEST_F(RefusedState, of_another_precision) {
  Life other = life_;
  other.scene.particles.numerics.precision = Precision::mixed;
  expect_contains(said(other, state_.fields()), "particles.numerics.precision");
}

TEST_F(RefusedState, of_another_scene) {
  Life wider = life_;
  wider.scene.fluid.mesh.box.upper.x() *= 1.1;
  expect_contains(said(wider, state_.fields()), "domain_x_max");
  Life walled = life_;
  walled.scene.fluid.mesh.periodic.clear();
  expect_contains(said(walled, state_.fields()), "kind_y_min");
  Life wet = with_liquid_and_rolling_springs();
  wet.scene.fluid.mesh.periodic = {Axis::y};
  expect_contains(said(wet, state_.fields()), "spring_rows");
  Life fewer = life_;
  fewer.start = random_cloud(count - 1, 1.0);
  expect_contains(said(fewer, state_.fields()), "800 particles");
  Life more_materials = life_;
  more_materials.scene.particles.materials["steel"].density = 7800;
  expect_contains(said(more_materials, state_.fields()), "materials");
}

TEST_F(RefusedState, of_particles_too_light_for_the_step) {
  Life heavy = with_coming_and_going();
  const auto engine = engine_of(heavy);
  EngineState state;
  engine->store(state);
  for (double& density : heavy.start.density) density *= 100;
  heavy.scene.particles.time_step = heavy.scene.coupling.window = 1e-4;
  expect_contains(said(heavy, state.fields()), "particles.time_step");
}

TEST_F(RefusedState, of_another_engine_or_form) {
  const auto kinematic =
      make_kinematic_engine(life_.scene, make_box(life_.scene.fluid.mesh), life_.start);
  expect_contains(message_of<ConfigError>([&] { kinematic->restore(state_.fields()); }),
                  "another particle engine");
  Fields newer = state_.fields();
  newer.add_number("native_state", 99);
  expect_contains(said(life_, newer), "form 99");
}

TEST_F(RefusedState, with_an_array_missing_misshaped_or_damaged) {
  const Fields whole = state_.fields();
  for (const FieldView& view : whole.views()) {
    expect_contains(said(life_, with(view.name, {}, false)), "`" + view.name + "`");
    std::vector<double> more(view.values.begin(), view.values.end());
    more.push_back(0);
    expect_contains(said(life_, with(view.name, more, true)), view.name);
  }
  for (const char* name : {"inner_other", "inner_mine", "inner_law", "image_shift", "row", "id",
                           "material", "planes_side", "inner_of_block"}) {
    for (const double wrong : {-1.0, 1e15, 0.5}) {
      std::vector<double> values = array(name);
      ASSERT_FALSE(values.empty()) << name;
      values.back() = wrong;
      if (std::string_view(name) == "id" && wrong == 1e15) continue;  // an id may be large
      expect_contains(said(life_, with(name, values, true)), name);
    }
  }
  std::vector<double> twice = array("row");
  twice[0] = twice[1];
  expect_contains(said(life_, with("row", twice, true)), "twice");
}

TEST(StateStored, is_of_the_committed_state_only) {
  const Life life = fluxpact::life({});
  for (const MakeEngine make : {&make_native_engine, &make_kinematic_engine}) {
    const auto engine = make(life.scene, make_box(life.scene.fluid.mesh), life.start);
    const std::vector<Vector3> none(engine->particles().size(), Vector3::Zero());
    engine->advance(1e-5, 5, none, {});
    EngineState state;
    EXPECT_THROW(engine->store(state), ProtocolError);
    engine->rollback();
    EngineState now;
    engine->store(now);
  }
}

}  // namespace
}  // namespace fluxpact
