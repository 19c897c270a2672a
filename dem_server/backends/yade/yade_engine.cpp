#include "dem_server/backends/yade/yade_engine.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "dem_server/backends/domain.hpp"
#include "dem_server/backends/engine_state.hpp"
#include "dem_server/backends/native/soundness.hpp"
#include "dem_server/backends/native/step_limit.hpp"
#include "dem_server/backends/particle_rows.hpp"
#include "dem_server/backends/yade/yade_process.hpp"
#include "dem_server/backends/yade/yade_springs.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

constexpr double skin_per_radius = 0.05;  // bodies beyond touching that YADE's collider keeps

/// Contacts with what they remember. `pair`: two bodies each, walls first, then the particles.
struct Contacts {
  std::vector<int> pair;
  std::vector<Vector3> shear_force;  ///< [N]
  std::vector<Vector3> normal;       ///< at the last sub-step

  int size() const { return static_cast<int>(normal.size()); }
};

YadeSpheres spheres_like(const ParticleState& particles, int row) {
  return {particles.radius[row], particles.density[row], particles.material[row]};
}

/// The free particles, or those to come. Throws ConfigError if there are none.
YadeSpheres free_spheres(const Scene& scene, const ParticleState& particles) {
  for (int row = 0; row < particles.size(); ++row) {
    if (!particles.is_fixed(row)) return spheres_like(particles, row);
  }
  const auto& materials = scene.particles.materials;
  for (const InflowSettings& inflow : scene.particles.inflow) {
    const auto found = materials.find(inflow.material);
    if (found == materials.end()) continue;  // an error of the inflow's own
    return {inflow.diameter / 2, found->second.density,
            static_cast<int>(std::distance(materials.begin(), found))};
  }
  throw ConfigError(
      "particles.backend: yade has nothing to move: no particle of the scene is free and none "
      "comes in; use `kinematic`");
}

void require_alike(const YadeSpheres& spheres, const ParticleState& particles) {
  for (int row = 0; row < particles.size(); ++row) {
    if (particles.is_fixed(row)) continue;
    const YadeSpheres own = spheres_like(particles, row);
    if (own.radius == spheres.radius && own.density == spheres.density &&
        own.material == spheres.material) {
      continue;
    }
    throw ConfigError(
        "particle {}: radius {} m, density {} kg/m³, material {}, but others have {} m, {} kg/m³, "
        "{}; particles.backend: yade needs free particles that are all alike, use another engine",
        particles.id[row], own.radius, own.density, own.material, spheres.radius, spheres.density,
        spheres.material);
  }
}

/// `kinds` is filled, and must live as long as the question.
void add_particles(const ParticleState& particles, std::vector<int>& kinds, Message& question) {
  for (int row = 0; row < particles.size(); ++row) kinds.push_back(yade_kind(particles, row));
  Fields fields;
  fields.add("position", particles.position);
  fields.add("velocity", particles.velocity);
  fields.add("spin", particles.spin);
  fields.add("radius", particles.radius);
  add_fields(question, fields);
  add_ints(question, "material", kinds);
}

class YadeEngine final : public ParticleEngine {
 public:
  YadeEngine(const Scene& scene, const Mesh& mesh, ParticleState initial)
      : domain_(particle_domain(scene, mesh)),
        laws_(scene.particles),
        gravity_(scene.scene.gravity),
        flow_(particles_flow(scene)),
        presented_(checked_rows(std::move(initial), laws_.walls())),
        spheres_(free_spheres(scene, presented_)),
        materials_(yade_materials(laws_, spheres_)) {
    require_alike(spheres_, presented_);
    refuse_periods();
    set_limit();
    check_time_step(limit_, scene.coupling.window / sub_steps(scene));
    check({0, 0, 0});
    // Sooner than the coordinator takes us for lost.
    yade_.emplace(yade_adapter(), Milliseconds(std::lround(750 * scene.launch.deadline)));
    configure();
    build(presented_, {});
  }

  const ParticleState& particles() const override { return presented_; }
  bool mobile() const override { return true; }
  EngineCounters counters() const override { return {sub_steps_, 0, 0}; }

  void advance(double window, int sub_steps, std::span<const Vector3> force,
               const Progress& progress) override;
  void exchange(std::span<const int> leaving, const ParticleState& entering) override;
  void commit() override;
  void rollback() override;
  void store(EngineState& state) const override;
  void restore(const Fields& fields) override;

 private:
  static constexpr int state_version = 1;

  void refuse_periods() const;
  void set_limit();
  void configure();
  void build(const ParticleState& particles, const Contacts& contacts) const;
  Contacts contacts() const;
  void check(const SubStep& sub_step) const;
  int walls() const { return static_cast<int>(wall_axis_.size()); }

