#include "dem_server/backends/native/native_engine.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "dem_server/backends/native/contact_pass.hpp"
#include "dem_server/backends/native/soundness.hpp"
#include "dem_server/backends/native/step_limit.hpp"
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
/// Rows and loads of a block stay in a core's own cache; pairs between blocks cost double, so the
/// blocks are as large as that allows, but enough for some threads in small scenes.
constexpr int largest_block = 8192;
constexpr int least_blocks = 4;
constexpr int smallest_block = 128;

template <class Real>
struct SavedSprings {
  Springs<Real> inner, outer, image, plane;
};

/// What the places of a buffer of bodies hold.
struct Places {
  std::vector<int> row;       // of the presented state
  std::vector<int> previous;  // the place in the list in use, -1: not in it
};

/// Lengths and limits that follow from the particles.
struct Sizes {
  StepLimit limit;
  RootMasses root_masses;
  double skin = 0;            // [m]
  double beyond_contact = 0;  // [m] that a law reaches beyond touching surfaces
};

/// Of a window in which particles entered or left: what rollback brings back.
struct BeforeExchange {
  ParticleState presented;
  Sizes sizes;
};

/// Pairs of the list name their law by one byte.
void check_law_indices(const ContactLaws& laws) {
  if (laws.count() <= 256) return;
  throw ConfigError(
      "particles.materials: {} materials; the native engine tells at most 15 apart, so give those "
      "that behave alike one name",
      laws.walls());
}

/// Of particles that all have the same mass.
RootMasses common_root_masses(const ParticleState& particles) {
  const int count = particles.size();
  const auto mass = [&](int row) {
    return sphere_mass(particles.radius[row], particles.density[row]);
  };
  for (int row = 1; row < count; ++row) {
    if (mass(row) != mass(0)) return {};
  }
  if (count == 0) return {};
  return {std::sqrt(mass(0) / 2), std::sqrt(mass(0))};
}

template <class Real, bool turning>
class NativeEngine final : public ParticleEngine {
 public:
  NativeEngine(const Scene& scene, const Mesh& mesh, ContactLaws laws, ParticleState initial);

  const ParticleState& particles() const override { return presented_; }
  bool mobile() const override { return true; }
  EngineCounters counters() const override;
  void advance(double window, int sub_steps, std::span<const Vector3> force,
               const Progress& progress) override;
  void exchange(std::span<const int> leaving, const ParticleState& entering) override;
  void commit() override;
  void rollback() override;

 private:
  using BodyRow = Body<Real, turning>;
  using LoadRow = Load<Real, turning>;
  using List = ContactList<Real>;

  void size_up();
  BodyRow body_of(int row) const;
  void tabulate_sides();
  void set_drive(std::span<const Vector3> force);
  bool sweep(Phase phase, double time_step, double spring_step, int from, int to,
             HugeVector<LoadRow>& loads);
  void sort_and_list(int from, int to, const Places& places, bool carry_springs);
  Places take_out(std::span<const int> leaving);
  void put_in(const ParticleState& entering, Places& places);
  Places kept_places() const;
  void wrap(HugeVector<BodyRow>& bodies);
  void check(int bodies, double time_step, int sub_step, int sub_steps) const;
  void present(int bodies);
  void save_springs();
  int threads_for(const Blocks& blocks) const { return std::clamp(threads_, 1, std::max(1, blocks.count())); }

  Domain domain_;
  ContactLaws laws_;
  LawTable<Real> law_table_;
  std::array<double[4], 27> shifts_{};
  std::array<double[4], 6> planes_{};
  Vector3 gravity_;
  bool any_periodic_;
  int threads_;
  std::vector<int> wall_materials_;
  double time_step_;  // [s] of the scene
  Sizes sizes_;

