#include "dem_server/backends/granular/granular_engine.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "dem_server/backends/domain.hpp"
#include "dem_server/backends/engine_state.hpp"
#include "dem_server/backends/native/soundness.hpp"
#include "dem_server/backends/native/step_limit.hpp"
#include "dem_server/backends/particle_rows.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

constexpr int steps_between_signs_of_life = 10;

class GranularEngine final : public ParticleEngine {
 public:
  GranularEngine(const Scene& scene, const Mesh& mesh, std::string name, ContactLaws laws,
                 ParticleState spheres, std::unique_ptr<Simulation> simulation)
      : name_(std::move(name)),
        domain_(particle_domain(scene, mesh)),
        laws_(std::move(laws)),
        gravity_(scene.scene.gravity),
        flow_(particles_flow(scene)),
        time_step_(scene.coupling.window / sub_steps(scene)),
        spheres_(std::move(spheres)),
        simulation_(std::move(simulation)) {
    check_spheres(spheres_);
    committed_ = {spheres_.position, spheres_.velocity, spheres_.spin, {}, {}, {}, {}};
    present(committed_);
  }

  const ParticleState& particles() const override {
    return ranks_.size() == 1 ? spheres_ : presented_;
  }
  bool mobile() const override { return true; }
  const ParticleState& all_particles() const override { return spheres_; }
  void add_up(std::span<double> values) const override { ranks_.add_up(values); }
  EngineCounters counters() const override { return counters_; }

  void advance(double window, int sub_steps, std::span<const Vector3> force,
               const Progress& progress) override;
  void exchange(std::span<const int> leaving, const ParticleState& entering) override;
  void commit() override;
  void rollback() override;
  void store(EngineState& state) const override;
  void restore(const Fields& fields) override;

 private:
  static constexpr int state_version = 1;

  void check_spheres(const ParticleState& spheres) const;
  std::span<const Vector3> of_all(std::span<const Vector3> share);
  void collect(Motions& motions);
  void present(const Motions& motions);
  bool contacts_fit(const Motions& motions) const;
  void check_motions(const Motions& motions, double time_step, int steps) const;

  std::string name_;
  Ranks ranks_;
  Domain domain_;
  ContactLaws laws_;
  Vector3 gravity_;
  bool flow_;
  double time_step_;         ///< [s] of a whole window
  ParticleState spheres_;    ///< all, the newest state
  ParticleState presented_;  ///< with several ranks: the share of this one
  std::unique_ptr<Simulation> simulation_;
  Motions committed_;
  Motions candidate_;
  bool has_candidate_ = false;
  std::optional<ParticleState> before_exchange_;  ///< in a window in which some entered or left
  EngineCounters counters_;
  std::vector<double> own_rows_;
  std::vector<double> all_rows_;
  std::vector<double> all_forces_;
  std::vector<const double*> row_at_;
};

void GranularEngine::check_spheres(const ParticleState& spheres) const {
  const bool walls = std::ranges::count(domain_.sides, SideKind::wall) > 0;
  const WallsPresent sides{laws_.walls(), 0};
  check_time_step(step_limit(laws_, spheres, {&sides, walls ? 1U : 0U}), time_step_);
  for (const std::int64_t id : spheres.id) {
    if (id >= 1 && id < (std::int64_t{1} << 31) - 1) continue;
    throw ConfigError("particle {}: {} needs ids from 1 to 2147483646; number the particles anew",
                      id, name_);
  }
  simulation_->check(spheres);
  const double largest = spheres.radius.empty() ? 0 : 2 * *std::ranges::max_element(spheres.radius);
  check_periods(domain_, largest, largest);
}

/// The rows of all ranks from the share of this one.
std::span<const Vector3> GranularEngine::of_all(std::span<const Vector3> share) {
  if (ranks_.size() == 1) return share;
  ranks_.gather(as_doubles(share), all_forces_);
  return as_vectors(std::span<const double>(all_forces_));
}

void GranularEngine::advance(double window, int sub_steps, std::span<const Vector3> force,
                             const Progress& progress) {
  has_candidate_ = true;
  const std::span<const Vector3> forces = of_all(force);
  for (int row = 0; row < spheres_.size(); ++row) {
    if (!forces[row].allFinite()) refuse_force(spheres_.id[row], forces[row]);
  }
  const double time_step = window / sub_steps;
  if (spheres_.size() == 0) {
    candidate_ = {{}, {}, {}, {}, {}, {}, {0}};
    return;
  }
  simulation_->load(spheres_, committed_, forces, time_step);
  // Fixed pieces, so that who listens does not change what is computed.
  for (int done = 0; done < sub_steps; done += steps_between_signs_of_life) {
    simulation_->run(std::min(steps_between_signs_of_life, sub_steps - done));
    if (progress) progress();
  }
  counters_.sub_steps += sub_steps;
  counters_.rebuilds += simulation_->rebuilds();
  collect(candidate_);
  for (int row = 0; row < spheres_.size(); ++row) candidate_.force[row] -= forces[row];
  check_motions(candidate_, time_step, sub_steps);
  present(candidate_);
}

