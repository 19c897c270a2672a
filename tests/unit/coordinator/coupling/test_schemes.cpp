// Who is asked when, and what each side is told, in coupling.scheme serial and parallel: two
// made-up participants in threads of this process, behind a session like that of a run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <semaphore>
#include <thread>

#include "coordinator/coupling/run_step.hpp"
#include "proto/base/errors.hpp"
#include "proto/mesh/box.hpp"
#include "proto/participant/asked_fields.hpp"
#include "proto/participant/field_names.hpp"
#include "proto/participant/serve.hpp"
#include "proto/scene/read_scene.hpp"

namespace fluxpact {
namespace {

using ::testing::ElementsAre;

/// What the sides did, in the order in which they began it.
class Events {
 public:
  void add(std::string what) {
    const std::lock_guard lock(mutex_);
    list_.push_back(std::move(what));
  }
  std::vector<std::string> list() const {
    const std::lock_guard lock(mutex_);
    return list_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> list_;
};

/// Two sides that wait for each other; alone, each gives up.
struct Meeting {
  std::counting_semaphore<> fluid{0}, particles{0};
  std::atomic<int> missed{0};

  void come(Role role) {
    const bool is_fluid = role == Role::fluid;
    (is_fluid ? fluid : particles).release();
    // Only a failure waits as long as that.
    if (!(is_fluid ? particles : fluid).try_acquire_for(std::chrono::seconds(20))) ++missed;
  }
};

/// Commits, rolls back and names itself; the rest is that of its side.
class Side : public Participant {
 public:
  Side(Identity identity, Events& events, Meeting* meeting)
      : events_(events), meeting_(meeting), identity_(std::move(identity)) {}
  Identity identity() const override { return identity_; }
  void configure(const Scene& /*scene*/, const Mesh& mesh) override {
    cells = mesh.cells();
    faces = mesh.faces();
  }
  void commit() override { ++committed; }
  void rollback() override {}
  void snapshot(Fields& /*out*/) override {}

  int cells = 0;
  int faces = 0;
  int committed = 0;  ///< windows

 protected:
  void come() {
    if (meeting_ != nullptr) meeting_->come(identity_.role);
  }
  /// One array for each name that this side ever gives: it stays where it is.
  std::span<const double> same(const std::string& name, int size, double value) {
    return scalars_[name] = std::vector(static_cast<std::size_t>(size), value);
  }
  std::span<const Vector3> same(const std::string& name, int size, const Vector3& value) {
    return vectors_[name] = std::vector(static_cast<std::size_t>(size), value);
  }

  Events& events_;

 private:
  Meeting* meeting_;
  Identity identity_;
  std::map<std::string, std::vector<double>> scalars_;
  std::map<std::string, std::vector<Vector3>> vectors_;
};

/// At the end of window n the voidage is 0.9 − n/10 and the drag 100 n + 7; what it offers for
/// window n is 1000 n.
class Grains : public Side {
 public:
  Grains(Events& events, Meeting* meeting)
      : Side({Role::particles,
              "native",
              {field::voidage, field::drag_coefficient, field::drag_source},
              {},
              true},
             events, meeting) {}

  void start(const Fields& /*in*/, Fields& out) override { give_state(0, out); }
  void advance(const Window& window, const Fields& in, Fields& out,
               const Progress& /*progress*/) override {
    events_.add("particles advance");
    come();
    told.clear();
    for (const FieldView& view : in.views()) told.push_back(view.name);
    if (!told.empty()) velocity = in.vectors(field::velocity, cells)[0].z();
    give_state(static_cast<double>(window.step), out);
    out.add_number(field::wall_seconds, 3);
  }
  void offer(const Window& window, const Fields& in, Fields& out,
             const Progress& /*progress*/) override {
    events_.add("particles offer");
    velocity = in.vectors(field::velocity, cells)[0].z();
    give_drag(1000 * static_cast<double>(window.step), out);
    out.add_number(field::wall_seconds, 0.5);
  }