  ParticleState presented_;
  std::array<HugeVector<BodyRow>, 3> bodies_;  // committed, and two to go back and forth
  int committed_ = 0;
  int candidate_ = 0;
  HugeVector<LoadRow> loads_;            // of the committed state
  HugeVector<LoadRow> candidate_loads_;  // of the candidate
  std::array<List, 3> lists_;            // in use, kept for rollback, being made
  int list_ = 0;
  int committed_list_ = 0;
  std::vector<SavedSprings<Real>> saved_springs_;  // by block of the committed list
  std::optional<BeforeExchange> before_exchange_;
  bool has_candidate_ = false;
  HugeVector<Drive<Real>> drive_;
  HugeVector<LoadRow> sums_;  // room for each thread

  // Kept between rebuilds so that they need no memory of their own each time.
  SizeLevels levels_;
  Resorting resorting_;
  HugeVector<Drive<Real>> sorted_drive_;
  std::int64_t rebuilds_ = 0;
  std::int64_t sub_steps_ = 0;
};

template <class Real, bool turning>
NativeEngine<Real, turning>::NativeEngine(const Scene& scene, const Mesh& mesh, ContactLaws laws,
                                          ParticleState initial)
    : domain_(particle_domain(scene, mesh)),
      laws_(std::move(laws)),
      law_table_(law_table<Real>(laws_)),
      gravity_(scene.scene.gravity),
      presented_(checked_rows(std::move(initial), laws_.walls())) {
  const auto is = [this](SideKind kind) {
    return std::find(domain_.sides.begin(), domain_.sides.end(), kind) != domain_.sides.end();
  };
  any_periodic_ = is(SideKind::periodic);
  const int asked = scene.particles.numerics.threads;
  threads_ = asked > 0 ? asked : omp_get_max_threads();
  if (is(SideKind::wall)) wall_materials_.push_back(laws_.walls());
  time_step_ = scene.coupling.window / sub_steps(scene);
  check_law_indices(laws_);
  size_up();
  tabulate_sides();
  const int count = presented_.size();
  Places places;
  for (int row = 0; row < count; ++row) {
    bodies_[0].push_back(body_of(row));
    places.row.push_back(row);
  }
  places.previous.assign(count, -1);
  lists_[list_].row = places.row;
  check(0, 0, 0, 0);
  loads_.resize(count);
  bodies_[2].resize(count);
  sort_and_list(0, 1, places, false);
  // Forces of contacts that exist from the start, with their springs at rest.
  sweep(Phase::settle, 0, 0, 1, 2, loads_);
  committed_ = candidate_ = 2;
  committed_list_ = list_;
  present(committed_);
}

/// Lengths and limits that follow from the particles.
template <class Real, bool turning>
void NativeEngine<Real, turning>::size_up() {
  double largest = 0;
  double mean = 0;
  for (const double radius : presented_.radius) {
    largest = std::max(largest, 2 * radius);
    mean += 2 * radius / presented_.size();
  }
  sizes_.skin = skin_per_diameter * mean;
  sizes_.beyond_contact = reach_beyond_contact(laws_, 0.5 * largest);
  sizes_.root_masses = common_root_masses(presented_);
  sizes_.limit = step_limit(laws_, presented_, wall_materials_);
  check_periods(domain_, largest, largest + sizes_.skin + sizes_.beyond_contact);
  check_time_step(sizes_.limit, time_step_);
}

template <class Real, bool turning>
void NativeEngine<Real, turning>::tabulate_sides() {
  const std::array<Vector3, 27> shifts = shift_vectors(domain_);
  for (int code = 0; code < 27; ++code) {
    for (int axis = 0; axis < 3; ++axis) shifts_[code][axis] = shifts[code][axis];
  }
  for (int side = 0; side < 6; ++side) {
    const double inward = side % 2 == 0 ? 1.0 : -1.0;
    planes_[side][side / 2] = inward;
    planes_[side][3] = inward * domain_.plane(side);
  }
}

