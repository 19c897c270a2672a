#include "dem_server/backends/native/native_engine.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>

#include "dem_server/backends/native/sub_step.hpp"
#include "dem_server/backends/particle_rows.hpp"
#include "dem_server/walls/walls.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

/// The sub-step knows the sides of the box only.
void refuse_surfaces(const Walls& walls) {
  if (walls.empty()) return;
  throw ConfigError(
      "particles.surfaces: the native backend does not know walls beside the sides of a box yet "
      "(here: `{}`); remove the surfaces, use a box mesh, or a fluid without particles "
      "(interphase.voidage: prescribed)",
      walls[0].name);
}

/// List pairs per particle against rebuilds: 0.15 diameters is near the best from a bed at rest to
/// one that bubbles.
constexpr double skin_per_diameter = 0.15;

/// What a rollback brings back beside the list itself, which the window does not touch.
struct SavedState {
  bool valid = false;
  Spheres spheres;
  std::size_t list = 0;
  std::vector<std::vector<Spring>> pair_springs;  // by block
  std::vector<std::vector<Spring>> wall_springs;
};

class NativeEngine final : public ParticleEngine {
 public:
  NativeEngine(const Scene& scene, const Mesh& mesh, ParticleState initial);

  const ParticleState& particles() const override { return presented_; }
  bool mobile() const override { return true; }
  void advance(double window, int sub_steps, std::span<const Vector3> force,
               const Progress& progress) override;
  void commit() override;
  void rollback() override;

 private:
  void size_up();
  void load_rows();
  void check_step(double time_step) const;
  void set_drive(std::span<const Vector3> force);
  void sort_and_list(bool carry_springs);
  void wrap_and_sort();
  void check_particles(double time_step, int sub_step, int sub_steps) const;
  [[noreturn]] void refuse(int row, double time_step, int sub_step, int sub_steps) const;
  bool is_sound(int place, double time_step) const;
  void present();
  void save();
  StepContext context() const {
    return {blocks_,   laws_,   domain_, drive_, any_periodic_ ? shifts_.data() : nullptr,
            friction_, threads_};
  }

  Domain domain_;
  ContactLaws laws_;
  std::array<Vector3, 27> shifts_;
  Vector3 gravity_;
  bool friction_;
  bool any_periodic_;
  bool any_wall_;
  int threads_;
  StepLimit limit_;
  double largest_diameter_ = 0;
  double skin_ = 0;
  Blocks blocks_;

  ParticleState presented_;
  Spheres spheres_;
  std::array<ContactList, 3> lists_;  // in use, kept for rollback, being made
  std::size_t list_ = 0;
  std::vector<Load> outbox_;
  std::vector<Vector3> drive_;  // [m/s²] in cell order
  SavedState saved_;
  bool has_candidate_ = false;

  // Kept between rebuilds so that they need no memory of their own each time.
  CellGrid grid_;
  Resorting resorting_;
  Spheres sorted_;
  std::vector<Vector3> sorted_drive_;
};

NativeEngine::NativeEngine(const Scene& scene, const Mesh& mesh, ParticleState initial)
    : domain_(particle_domain(scene, mesh)),
      laws_(scene.particles),
      shifts_(shift_vectors(domain_)),
      gravity_(scene.scene.gravity),
      friction_(laws_.any_friction()),
      presented_(checked_rows(std::move(initial), laws_.walls())) {
  const auto is = [this](SideKind kind) {
    return std::find(domain_.sides.begin(), domain_.sides.end(), kind) != domain_.sides.end();
  };
  any_periodic_ = is(SideKind::periodic);
  any_wall_ = is(SideKind::wall);
  size_up();
  const int asked = scene.particles.numerics.threads;
  threads_ = std::clamp(asked > 0 ? asked : omp_get_max_threads(), 1, std::max(1, blocks_.count()));
  limit_ = step_limit(laws_, presented_, any_wall_);
  const double time_step = scene.coupling.window / sub_steps(scene);
  check_step(time_step);
  load_rows();
  check_particles(0, 0, 0);
  sort_and_list(false);
  // Forces of contacts that exist from the start, with their springs at rest.
  add_contacts(context(), 0, lists_[list_], outbox_, spheres_);
  settle(context(), 0, lists_[list_], outbox_, spheres_);
  present();
}