  std::vector<std::string> told;  ///< fields of the last advance
  double velocity = 0;            ///< of the fluid that they last moved under or made an offer to

 private:
  void give_drag(double drag, Fields& out) {
    out.add(field::drag_coefficient, same(field::drag_coefficient, cells, drag));
    out.add(field::drag_source, same(field::drag_source, cells, Vector3(0, 0, drag)));
  }
  void give_state(double n, Fields& out) {
    out.add(field::voidage, same(field::voidage, cells, 0.9 - 0.1 * n));
    give_drag(100 * n + 7, out);
    for (const auto* name : {field::impulse_given, field::particle_velocity})
      out.add(name, same(name, cells, Vector3::Zero().eval()));
    for (const auto* name :
         {field::particle_volume, field::particle_count, field::particle_mass, field::excess_moved})
      out.add_number(name, 0);
    if (n == 0) out.add_number(field::wall_seconds, 0);
  }
};

/// At the end of window n its velocity is 10 + n.
class Gas : public Side {
 public:
  Gas(Events& events, Meeting* meeting)
      : Side({Role::fluid, "native", {field::velocity, field::pressure_gradient}, {}, false},
             events, meeting) {}

  void start(const Fields& in, Fields& out) override {
    voidage = in.scalars(field::voidage, cells)[0];
    give_state(0, out);
  }
  void advance(const Window& window, const Fields& in, Fields& out,
               const Progress& /*progress*/) override {
    events_.add("fluid advance");
    come();
    voidage = in.scalars(field::voidage, cells)[0];
    drag = in.scalars(field::drag_coefficient, cells)[0];
    source = in.vectors(field::drag_source, cells)[0].z();
    give_state(static_cast<double>(window.step), out);
    out.add(field::impulse_taken, same(field::impulse_taken, cells, Vector3::Zero().eval()));
    for (const auto* name : {field::solver_iterations, field::closure_correction})
      out.add_number(name, 0);
    out.add_number(field::wall_seconds, 2);
  }

  double voidage = 0;
  double drag = 0;
  double source = 0;

 private:
  void give_state(double n, Fields& out) {
    out.add(field::velocity, same(field::velocity, cells, Vector3(0, 0, 10 + n)));
    out.add(field::pressure_gradient,
            same(field::pressure_gradient, cells, Vector3::Zero().eval()));
    out.add(field::face_flux, same(field::face_flux, faces, 0.0));
    out.add(field::pressure, same(field::pressure, cells, 0.0));
  }
};

Scene made_up_scene(CouplingScheme scheme) {
  Scene scene;
  scene.scene.name = "schemes";
  scene.scene.end_time = 1;
  scene.coupling.window = 0.1;
  scene.coupling.scheme = scheme;
  scene.fluid.density = 1;
  scene.fluid.viscosity = 1e-5;
  scene.fluid.mesh.box = {{0, 0, 0}, {1, 1, 2}, {1, 1, 2}};
  scene.fluid.boundaries["walls"] = {};
  scene.launch.deadline = scene.launch.start_deadline = 60;
  return scene;
}

/// A session with both made-up sides, from hello to bye.
class Schemes : public ::testing::Test {
 protected:
  void start(CouplingScheme scheme, Meeting* meeting = nullptr) {
    scene = made_up_scene(scheme);
    mesh = make_box(scene.fluid.mesh);
    const std::string told = write_scene(scene);
    scene.launch.mode = LaunchMode::external;  // nobody is started; the socket stays a private one
    session = std::make_unique<Session>(scene, mesh, "", "warn");
    grains = std::make_unique<Grains>(events, meeting);
    gas = std::make_unique<Gas>(events, meeting);
    for (Participant* side :
         {static_cast<Participant*>(grains.get()), static_cast<Participant*>(gas.get())})
      threads.emplace_back([this, side] {
        EXPECT_NO_THROW(serve(*side, {session->endpoint(), "made up", 60}));
      });
    session->greet(told, mesh);
    state = start_coupling(coupling());
  }
  Coupling coupling() { return {scene, mesh, *session}; }
  /// Both sides once, and the commit of what they sent.
  Advanced advance(std::int64_t step) {
    session->set_step(step, 0);
    const Window window{step, 0.1 * static_cast<double>(step - 1), 0.1};
    return advance_both_sides(coupling(), window, {state.offered, state.particles, state.fluid});
  }
  void commit(Advanced& next) {
    for (const Role role : {Role::particles, Role::fluid}) {
      Message message;
      message.header.type = MessageType::commit;
      session->tell(role, message);
    }
    state.offered = std::move(next.offered);
    state.particles = std::move(next.particles);
    state.fluid = std::move(next.fluid);
  }
  void TearDown() override {
    if (session) session->close();
    for (std::thread& each : threads) each.join();
  }