/// The rows of all ranks, in our order.
void GranularEngine::collect(Motions& motions) {
  own_rows_.clear();
  simulation_->save(spheres_, own_rows_);
  ranks_.gather(own_rows_, all_rows_);
  const auto count = static_cast<std::size_t>(spheres_.size());
  row_at_.assign(count, nullptr);
  const auto numbers = [](const double* at) {
    return static_cast<std::size_t>(at[saved_numbers - 1]);
  };
  std::size_t contacts = 0;
  for (const double* at = all_rows_.data(); at < all_rows_.data() + all_rows_.size();
       at += saved_numbers + numbers(at)) {
    row_at_[static_cast<std::size_t>(at[0])] = at;
    contacts += numbers(at);
  }
  const auto lost = std::ranges::find(row_at_, nullptr);
  if (lost != row_at_.end()) {
    const auto row = static_cast<std::size_t>(lost - row_at_.begin());
    const Vector3& from = committed_.position[row];
    throw NumericsError(
        "particle {}: {} lost it in this window (at the start it was at ({:.6g}, {:.6g}, {:.6g}) "
        "m), since it flew far out of the domain; {} of {} are missing: look at the drag and at "
        "the stiffness of its contacts, shorten particles.time_step",
        spheres_.id[row], name_, from.x(), from.y(), from.z(), std::ranges::count(row_at_, nullptr),
        count);
  }
  for (auto* vectors :
       {&motions.position, &motions.velocity, &motions.spin, &motions.force, &motions.torque}) {
    vectors->resize(count);
  }
  motions.contacts.clear();
  motions.contacts.reserve(contacts);
  motions.offsets.assign(1, 0);
  motions.offsets.reserve(count + 1);
  for (std::size_t row = 0; row < count; ++row) {
    const double* const at = row_at_[row];
    const auto vector = [&](int k) { return Vector3(at[k], at[k + 1], at[k + 2]); };
    motions.position[row] = wrapped(domain_, vector(1));
    motions.velocity[row] = vector(4);
    motions.spin[row] = vector(7);
    motions.force[row] = vector(10);
    motions.torque[row] = vector(13);
    motions.contacts.insert(motions.contacts.end(), at + saved_numbers,
                            at + saved_numbers + numbers(at));
    motions.offsets.push_back(static_cast<std::int64_t>(motions.contacts.size()));
  }
}

void GranularEngine::check_motions(const Motions& motions, double time_step, int steps) const {
  for (int row = 0; row < spheres_.size(); ++row) {
    const Motion motion{motions.position[row], motions.velocity[row], spheres_.radius[row]};
    if (!is_sound(domain_, motion, time_step)) {
      refuse(domain_, spheres_.id[row], motion, {time_step, steps, steps});
    }
  }
}

void GranularEngine::present(const Motions& motions) {
  spheres_.position = motions.position;
  spheres_.velocity = motions.velocity;
  spheres_.spin = motions.spin;
  if (ranks_.size() == 1) return;
  const int first = ranks_.first_row(spheres_.size());
  const int end = ranks_.end_row(spheres_.size());
  const auto share = [&](const auto& all, auto& part) {
    if (all.empty()) {
      part.clear();
    } else {
      part.assign(all.begin() + first, all.begin() + end);
    }
  };
  share(spheres_.id, presented_.id);
  share(spheres_.position, presented_.position);
  share(spheres_.velocity, presented_.velocity);
  share(spheres_.spin, presented_.spin);
  share(spheres_.radius, presented_.radius);
  share(spheres_.density, presented_.density);
  share(spheres_.material, presented_.material);
  share(spheres_.fixed, presented_.fixed);
}

