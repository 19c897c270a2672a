#include "dem_server/backends/lammps/lammps_engine.hpp"

// Debian's <lammps/utils.h> is written for fmt 8 and does not compile with Debian's fmt 9. Nothing
// of it is used here: its guard keeps it out.
#define LMP_UTILS_H
#define LAMMPS_LIB_MPI
#include <lammps/fix.h>
#include <lammps/force.h>
#include <lammps/lammps.h>
#include <lammps/library.h>
#include <lammps/modify.h>
#include <lammps/neigh_list.h>
#include <lammps/neighbor.h>
#include <lammps/pair.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "dem_server/backends/granular/granular_engine.hpp"
#include "dem_server/backends/granular/screen.hpp"
#include "dem_server/backends/lammps/lammps_script.hpp"
#include "dem_server/backends/particle_rows.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

class LammpsSimulation final : public Simulation {
 public:
  explicit LammpsSimulation(const LammpsScene& scene)
      : materials_(scene.laws.walls()), script_(lammps_script(scene)) {
    std::array<const char*, 6> words{"lammps", "-log", "none", "-screen", "none", "-nocite"};
    lammps_.reset(lammps_open(static_cast<int>(words.size()), const_cast<char**>(words.data()),
                              ranks_.all(), nullptr));
    if (!lammps_) throw SystemError("lammps: the library did not start");
    if (ranks_.rank() == 0) library().screen = open_log_stream("lammps");
    for (const std::string& command : script_.start)
      lammps_commands_string(lammps_.get(), command.c_str());
  }

  void check(const ParticleState& spheres) const override;
  void load(const ParticleState& spheres, const Motions& motions, std::span<const Vector3> force,
            double time_step) override;
  void run(int steps) override { command(fmt::format("run {} pre no post no", steps)); }
  void save(const ParticleState& spheres, std::vector<double>& rows) const override;
  bool fits(std::span<const double> contacts) const override;
  std::int64_t rebuilds() const override { return library().neighbor->ncalls; }

 private:
  struct Close {
    void operator()(void* lammps) const { lammps_close(lammps); }
  };

  LAMMPS_NS::LAMMPS& library() const { return *static_cast<LAMMPS_NS::LAMMPS*>(lammps_.get()); }
  void command(const std::string& words) const { lammps_command(lammps_.get(), words.c_str()); }
  int own() const { return lammps_extract_setting(lammps_.get(), "nlocal"); }
  template <class T>
  T* of_atoms(const char* name) const {
    return static_cast<T*>(lammps_extract_atom(lammps_.get(), name));
  }
  void create(const ParticleState& spheres, const Motions& motions);
  void take_up(const ParticleState& spheres, const Motions& motions,
               std::span<const Vector3> force) const;
  std::vector<LAMMPS_NS::Fix*> memories() const;

  Ranks ranks_;
  int materials_;
  LammpsScript script_;
  std::unique_ptr<void, Close> lammps_;
  std::vector<int> tags_;
  std::vector<int> types_;
  mutable std::vector<double> packed_;
};

int row_of(const ParticleState& spheres, int tag) {
  const auto guess = static_cast<std::size_t>(tag - spheres.id.front());
  if (guess < spheres.id.size() && spheres.id[guess] == tag) return static_cast<int>(guess);
  return static_cast<int>(std::ranges::lower_bound(spheres.id, tag) - spheres.id.begin());
}

/// The fixes that remember contacts: of pairs first, then of each wall.
std::vector<LAMMPS_NS::Fix*> LammpsSimulation::memories() const {
  std::vector<LAMMPS_NS::Fix*> found;
  const LAMMPS_NS::Modify& modify = *library().modify;
  for (const std::string_view style : {"NEIGH_HISTORY", "wall/gran"}) {
    for (int k = 0; k < modify.nfix; ++k) {
      if (modify.fix[k]->style == style) found.push_back(modify.fix[k]);
    }
  }
  return found;
}

void LammpsSimulation::check(const ParticleState& spheres) const {
  if (!script_.mass) return;
  for (int row = 0; row < spheres.size(); ++row) {
    if (!spheres.is_fixed(row) &&
        sphere_mass(spheres.radius[row], spheres.density[row]) == *script_.mass) {
      continue;
    }
    throw ConfigError(
        "particle {}: the lammps engine was made for free spheres of {:.6g} kg, which this is not; "
        "restore with the scene that the state was stored with",
        spheres.id[row], *script_.mass);
  }
}

void LammpsSimulation::create(const ParticleState& spheres, const Motions& motions) {
  if (lammps_get_natoms(lammps_.get()) > 0) command("delete_atoms group all compress no");
  tags_.assign(spheres.id.begin(), spheres.id.end());
  types_.resize(tags_.size());
  for (int row = 0; row < spheres.size(); ++row) {
    types_[row] = lammps_type(spheres, materials_, row);
  }
  lammps_create_atoms(lammps_.get(), spheres.size(), tags_.data(), types_.data(),
                      as_doubles(motions.position).data(), as_doubles(motions.velocity).data(),
                      nullptr, 0);
  const int* const tag = of_atoms<int>("id");
  auto* const radius = of_atoms<double>("radius");
  auto* const mass = of_atoms<double>("rmass");
  auto* const spin = of_atoms<double*>("omega");
  for (int i = 0; i < own(); ++i) {
    const int row = row_of(spheres, tag[i]);
    radius[i] = spheres.radius[row];
    mass[i] = sphere_mass(spheres.radius[row], spheres.density[row]);
    std::copy_n(motions.spin[row].data(), 3, spin[i]);
  }
}