template <class Real, bool turning>
auto NativeEngine<Real, turning>::body_of(int row) const -> BodyRow {
  const double radius = presented_.radius[row];
  BodyRow body{};
  body.radius = radius;
  body.inverse_mass = static_cast<Real>(1 / sphere_mass(radius, presented_.density[row]));
  for (int axis = 0; axis < 3; ++axis) {
    body.position[axis] = presented_.position[row][axis];
    body.velocity[axis] = static_cast<Real>(presented_.velocity[row][axis]);
    if constexpr (turning) {
      body.radius_spin[axis] = static_cast<Real>(radius * presented_.spin[row][axis]);
    }
  }
  if constexpr (turning) body.inverse_radius = static_cast<Real>(1 / radius);
  return body;
}

template <class Real, bool turning>
void NativeEngine<Real, turning>::set_drive(std::span<const Vector3> force) {
  const int count = presented_.size();
  if (static_cast<int>(force.size()) != count) {
    throw NumericsError("force on the particles: {} rows for {} particles", force.size(), count);
  }
  drive_.resize(count);
  int bad = count;
#pragma omp parallel for num_threads(threads_) schedule(static) reduction(min : bad)
  for (int i = 0; i < count; ++i) {
    const int row = lists_[list_].row[i];
    const double inverse_mass = static_cast<double>(bodies_[committed_][i].inverse_mass);
    const Vector3 drive = gravity_ + force[row] * inverse_mass;
    for (int axis = 0; axis < 3; ++axis) {
      drive_[i].acceleration[axis] = static_cast<Real>(drive[axis]);
    }
    if (!drive.allFinite()) bad = std::min(bad, row);
  }
  if (bad < count) refuse_force(presented_.id[bad], force[bad]);
}

/// One phase of all blocks. True if the list must be made anew.
template <class Real, bool turning>
bool NativeEngine<Real, turning>::sweep(Phase phase, double time_step, double spring_step, int from,
                                        int to, HugeVector<LoadRow>& loads) {
  List& list = lists_[list_];
  const Blocks& blocks = list.blocks;
  const int threads = threads_for(blocks);
  sums_.resize(static_cast<std::size_t>(threads) * blocks.block_size);
  BlockPass<Real, turning> all;
  all.phase = phase;
  all.time_step = time_step;
  all.spring_step = spring_step;
  all.now = bodies_[from].data();
  all.next = bodies_[to].data();
  all.load = loads.data();
  all.drive = drive_.data();
  all.listed_at = list.listed_at.data();
  all.origin = list.origin.data();
  all.reach = list.reach;
  all.shifts = shifts_.data();
  all.planes = planes_.data();
  all.laws = &law_table_;
  all.beyond_contact = sizes_.beyond_contact;
  all.root_masses = sizes_.root_masses;
  bool beyond = false;
#pragma omp parallel for num_threads(threads) schedule(static) reduction(|| : beyond)
  for (int b = 0; b < blocks.count(); ++b) {
    BlockPass<Real, turning> pass = all;
    pass.first = blocks.first(b);
    pass.last = blocks.last(b);
    pass.sum = sums_.data() + static_cast<std::ptrdiff_t>(omp_get_thread_num()) * blocks.block_size;
    pass.contacts = &list.block[b];
    const bool one = pass_block(pass);
    beyond = beyond || one;
  }
  return beyond;
}