  Domain domain_;
  ContactLaws laws_;
  Vector3 gravity_;
  bool flow_;  ///< particles come and go
  ParticleState presented_;
  YadeSpheres spheres_;
  YadeMaterials materials_;
  StepLimit limit_;
  std::vector<int> wall_axis_;
  mutable std::optional<YadeProcess> yade_;  // `store` asks it

  bool has_candidate_ = false;
  ParticleState before_;  ///< the committed state, while there is a candidate
  std::int64_t sub_steps_ = 0;
  // Of the newest window.
  std::vector<Vector3> drive_;      ///< [N] of the window and gravity
  std::vector<Vector3> half_kick_;  ///< [m/s]
  std::vector<Vector3> velocity_;   ///< [m/s] half a sub-step back
};

void YadeEngine::refuse_periods() const {
  for (int axis = 0; axis < 3; ++axis) {
    if (!domain_.periodic(axis)) continue;
    throw ConfigError(
        "fluid.mesh.periodic: {} is periodic, and particles.backend: yade has no periodic sides "
        "beside walls; use another engine",
        "xyz"[axis]);
  }
}

/// Of the particles, and of others like them that may come.
void YadeEngine::set_limit() {
  ParticleState all = presented_;
  const std::size_t more = flow_ ? 2 : 0;
  const std::size_t count = all.id.size() + more;
  if (!all.fixed.empty()) all.fixed.resize(count, 0);
  all.id.resize(count, 0);
  all.velocity.resize(count, Vector3::Zero());
  all.radius.resize(count, spheres_.radius);
  all.density.resize(count, spheres_.density);
  all.material.resize(count, spheres_.material);
  std::vector<WallsPresent> walls;
  if (std::ranges::count(domain_.sides, SideKind::wall) > 0) walls.push_back({laws_.walls(), 0});
  limit_ = step_limit(laws_, all, walls);
}

void YadeEngine::configure() {
  std::vector<int> sense;
  std::vector<double> at;
  for (int side = 0; side < 6; ++side) {
    if (domain_.sides[side] != SideKind::wall) continue;
    wall_axis_.push_back(side / 2);
    sense.push_back(side % 2 == 0 ? 1 : -1);
    at.push_back(domain_.plane(side));
  }
  Message question = yade_question("configure");
  question.header.body["density"] = spheres_.density;
  question.header.body["skin"] = skin_per_radius * spheres_.radius;
  Fields fields;
  fields.add("kn", materials_.kn);
  fields.add("ks", materials_.ks);
  fields.add("cn", materials_.cn);
  fields.add("cs", materials_.cs);
  fields.add("friction_angle", materials_.friction_angle);
  fields.add("wall_at", at);
  add_fields(question, fields);
  add_ints(question, "wall_axis", wall_axis_);
  add_ints(question, "wall_sense", sense);
  yade_->ask(question, {});
}

/// Bodies and contacts of YADE anew.
void YadeEngine::build(const ParticleState& particles, const Contacts& contacts) const {
  Message question = yade_question("build");
  std::vector<int> kinds;
  add_particles(particles, kinds, question);
  Fields fields;
  fields.add("shear_force", contacts.shear_force);
  fields.add("normal", contacts.normal);
  add_fields(question, fields);
  add_ints(question, "contact", contacts.pair);
  yade_->ask(question, {});
}

Contacts YadeEngine::contacts() const {
  Message question = yade_question("contacts");
  const Message answer = yade_->ask(question, {});
  Contacts contacts;
  const std::span<const int> pair = ints(answer, "contact");
  const Fields fields = fields_of(answer);
  const auto count = static_cast<int>(pair.size() / 2);
  const auto shear_force = fields.vectors("shear_force", count);
  const auto normal = fields.vectors("normal", count);
  contacts.pair.assign(pair.begin(), pair.end());
  contacts.shear_force.assign(shear_force.begin(), shear_force.end());
  contacts.normal.assign(normal.begin(), normal.end());
  return contacts;
}

void YadeEngine::check(const SubStep& sub_step) const {
  for (int row = 0; row < presented_.size(); ++row) {
    const Motion motion{presented_.position[row], presented_.velocity[row], presented_.radius[row]};
    if (!is_sound(domain_, motion, sub_step.time_step))
      refuse(domain_, presented_.id[row], motion, sub_step);
  }
}