/// Lengths that follow from the particles, and how they are cut into blocks.
void NativeEngine::size_up() {
  const int count = presented_.size();
  double mean = 0;
  for (const double radius : presented_.radius) {
    largest_diameter_ = std::max(largest_diameter_, 2 * radius);
    mean += 2 * radius / count;
  }
  skin_ = skin_per_diameter * mean;
  // Enough blocks for many threads, but few pairs between blocks.
  blocks_ = {count, std::clamp(count / 32, 128, 2048)};
  const double shortest = largest_diameter_ + skin_;
  for (int axis = 0; axis < 3; ++axis) {
    if (domain_.periodic(axis) && domain_.length(axis) < shortest) {
      throw ConfigError(
          "fluid.mesh.periodic: the period in {} is {:.6g} m, but the largest particle has a "
          "diameter "
          "of {:.6g} m and would meet its own image; make the box at least {:.6g} m long there",
          "xyz"[axis], domain_.length(axis), largest_diameter_, shortest);
    }
  }
}

void NativeEngine::load_rows() {
  const int count = presented_.size();
  spheres_.load.resize(count);
  spheres_.listed_at.resize(count);
  for (int row = 0; row < count; ++row) {
    const double radius = presented_.radius[row];
    const double mass = sphere_mass(radius, presented_.density[row]);
    const Vector3& x = presented_.position[row];
    const Vector3& v = presented_.velocity[row];
    const Vector3& w = presented_.spin[row];
    spheres_.body.push_back({{x.x(), x.y(), x.z()}, radius, {v.x(), v.y(), v.z()}, 1.0 / mass});
    spheres_.spin.push_back({{w.x(), w.y(), w.z()}, 1.0 / (0.4 * mass * radius * radius)});
    spheres_.row.push_back(row);
  }
  drive_.assign(count, Vector3::Zero());
}

void NativeEngine::check_step(double time_step) const {
  // A window cut into equal parts may miss the limit by a rounding error.
  if (time_step <= limit_.longest * (1 + 1e-9)) return;
  throw ConfigError(
      "particles.time_step: a sub-step of {:.4g} s is longer than a tenth of the contact time of "
      "{}, "
      "{:.4g} s; set it to at most {:.4g} s (recommended: {:.2g} s, a twentieth), or soften the "
      "contact",
      time_step, limit_.pair, 10 * limit_.longest, limit_.longest, 0.5 * limit_.longest);
}

void NativeEngine::set_drive(std::span<const Vector3> force) {
  if (static_cast<int>(force.size()) != spheres_.size()) {
    throw NumericsError("force on the particles: {} rows for {} particles", force.size(),
                        spheres_.size());
  }
  int bad = spheres_.size();
#pragma omp parallel for num_threads(threads_) schedule(static) reduction(min : bad)
  for (int i = 0; i < spheres_.size(); ++i) {
    const int row = spheres_.row[i];
    drive_[i] = gravity_ + force[row] * spheres_.body[i].inverse_mass;
    if (!drive_[i].allFinite()) bad = std::min(bad, row);
  }
  if (bad < spheres_.size()) {
    const Vector3& f = force[bad];
    throw NumericsError(
        "particle {}: the force on it is ({}, {}, {}) N; look at the drag and the fluid state "
        "around it",
        presented_.id[bad], f.x(), f.y(), f.z());
  }
}

void NativeEngine::advance(double window, int sub_steps, std::span<const Vector3> force,
                           const Progress& progress) {
  if (has_candidate_) rollback();
  const double time_step = window / sub_steps;
  check_step(time_step);
  set_drive(force);
  save();
  has_candidate_ = true;
  for (int step = 1; step <= sub_steps; ++step) {
    const Kick kick = step == 1 ? Kick::half : Kick::full;
    if (move(context(), kick, time_step, 0.5 * skin_, lists_[list_], outbox_, spheres_)) {
      check_particles(time_step, step, sub_steps);
      sort_and_list(true);
    }
    add_contacts(context(), time_step, lists_[list_], outbox_, spheres_);
    if (progress) progress();
  }
  settle(context(), time_step, lists_[list_], outbox_, spheres_);
  check_particles(time_step, sub_steps, sub_steps);
  present();
}