template <class Real, bool turning>
void NativeEngine<Real, turning>::advance(double window, int sub_steps,
                                          std::span<const Vector3> force,
                                          const Progress& progress) {
  if (has_candidate_) rollback();
  const double time_step = window / sub_steps;
  // Contacts by Hertz' law are the shorter the faster they are.
  if (laws_.model().law == ContactLaw::hertz)
    sizes_.limit = step_limit(laws_, presented_, wall_materials_);
  check_time_step(sizes_.limit, time_step);
  set_drive(force);
  save_springs();
  has_candidate_ = true;
  int now = (committed_ + 1) % 3;
  int next = (committed_ + 2) % 3;
  bodies_[now].resize(bodies_[committed_].size());
  bodies_[next].resize(bodies_[committed_].size());
  candidate_loads_.resize(loads_.size());
  bool beyond = sweep(Phase::start, time_step, 0, committed_, now, loads_);
  for (int step = 1; step <= sub_steps; ++step) {
    if (beyond) {
      check(now, time_step, step, sub_steps);
      sort_and_list(now, next, kept_places(), true);
      std::swap(now, next);
    }
    const Phase phase = step < sub_steps ? Phase::drift : Phase::settle;
    beyond = sweep(phase, time_step, time_step, now, next, candidate_loads_);
    std::swap(now, next);
    if (progress) progress();
  }
  candidate_ = now;
  sub_steps_ += sub_steps;
  check(candidate_, time_step, sub_steps, sub_steps);
  present(candidate_);
}

template <class Real, bool turning>
void NativeEngine<Real, turning>::commit() {
  if (!has_candidate_) return;
  has_candidate_ = false;
  committed_ = candidate_;
  committed_list_ = list_;
  std::swap(loads_, candidate_loads_);
  before_exchange_.reset();
}

// ---- particles that leave and enter
// ------------------------------------------------------------------

template <class Real, bool turning>
void NativeEngine<Real, turning>::exchange(std::span<const int> leaving,
                                           const ParticleState& entering) {
  if (leaving.empty() && entering.size() == 0) return;
  if (!before_exchange_) before_exchange_ = BeforeExchange{presented_, sizes_};
  const ParticleState checked = checked_rows(entering, laws_.walls());
  Places places = take_out(leaving);
  exchange_rows(leaving, checked, presented_);
  put_in(checked, places);
  size_up();
  const int free = 3 - committed_ - candidate_;
  bodies_[free].resize(bodies_[candidate_].size());
  drive_.resize(bodies_[candidate_].size());
  // Who stays keeps its load; who enters touches nothing.
  sort_and_list(candidate_, free, places, true);
  HugeVector<LoadRow> sorted(candidate_loads_.size());
  for (std::size_t place = 0; place < sorted.size(); ++place) {
    sorted[place] = candidate_loads_[levels_.order()[place]];
  }
  candidate_loads_ = std::move(sorted);
  candidate_ = free;
  check(candidate_, 0, 0, 0);
  present(candidate_);
}

/// The candidate's bodies and loads without some rows, with the rows that the others have then.
template <class Real, bool turning>
Places NativeEngine<Real, turning>::take_out(std::span<const int> leaving) {
  std::vector<int> row_now(presented_.size(), 0);
  for (const int row : leaving) row_now[row] = -1;
  int kept = 0;
  for (int& row : row_now) row = row < 0 ? -1 : kept++;
  Places places;
  HugeVector<BodyRow>& bodies = bodies_[candidate_];
  const std::vector<int>& row_of = lists_[list_].row;
  for (int place = 0; place < static_cast<int>(row_of.size()); ++place) {
    const int row = row_now[row_of[place]];
    if (row < 0) continue;
    bodies[places.row.size()] = bodies[place];
    candidate_loads_[places.row.size()] = candidate_loads_[place];
    places.row.push_back(row);
    places.previous.push_back(place);
  }
  bodies.resize(places.row.size());
  candidate_loads_.resize(places.row.size());
  return places;
}

/// Appends those that enter, which are the last rows already.
template <class Real, bool turning>
void NativeEngine<Real, turning>::put_in(const ParticleState& entering, Places& places) {
  for (int row = presented_.size() - entering.size(); row < presented_.size(); ++row) {
    bodies_[candidate_].push_back(body_of(row));
    candidate_loads_.push_back({});
    places.row.push_back(row);
    places.previous.push_back(-1);
  }
}

// ---- lists
// --------------------------------------------------------------------------------------------