  Scene scene;
  Mesh mesh;
  Events events;
  std::unique_ptr<Session> session;
  std::unique_ptr<Grains> grains;
  std::unique_ptr<Gas> gas;
  std::vector<std::thread> threads;
  CommittedState state;
};

TEST_F(Schemes, in_turn_the_fluid_meets_the_particles_of_the_windows_end) {
  start(CouplingScheme::serial);
  EXPECT_EQ(gas->voidage, 0.9);
  for (int step = 1; step <= 3; ++step) {
    Advanced next = advance(step);
    EXPECT_EQ(grains->velocity, 10 + step - 1);  // of the fluid's committed state
    EXPECT_THAT(grains->told, ElementsAre(field::velocity, field::pressure_gradient));
    EXPECT_EQ(gas->voidage, 0.9 - 0.1 * step);
    EXPECT_EQ(gas->drag, 100 * step + 7);
    EXPECT_EQ(gas->source, 100 * step + 7);
    EXPECT_EQ(next.wall_particles, 3);
    EXPECT_EQ(next.wall_fluid, 2);
    EXPECT_EQ(next.wall_both, 0);
    commit(next);
  }
  EXPECT_THAT(events.list(), ElementsAre("particles advance", "fluid advance", "particles advance",
                                         "fluid advance", "particles advance", "fluid advance"));
}

TEST_F(Schemes, at_once_the_fluid_meets_the_offer_and_the_voidage_of_the_windows_start) {
  Meeting meeting;
  start(CouplingScheme::parallel, &meeting);
  for (int step = 1; step <= 3; ++step) {
    Advanced next = advance(step);
    EXPECT_EQ(grains->velocity, 10 + step - 1);
    EXPECT_TRUE(grains->told.empty());  // they move under what they were told with the offer
    EXPECT_EQ(gas->voidage, 0.9 - 0.1 * (step - 1));
    EXPECT_EQ(gas->drag, 1000 * step);
    EXPECT_EQ(gas->source, 1000 * step);
    EXPECT_EQ(next.wall_particles, 3.5);  // with the offer
    EXPECT_EQ(next.wall_fluid, 2);
    EXPECT_EQ(next.wall_both, 2);
    commit(next);
  }
  EXPECT_EQ(meeting.missed, 0);  // each was at work while the other was
  EXPECT_EQ(events.list()[0], "particles offer");
  EXPECT_EQ(events.list()[3], "particles offer");
}

TEST_F(Schemes, what_is_not_committed_is_told_again) {
  start(CouplingScheme::serial);
  advance(1);
  for (const Role role : {Role::particles, Role::fluid}) {
    Message message;
    message.header.type = MessageType::rollback;
    session->tell(role, message);
  }
  advance(1);
  EXPECT_EQ(grains->velocity, 10);  // the frames of the committed state were shared, not used up
  EXPECT_EQ(gas->drag, 107);
}

}  // namespace
}  // namespace fluxpact