void NativeEngine::commit() {
  has_candidate_ = false;
  saved_.valid = false;
}

// ---- lists
// --------------------------------------------------------------------------------------------

/// Wrap what has left through periodic sides, sort all rows into cells.
void NativeEngine::wrap_and_sort() {
  const int count = spheres_.size();
  std::vector<std::array<std::int8_t, 3>> periods(count);
  for (int i = 0; any_periodic_ && i < count; ++i) {
    Eigen::Map<Vector3> position(spheres_.body[i].position);
    const Vector3 moved = wrapped(domain_, position);
    for (int axis = 0; axis < 3; ++axis) {
      const double apart = (position[axis] - moved[axis]) / domain_.length(axis);
      periods[i][axis] = static_cast<std::int8_t>(std::lround(apart));
    }
    position = moved;
  }
  const double* data = count > 0 ? spheres_.body.front().position : nullptr;
  grid_.sort(domain_, largest_diameter_ + skin_,
             {data, static_cast<int>(sizeof(Body) / sizeof(double)), count});
  sorted_ = spheres_;
  sorted_drive_ = drive_;
  resorting_.previous = grid_.order();
  resorting_.periods.resize(count);
#pragma omp parallel for num_threads(threads_) schedule(static)
  for (int place = 0; place < count; ++place) {
    const int from = grid_.order()[place];
    sorted_.body[place] = spheres_.body[from];
    sorted_.spin[place] = spheres_.spin[from];
    sorted_.row[place] = spheres_.row[from];
    sorted_.listed_at[place] = Eigen::Map<const Vector3>(spheres_.body[from].position);
    sorted_drive_[place] = drive_[from];
    resorting_.periods[place] = periods[from];
  }
  std::swap(spheres_, sorted_);
  std::swap(drive_, sorted_drive_);
}

/// Sort and list anew. The loads are those of the old order after this: `add_contacts` must follow.
void NativeEngine::sort_and_list(bool carry_springs) {
  wrap_and_sort();
  std::size_t made = 0;
  while (made == list_ || (saved_.valid && made == saved_.list)) ++made;
  const ContactScope scope{domain_, laws_, presented_.material, skin_, friction_, threads_};
  make_contact_list(scope, spheres_, blocks_, grid_, resorting_,
                    carry_springs ? &lists_[list_] : nullptr, lists_[made]);
  list_ = made;
  outbox_.resize(lists_[list_].outbox_size);
}

// ---- checks
// -------------------------------------------------------------------------------------------

bool NativeEngine::is_sound(int place, double time_step) const {
  const Body& body = spheres_.body[place];
  const Eigen::Map<const Vector3> position(body.position);
  const Eigen::Map<const Vector3> velocity(body.velocity);
  if (!position.allFinite() || !velocity.allFinite()) return false;
  if (lost_through(domain_, position, body.radius) >= 0) return false;
  // Faster than this it could pass through what it should touch. Where nothing can touch, let it
  // fly.
  return !std::isfinite(limit_.longest) || velocity.norm() * time_step <= body.radius;
}

void NativeEngine::check_particles(double time_step, int sub_step, int sub_steps) const {
  const int none = spheres_.size();
  int bad = none;
#pragma omp parallel for num_threads(threads_) schedule(static) reduction(min : bad)
  for (int i = 0; i < none; ++i) {
    if (!is_sound(i, time_step)) bad = std::min(bad, spheres_.row[i]);
  }
  if (bad < none) refuse(bad, time_step, sub_step, sub_steps);
}