void LammpsSimulation::load(const ParticleState& spheres, const Motions& motions,
                            std::span<const Vector3> force, double time_step) {
  command(fmt::format("timestep {:.17g}", time_step));
  create(spheres, motions);
  for (const std::string& words : script_.groups) command(words);
  for (const std::string& words : script_.walls) command(words);
  double** const fluid = lammps_fix_external_get_force(lammps_.get(), "fluid");
  const int* const tag = of_atoms<int>("id");
  for (int i = 0; i < own(); ++i) {
    std::copy_n(force[row_of(spheres, tag[i])].data(), 3, fluid[i]);
  }
  command("run 0 post no");
  if (!motions.force.empty()) take_up(spheres, motions, force);
}

/// A run's set-up finds forces at the full velocity, and lets sliding contacts slip on: the run is
/// to go on with the forces and contacts that it ended with instead.
void LammpsSimulation::take_up(const ParticleState& spheres, const Motions& motions,
                               std::span<const Vector3> force) const {
  const std::vector<LAMMPS_NS::Fix*> memories = this->memories();
  const int* const tag = of_atoms<int>("id");
  auto* const sum = of_atoms<double*>("f");
  auto* const torque = of_atoms<double*>("torque");
  for (int i = 0; i < own(); ++i) {
    const auto row = static_cast<std::size_t>(row_of(spheres, tag[i]));
    const Vector3 all = motions.force[row] + force[row];
    std::copy_n(all.data(), 3, sum[i]);
    std::copy_n(motions.torque[row].data(), 3, torque[i]);
    const std::span<const double> contacts = contacts_of(motions, row);
    packed_.assign(contacts.begin(), contacts.end());
    if (packed_.empty()) packed_.assign(memories.size() * 16, 0.0);  // it touches nothing
    double* next = packed_.data();
    for (LAMMPS_NS::Fix* memory : memories) next += memory->unpack_exchange(i, next);
  }
  // The set-up has matched pairs with what their particles remember, and marked them as done.
  const LAMMPS_NS::NeighList& list = *library().force->pair->list;
  for (int k = 0; k < list.inum; ++k) {
    const int i = list.ilist[k];
    for (int n = 0; n < list.numneigh[i]; ++n) list.firstneigh[i][n] |= 1 << SBBITS;
  }
  memories.front()->post_neighbor();  // from the particles to the list of pairs
}

bool LammpsSimulation::fits(std::span<const double> contacts) const {
  if (contacts.empty()) return true;
  // As many numbers for each partner and wall; the partners come first.
  const auto walls = script_.walls.size();
  const double partners = contacts.front();
  if (!(partners >= 0 && partners < 0x1p20)) return false;
  for (const std::size_t numbers : {std::size_t{3}, std::size_t{4}}) {
    const auto pairs = static_cast<std::size_t>(partners) * (1 + numbers);
    if (contacts.size() == 1 + pairs + walls * numbers) return true;
  }
  return false;
}

void LammpsSimulation::save(const ParticleState& spheres, std::vector<double>& rows) const {
  const std::vector<LAMMPS_NS::Fix*> memories = this->memories();
  const int* const tag = of_atoms<int>("id");
  const std::array<double* const*, 5> vectors{of_atoms<double*>("x"), of_atoms<double*>("v"),
                                              of_atoms<double*>("omega"), of_atoms<double*>("f"),
                                              of_atoms<double*>("torque")};
  int most = 64;
  for (const LAMMPS_NS::Fix* memory : memories) most += std::max(16, memory->maxexchange);
  packed_.resize(static_cast<std::size_t>(most));
  for (int i = 0; i < own(); ++i) {
    rows.push_back(row_of(spheres, tag[i]));
    for (double* const* vector : vectors) rows.insert(rows.end(), vector[i], vector[i] + 3);
    int numbers = 0;
    for (LAMMPS_NS::Fix* memory : memories) {
      numbers += memory->pack_exchange(i, packed_.data() + numbers);
    }
    rows.push_back(numbers);
    rows.insert(rows.end(), packed_.begin(), packed_.begin() + numbers);
  }
}

}  // namespace

std::unique_ptr<ParticleEngine> make_lammps_engine(const Scene& scene, const Mesh& mesh,
                                                   ParticleState initial) {
  ContactLaws laws(scene.particles);
  ParticleState spheres = checked_rows(std::move(initial), laws.walls());
  const Domain domain = particle_domain(scene, mesh);
  auto simulation = std::make_unique<LammpsSimulation>(
      LammpsScene{domain, laws, scene.scene.gravity, spheres, !scene.particles.inflow.empty()});
  return make_granular_engine(scene, mesh, "lammps", std::move(laws), std::move(spheres),
                              std::move(simulation));
}

}  // namespace fluxpact