void GranularEngine::exchange(std::span<const int> leaving, const ParticleState& entering) {
  if (leaving.empty() && entering.size() == 0) return;
  if (ranks_.size() > 1) {
    throw ConfigError("particles.ranks: {}: particles come and go on one rank only", ranks_.size());
  }
  if (!before_exchange_) before_exchange_ = spheres_;
  const ParticleState checked = checked_rows(entering, laws_.walls());
  ParticleState after = spheres_;
  exchange_rows(leaving, checked, after);
  check_spheres(after);
  spheres_ = std::move(after);
  candidate_.position = spheres_.position;
  candidate_.velocity = spheres_.velocity;
  candidate_.spin = spheres_.spin;
  // Who stays keeps its load; who enters touches nothing.
  std::vector<double> contacts;
  std::vector<std::int64_t> offsets{0};
  std::size_t next = 0;
  for (int row = 0; row + 1 < static_cast<int>(candidate_.offsets.size()); ++row) {
    if (next < leaving.size() && leaving[next] == row) {
      ++next;
      continue;
    }
    contacts.insert(contacts.end(), candidate_.contacts.begin() + candidate_.offsets[row],
                    candidate_.contacts.begin() + candidate_.offsets[row + 1]);
    offsets.push_back(static_cast<std::int64_t>(contacts.size()));
  }
  remove_rows(leaving, candidate_.force);
  remove_rows(leaving, candidate_.torque);
  for (int row = 0; row < checked.size(); ++row) {
    candidate_.force.emplace_back(sphere_mass(checked.radius[row], checked.density[row]) *
                                  gravity_);
    candidate_.torque.emplace_back(Vector3::Zero());
    offsets.push_back(static_cast<std::int64_t>(contacts.size()));
  }
  candidate_.contacts = std::move(contacts);
  candidate_.offsets = std::move(offsets);
}

void GranularEngine::commit() {
  std::swap(committed_, candidate_);
  before_exchange_.reset();
  has_candidate_ = false;
}

void GranularEngine::rollback() {
  if (before_exchange_) spheres_ = std::move(*before_exchange_);
  before_exchange_.reset();
  has_candidate_ = false;
  present(committed_);
}

void GranularEngine::store(EngineState& state) const {
  if (has_candidate_) {
    throw ProtocolError("the {} engine cannot store its state: a candidate is pending", name_);
  }
  state.add_number(name_ + "_state", state_version);
  store_rows(spheres_, state);
  state.add_vectors("position") = committed_.position;
  state.add_vectors("velocity") = committed_.velocity;
  state.add_vectors("spin") = committed_.spin;
  state.add_vectors("force") = committed_.force;
  state.add_vectors("torque") = committed_.torque;
  state.add_number("moved", committed_.offsets.empty() ? 0 : 1);
  state.add_number("contact_numbers", static_cast<double>(committed_.contacts.size()));
  state.add_scalars("contacts") = committed_.contacts;
  std::vector<double>& offsets = state.add_scalars("contact_offsets");
  for (const std::int64_t offset : committed_.offsets) {
    offsets.push_back(static_cast<double>(offset));
  }
}

bool GranularEngine::contacts_fit(const Motions& motions) const {
  if (!std::ranges::is_sorted(motions.offsets) || motions.offsets.front() != 0 ||
      static_cast<std::size_t>(motions.offsets.back()) != motions.contacts.size()) {
    return false;
  }
  for (std::size_t row = 0; row + 1 < motions.offsets.size(); ++row) {
    if (!simulation_->fits(contacts_of(motions, row))) return false;
  }
  return true;
}

void GranularEngine::restore(const Fields& fields) {
  const StateReader state(fields, name_ + "_state", state_version);
  ParticleState stored = restored_rows(state, laws_.walls(), spheres_, flow_);
  check_spheres(stored);
  const auto rows = stored.id.size();
  const bool moved = state.count("moved", 2) == 1;
  const auto vectors = [&](const char* name, std::size_t count) {
    const auto values = state.vectors(name, count);
    return std::vector<Vector3>(values.begin(), values.end());
  };
  const auto numbers = static_cast<std::size_t>(state.count("contact_numbers", 0x1p31));
  Motions motions{vectors("position", rows),
                  vectors("velocity", rows),
                  vectors("spin", rows),
                  vectors("force", moved ? rows : 0),
                  vectors("torque", moved ? rows : 0),
                  {},
                  state.wholes<std::int64_t>("contact_offsets", moved ? rows + 1 : 0,
                                             static_cast<double>(numbers) + 1)};
  const auto contacts = state.scalars("contacts", numbers);
  motions.contacts.assign(contacts.begin(), contacts.end());
  if (moved && !contacts_fit(motions)) {
    throw ConfigError("the stored state's array `contacts` is not what {} wrote: it is damaged",
                      name_);
  }
  check_motions(motions, 0, 0);
  before_exchange_.reset();
  has_candidate_ = false;
  spheres_ = std::move(stored);
  committed_ = std::move(motions);
  present(committed_);
}

}  // namespace

std::unique_ptr<ParticleEngine> make_granular_engine(const Scene& scene, const Mesh& mesh,
                                                     std::string name, ContactLaws laws,
                                                     ParticleState spheres,
                                                     std::unique_ptr<Simulation> simulation) {
  return std::make_unique<GranularEngine>(scene, mesh, std::move(name), std::move(laws),
                                          std::move(spheres), std::move(simulation));
}

}  // namespace fluxpact