void NativeEngine::refuse(int row, double time_step, int sub_step, int sub_steps) const {
  const auto place = static_cast<std::size_t>(
      std::find(spheres_.row.begin(), spheres_.row.end(), row) - spheres_.row.begin());
  const Body& body = spheres_.body[place];
  const Eigen::Map<const Vector3> x(body.position);
  const Eigen::Map<const Vector3> v(body.velocity);
  const std::string who = fmt::format(
      "particle {} at ({:.6g}, {:.6g}, {:.6g}) m with velocity ({:.4g}, {:.4g}, {:.4g}) m/s, "
      "sub-step {} "
      "of {} of this window:",
      presented_.id[row], x.x(), x.y(), x.z(), v.x(), v.y(), v.z(), sub_step, sub_steps);
  if (!x.allFinite() || !v.allFinite()) {
    throw NumericsError(
        "{} position or velocity is not finite; two centres in one place, or contacts too stiff "
        "for the "
        "time step: look at the insertion, shorten particles.time_step",
        who);
  }
  const int side = lost_through(domain_, x, body.radius);
  if (side >= 0 && domain_.sides[side] == SideKind::open) {
    throw NumericsError(
        "{} left the domain through {}, which is open; move that side out (fluid.mesh.box) or "
        "close it",
        who, side_name(side));
  }
  if (side >= 0) {
    throw NumericsError(
        "{} was pressed through the wall {}; raise the normal_stiffness between its material and "
        "the "
        "walls, or shorten particles.time_step",
        who, side_name(side));
  }
  throw NumericsError(
      "{} moves by {:.3g} of its radius in one sub-step, so it could pass through others; set "
      "particles.time_step to at most {:.3g} s",
      who, v.norm() * time_step / body.radius, body.radius / v.norm());
}

// ---- committed and candidate
// --------------------------------------------------------------------------

void NativeEngine::present() {
#pragma omp parallel for num_threads(threads_) schedule(static)
  for (int i = 0; i < spheres_.size(); ++i) {
    const int row = spheres_.row[i];
    const Eigen::Map<const Vector3> position(spheres_.body[i].position);
    presented_.position[row] = any_periodic_ ? wrapped(domain_, position) : Vector3(position);
    presented_.velocity[row] = Eigen::Map<const Vector3>(spheres_.body[i].velocity);
    presented_.spin[row] = Eigen::Map<const Vector3>(spheres_.spin[i].rate);
  }
}

void NativeEngine::save() {
  if (saved_.valid) return;
  const int count = spheres_.size();
  const ContactList& list = lists_[list_];
  saved_.spheres.body.resize(count);
  saved_.spheres.spin.resize(count);
  saved_.spheres.load.resize(count);
  saved_.spheres.listed_at.resize(count);
  saved_.spheres.row.resize(count);
  saved_.pair_springs.resize(blocks_.count());
  saved_.wall_springs.resize(blocks_.count());
#pragma omp parallel for num_threads(threads_) schedule(static)
  for (int b = 0; b < blocks_.count(); ++b) {
    const int first = blocks_.first(b);
    const int last = blocks_.last(b);
    const auto copy = [&](const auto& from, auto& to) {
      std::copy(from.begin() + first, from.begin() + last, to.begin() + first);
    };
    copy(spheres_.body, saved_.spheres.body);
    copy(spheres_.spin, saved_.spheres.spin);
    copy(spheres_.load, saved_.spheres.load);
    copy(spheres_.listed_at, saved_.spheres.listed_at);
    copy(spheres_.row, saved_.spheres.row);
    saved_.pair_springs[b] = list.blocks[b].pair_springs;
    saved_.wall_springs[b] = list.blocks[b].wall_springs;
  }
  saved_.list = list_;
  saved_.valid = true;
}

void NativeEngine::rollback() {
  if (!has_candidate_) return;
  has_candidate_ = false;
  spheres_ = saved_.spheres;
  list_ = saved_.list;
  for (int b = 0; b < blocks_.count(); ++b) {
    lists_[list_].blocks[b].pair_springs = saved_.pair_springs[b];
    lists_[list_].blocks[b].wall_springs = saved_.wall_springs[b];
  }
  outbox_.resize(lists_[list_].outbox_size);
  present();
}

}  // namespace

std::unique_ptr<ParticleEngine> make_native_engine(const Scene& scene, const Mesh& mesh,
                                                   ParticleState initial) {
  if (initial.size() > 0) refuse_surfaces(make_walls(scene, mesh));
  return std::make_unique<NativeEngine>(scene, mesh, std::move(initial));
}

}  // namespace fluxpact