void YadeEngine::advance(double window, int sub_steps, std::span<const Vector3> force,
                         const Progress& progress) {
  if (has_candidate_) rollback();
  const auto count = static_cast<std::size_t>(presented_.size());
  if (force.size() != count)
    throw NumericsError("force on the particles: {} rows for {} particles", force.size(), count);
  const double time_step = window / sub_steps;
  check_time_step(limit_, time_step);
  drive_.assign(count, Vector3::Zero());
  half_kick_.assign(count, Vector3::Zero());
  velocity_.assign(count, Vector3::Zero());
  for (std::size_t row = 0; row < count; ++row) {
    if (!force[row].allFinite()) refuse_force(presented_.id[row], force[row]);
    if (presented_.is_fixed(static_cast<int>(row))) continue;
    const double mass = sphere_mass(presented_.radius[row], presented_.density[row]);
    drive_[row] = force[row] + mass * gravity_;
    half_kick_[row] = (0.5 * time_step / mass) * drive_[row];
    velocity_[row] = presented_.velocity[row] - half_kick_[row];
  }
  Message question = yade_question("run");
  question.header.body["time_step"] = time_step;
  question.header.body["sub_steps"] = std::int64_t{sub_steps};
  Fields fields;
  fields.add("force", drive_);
  fields.add("velocity", velocity_);
  add_fields(question, fields);
  before_ = presented_;
  has_candidate_ = true;
  const Message answer = yade_->ask(question, progress);
  const Fields moved = fields_of(answer);
  const auto position = moved.vectors("pos", presented_.size());
  const auto velocity = moved.vectors("vel", presented_.size());
  const auto spin = moved.vectors("angVel", presented_.size());
  for (std::size_t row = 0; row < count; ++row) {
    if (presented_.is_fixed(static_cast<int>(row))) continue;
    presented_.position[row] = position[row];
    presented_.velocity[row] = velocity[row] + half_kick_[row];
    presented_.spin[row] = spin[row];
  }
  sub_steps_ += sub_steps;
  check({std::isfinite(limit_.longest) ? time_step : 0, sub_steps, sub_steps});
}

void YadeEngine::exchange(std::span<const int> leaving, const ParticleState& entering) {
  const ParticleState checked = checked_rows(entering, laws_.walls());
  require_alike(spheres_, checked);
  exchange_rows(leaving, checked, presented_);
  Message question = yade_question("exchange");
  std::vector<int> kinds;
  add_particles(checked, kinds, question);
  add_ints(question, "leaving", leaving);
  yade_->ask(question, {});
}

void YadeEngine::commit() {
  if (!has_candidate_) return;
  Message question = yade_question("commit");
  yade_->ask(question, {});
  has_candidate_ = false;
}

void YadeEngine::rollback() {
  if (!has_candidate_) return;
  has_candidate_ = false;
  std::swap(presented_, before_);
  yade_->rollback();
}

void YadeEngine::store(EngineState& state) const {
  if (has_candidate_)
    throw ProtocolError("the engine yade cannot store its state: a candidate is pending");
  const Contacts kept = contacts();
  build(presented_, kept);
  state.add_number("yade_state", state_version);
  state.add_number("walls", walls());
  state.add_number("contacts", kept.size());
  store_rows(presented_, state);
  state.add_vectors("position") = presented_.position;
  state.add_vectors("velocity") = presented_.velocity;
  state.add_vectors("spin") = presented_.spin;
  std::vector<double>& one = state.add_scalars("contact_one");
  std::vector<double>& other = state.add_scalars("contact_other");
  for (int contact = 0; contact < kept.size(); ++contact) {
    one.push_back(kept.pair[std::size_t{2} * contact]);
    other.push_back(kept.pair[std::size_t{2} * contact + 1]);
  }
  state.add_vectors("contact_shear_force") = kept.shear_force;
  state.add_vectors("contact_normal") = kept.normal;
}

void YadeEngine::restore(const Fields& fields) {
  const StateReader state(fields, "yade_state", state_version);
  state.require("walls", walls(), "number of walls");
  ParticleState stored = restored_rows(state, laws_.walls(), presented_, flow_);
  require_alike(spheres_, stored);
  const auto take = [&](const char* name, std::size_t rows, std::vector<Vector3>& values) {
    const auto given = state.vectors(name, rows);
    values.assign(given.begin(), given.end());
  };
  take("position", stored.id.size(), stored.position);
  take("velocity", stored.id.size(), stored.velocity);
  take("spin", stored.id.size(), stored.spin);
  Contacts kept;
  const auto count = static_cast<std::size_t>(state.count("contacts", 0x1p31));
  const double bodies = walls() + stored.size();
  const auto one = state.wholes<int>("contact_one", count, bodies);
  const auto other = state.wholes<int>("contact_other", count, bodies);
  for (std::size_t contact = 0; contact < count; ++contact) {
    kept.pair.push_back(one[contact]);
    kept.pair.push_back(other[contact]);
  }
  take("contact_shear_force", count, kept.shear_force);
  take("contact_normal", count, kept.normal);
  rollback();
  build(stored, kept);
  presented_ = std::move(stored);
}

}  // namespace

std::unique_ptr<ParticleEngine> make_yade_engine(const Scene& scene, const Mesh& mesh,
                                                 ParticleState initial) {
  return std::make_unique<YadeEngine>(scene, mesh, std::move(initial));
}

}  // namespace fluxpact