/// Move what has left through periodic sides by whole periods.
template <class Real, bool turning>
void NativeEngine<Real, turning>::wrap(HugeVector<BodyRow>& bodies) {
  const int count = static_cast<int>(bodies.size());
  resorting_.periods.assign(count, {});
  if (!any_periodic_) return;
  std::vector<std::array<std::int8_t, 3>> periods(count);
  for (int i = 0; i < count; ++i) {
    Eigen::Map<Vector3> position(bodies[i].position);
    const Vector3 moved = wrapped(domain_, position);
    for (int axis = 0; axis < 3; ++axis) {
      const double apart = (position[axis] - moved[axis]) / domain_.length(axis);
      periods[i][axis] = static_cast<std::int8_t>(std::lround(apart));
    }
    position = moved;
  }
  resorting_.periods.swap(periods);
}

/// The places of the list in use.
template <class Real, bool turning>
Places NativeEngine<Real, turning>::kept_places() const {
  Places places{lists_[list_].row, std::vector<int>(lists_[list_].row.size())};
  std::iota(places.previous.begin(), places.previous.end(), 0);
  return places;
}

/// Sort the rows of `from`, which are at `places`, into those of `to` and list anew.
template <class Real, bool turning>
void NativeEngine<Real, turning>::sort_and_list(int from, int to, const Places& places,
                                                bool carry_springs) {
  HugeVector<BodyRow>& unsorted = bodies_[from];
  HugeVector<BodyRow>& sorted = bodies_[to];
  const int count = static_cast<int>(unsorted.size());
  wrap(unsorted);
  constexpr int stride = sizeof(BodyRow) / sizeof(double);
  const double* data = count > 0 ? unsorted.front().position : nullptr;
  levels_.sort(domain_, sizes_.skin + sizes_.beyond_contact, {data, stride, count},
               {data + 3, stride});

  int made = 0;
  while (made == list_ || (has_candidate_ && made == committed_list_)) ++made;
  const List& before = lists_[list_];
  List& list = lists_[made];
  list.blocks = {count, std::clamp(count / least_blocks, smallest_block, largest_block)};
  list.row.resize(count);
  sorted.resize(count);
  drive_.resize(count);
  sorted_drive_.resize(count);
  resorting_.previous.resize(count);
  const std::vector<int>& order = levels_.order();
  std::vector<std::array<std::int8_t, 3>> periods(count);
#pragma omp parallel for num_threads(threads_) schedule(static)
  for (int place = 0; place < count; ++place) {
    sorted[place] = unsorted[order[place]];
    sorted_drive_[place] = drive_[order[place]];
    list.row[place] = places.row[order[place]];
    resorting_.previous[place] = places.previous[order[place]];
    periods[place] = resorting_.periods[order[place]];
  }
  std::swap(drive_, sorted_drive_);
  resorting_.periods.swap(periods);
  const ContactScope scope{domain_, laws_, sizes_.skin, sizes_.beyond_contact, threads_};
  make_contact_list<Real, turning>(scope, sorted, presented_.material, levels_, resorting_,
                                   carry_springs ? &before : nullptr, list);
  list_ = made;
  ++rebuilds_;
}

// ---- checks, committed and candidate
// ------------------------------------------------------------------

template <class Real, bool turning>
void NativeEngine<Real, turning>::check(int bodies, double time_step, int sub_step,
                                        int sub_steps) const {
  const HugeVector<BodyRow>& rows = bodies_[bodies];
  const std::vector<int>& row_of = lists_[list_].row;
  const int none = presented_.size();
  const bool may_touch = std::isfinite(sizes_.limit.longest);
  int bad = none;
  const auto motion = [&](int i) {
    const Real* v = rows[i].velocity;
    return Motion{
        Eigen::Map<const Vector3>(rows[i].position),
        Vector3(static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])),
        rows[i].radius};
  };
#pragma omp parallel for num_threads(threads_) schedule(static) reduction(min : bad)
  for (int i = 0; i < none; ++i) {
    if (!is_sound(domain_, motion(i), may_touch ? time_step : 0)) bad = std::min(bad, row_of[i]);
  }
  if (bad == none) return;
  const auto at = std::find(row_of.begin(), row_of.end(), bad) - row_of.begin();
  refuse(domain_, presented_.id[bad], motion(static_cast<int>(at)),
         {time_step, sub_step, sub_steps});
}

template <class Real, bool turning>
void NativeEngine<Real, turning>::present(int bodies) {
  const HugeVector<BodyRow>& rows = bodies_[bodies];
  const List& list = lists_[list_];
#pragma omp parallel for num_threads(threads_) schedule(static)
  for (int i = 0; i < presented_.size(); ++i) {
    const BodyRow& body = rows[i];
    const int row = list.row[i];
    const Eigen::Map<const Vector3> position(body.position);
    presented_.position[row] = any_periodic_ ? wrapped(domain_, position) : Vector3(position);
    for (int axis = 0; axis < 3; ++axis) {
      presented_.velocity[row][axis] = static_cast<double>(body.velocity[axis]);
      if constexpr (turning) {
        presented_.spin[row][axis] = static_cast<double>(body.radius_spin[axis]) / body.radius;
      }
    }
  }
}

template <class Real, bool turning>
void NativeEngine<Real, turning>::save_springs() {
  if (spring_numbers(laws_.model()) == 0) return;
  const List& list = lists_[list_];
  saved_springs_.resize(list.block.size());
#pragma omp parallel for num_threads(threads_) schedule(static)
  for (int b = 0; b < list.blocks.count(); ++b) {
    const ContactBlock<Real>& block = list.block[b];
    saved_springs_[b] = {block.inner_springs, block.outer_springs, block.image_springs,
                         block.plane_springs};
  }
}

template <class Real, bool turning>
void NativeEngine<Real, turning>::rollback() {
  if (!has_candidate_) return;
  has_candidate_ = false;
  list_ = committed_list_;
  if (before_exchange_) {
    presented_ = std::move(before_exchange_->presented);
    sizes_ = before_exchange_->sizes;
    before_exchange_.reset();
  }
  for (std::size_t b = 0; b < saved_springs_.size(); ++b) {
    ContactBlock<Real>& block = lists_[list_].block[b];
    block.inner_springs = saved_springs_[b].inner;
    block.outer_springs = saved_springs_[b].outer;
    block.image_springs = saved_springs_[b].image;
    block.plane_springs = saved_springs_[b].plane;
  }
  candidate_ = committed_;
  present(committed_);
}

template <class Real, bool turning>
EngineCounters NativeEngine<Real, turning>::counters() const {
  EngineCounters counters{sub_steps_, rebuilds_, 0};
  for (const ContactBlock<Real>& block : lists_[list_].block) {
    // What two blocks hold is one pair.
    counters.list_pairs += static_cast<std::int64_t>(block.inner.size() +
                                                     (block.outer.size() + block.image.size()) / 2);
  }
  return counters;
}

template <class Real>
std::unique_ptr<ParticleEngine> make_engine(const Scene& scene, const Mesh& mesh,
                                            ParticleState initial) {
  ContactLaws laws(scene.particles);
  if (laws.any_friction()) {
    return std::make_unique<NativeEngine<Real, true>>(scene, mesh, std::move(laws),
                                                      std::move(initial));
  }
  return std::make_unique<NativeEngine<Real, false>>(scene, mesh, std::move(laws),
                                                     std::move(initial));
}

}  // namespace

std::unique_ptr<ParticleEngine> make_native_engine(const Scene& scene, const Mesh& mesh,
                                                   ParticleState initial) {
  if (initial.size() > 0 || !scene.particles.inflow.empty()) {
    refuse_surfaces(make_walls(scene, mesh));
  }
  if (scene.particles.numerics.precision == Precision::mixed) {
    return make_engine<float>(scene, mesh, std::move(initial));
  }
  return make_engine<double>(scene, mesh, std::move(initial));
}

}  // namespace fluxpact
