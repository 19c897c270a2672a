#include "dem_server/backends/liggghts/liggghts_engine.hpp"

// clang-format off: they want this order
#include <liggghts/atom.h>
#include <liggghts/atom_vec.h>
#include <liggghts/domain.h>
#include <liggghts/fix_contact_history.h>
#include <liggghts/fix_external.h>
#include <liggghts/force.h>
#include <liggghts/lammps.h>
#include <liggghts/library.h>
#include <liggghts/modify.h>
#include <liggghts/neigh_list.h>
#include <liggghts/neighbor.h>
#include <liggghts/pair_gran.h>
// clang-format on

#include <algorithm>
#include <array>
#include <string_view>

#include "dem_server/backends/granular/granular_engine.hpp"
#include "dem_server/backends/granular/screen.hpp"
#include "dem_server/backends/liggghts/liggghts_script.hpp"
#include "dem_server/backends/particle_rows.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

constexpr int spring_numbers = 3;  // of a contact

class LiggghtsSimulation final : public Simulation {
 public:
  LiggghtsSimulation(const Domain& domain, const ContactLaws& laws, const Vector3& gravity,
                     const ParticleState& spheres, std::vector<SphereKind> kinds);

  void check(const ParticleState& spheres) const override;
  void load(const ParticleState& spheres, const Motions& motions, std::span<const Vector3> force,
            double time_step) override;
  void run(int steps) override { command(fmt::format("run {} pre no post no", steps)); }
  void save(const ParticleState& spheres, std::vector<double>& rows) const override;
  bool fits(std::span<const double> contacts) const override;
  std::int64_t rebuilds() const override { return library().neighbor->ncalls; }

 private:
  struct Close {
    void operator()(void* liggghts) const { lammps_close(liggghts); }
  };

  LAMMPS_NS::LAMMPS& library() const { return *static_cast<LAMMPS_NS::LAMMPS*>(liggghts_.get()); }
  void command(const std::string& words) const { lammps_command(liggghts_.get(), words.c_str()); }
  void create(const ParticleState& spheres, const Motions& motions) const;
  void take_up(const ParticleState& spheres, const Motions& motions,
               std::span<const Vector3> force) const;
  LAMMPS_NS::PairGran& pairs() const {
    return static_cast<LAMMPS_NS::PairGran&>(*library().force->pair);
  }
  std::vector<LAMMPS_NS::Fix*> wall_springs() const;

  Ranks ranks_;
  int walls_;
  std::vector<SphereKind> kinds_;
  std::vector<std::string> groups_;  ///< commands, whenever atoms were put in
  std::unique_ptr<void, Close> liggghts_;
};

int row_of(const ParticleState& spheres, int tag) {
  const auto guess = static_cast<std::size_t>(tag - spheres.id.front());
  if (guess < spheres.id.size() && spheres.id[guess] == tag) return static_cast<int>(guess);
  return static_cast<int>(std::ranges::lower_bound(spheres.id, tag) - spheres.id.begin());
}

LiggghtsSimulation::LiggghtsSimulation(const Domain& domain, const ContactLaws& laws,
                                       const Vector3& gravity, const ParticleState& spheres,
                                       std::vector<SphereKind> kinds)
    : walls_(static_cast<int>(std::ranges::count(domain.sides, SideKind::wall))),
      kinds_(std::move(kinds)) {
  std::array<const char*, 5> words{"liggghts", "-log", "none", "-screen", "none"};
  void* opened = nullptr;
  lammps_open(static_cast<int>(words.size()), const_cast<char**>(words.data()), ranks_.all(),
              &opened);
  liggghts_.reset(opened);
  if (!liggghts_) throw SystemError("liggghts: the library did not start");
  if (ranks_.rank() == 0) library().screen = open_log_stream("liggghts");
  for (const std::string& line : liggghts_script(domain, laws, gravity, spheres, kinds_)) {
    command(line);
    if (line.starts_with("group ")) groups_.push_back(line);
  }
}

void LiggghtsSimulation::check(const ParticleState& spheres) const {
  for (int row = 0; row < spheres.size(); ++row) {
    if (std::ranges::find(kinds_, kind_of(spheres, row)) != kinds_.end()) continue;
    throw ConfigError(
        "particle {}: the liggghts engine was not made for a sphere of its material, mass and "
        "freedom; restore with the scene that the state was stored with",
        spheres.id[row]);
  }
}

/// The property/atom fixes in which each wall keeps the springs of its contacts.
std::vector<LAMMPS_NS::Fix*> LiggghtsSimulation::wall_springs() const {
  std::vector<LAMMPS_NS::Fix*> found;
  const LAMMPS_NS::Modify& modify = *library().modify;
  for (int k = 0; k < modify.nfix; ++k) {
    if (std::string_view(modify.fix[k]->id).starts_with("history_wall_")) {
      found.push_back(modify.fix[k]);
    }
  }
  return found;
}

void LiggghtsSimulation::create(const ParticleState& spheres, const Motions& motions) const {
  LAMMPS_NS::Atom& atom = *library().atom;
  const LAMMPS_NS::Domain& box = *library().domain;
  if (atom.natoms > 0) command("delete_atoms group all compress no");
  for (int row = 0; row < spheres.size(); ++row) {
    const Vector3& at = motions.position[row];
    bool ours = true;
    for (int axis = 0; axis < 3; ++axis) {
      ours = ours && at[axis] >= box.sublo[axis] && at[axis] < box.subhi[axis];
    }
    if (!ours) continue;
    Vector3 position = at;
    const int i = atom.nlocal;
    const auto kind = std::ranges::find(kinds_, kind_of(spheres, row));
    atom.avec->create_atom(static_cast<int>(kind - kinds_.begin()) + first_type(walls_ > 0),
                           position.data());
    atom.tag[i] = static_cast<int>(spheres.id[row]);
    atom.radius[i] = spheres.radius[row];
    atom.density[i] = spheres.density[row];
    atom.rmass[i] = sphere_mass(spheres.radius[row], spheres.density[row]);
    std::copy_n(motions.velocity[row].data(), 3, atom.v[i]);
    std::copy_n(motions.spin[row].data(), 3, atom.omega[i]);
    for (int k = 0; k < library().modify->nfix; ++k) {
      LAMMPS_NS::Fix& fix = *library().modify->fix[k];
      if (fix.create_attribute) fix.set_arrays(i);
    }
  }
  atom.natoms = spheres.size();
  atom.map_init();
  atom.map_set();
}

void LiggghtsSimulation::load(const ParticleState& spheres, const Motions& motions,
                              std::span<const Vector3> force, double time_step) {
  command(fmt::format("timestep {:.17g}", time_step));
  create(spheres, motions);
  for (const std::string& line : groups_) command(line);
  const LAMMPS_NS::Atom& atom = *library().atom;
  auto& fluid = static_cast<LAMMPS_NS::FixExternal&>(*library().modify->find_fix_id("fluid"));
  for (int i = 0; i < atom.nlocal; ++i) {
    std::copy_n(force[row_of(spheres, atom.tag[i])].data(), 3, fluid.fexternal[i]);
  }
  command("run 0 post no");
  if (!motions.force.empty()) take_up(spheres, motions, force);
}

/// A run's set-up finds forces at the full velocity, and lets sliding contacts slip on: the run is
/// to go on with the forces and springs that it ended with instead.
void LiggghtsSimulation::take_up(const ParticleState& spheres, const Motions& motions,
                                 std::span<const Vector3> force) const {
  const LAMMPS_NS::Atom& atom = *library().atom;
  const std::vector<LAMMPS_NS::Fix*> walls = wall_springs();
  const LAMMPS_NS::NeighList& list = *pairs().list;
  for (int i = 0; i < atom.nlocal; ++i) {
    const auto row = static_cast<std::size_t>(row_of(spheres, atom.tag[i]));
    const Vector3 all = motions.force[row] + force[row];
    std::copy_n(all.data(), 3, atom.f[i]);
    std::copy_n(motions.torque[row].data(), 3, atom.torque[i]);
    const std::span<const double> contacts = contacts_of(motions, row);
    if (contacts.empty()) continue;  // it touches nothing
    const double* next = contacts.data() + contacts.size();
    // NOLINTNEXTLINE(modernize-loop-convert): clang 14 has no std::views
    for (auto wall = walls.rbegin(); wall != walls.rend(); ++wall) {
      next -= spring_numbers;
      std::copy_n(next, spring_numbers, (*wall)->array_atom[i]);
    }
  }
  for (int k = 0; k < list.inum; ++k) {
    const int i = list.ilist[k];
    const auto row = static_cast<std::size_t>(row_of(spheres, atom.tag[i]));
    const std::span<const double> contacts = contacts_of(motions, row);
    const int partners = contacts.empty() ? 0 : static_cast<int>(contacts[0]);
    for (int p = 0; p < partners; ++p) {
      const double* const contact = contacts.data() + 1 + std::ptrdiff_t{p} * (1 + spring_numbers);
      for (int n = 0; n < list.numneigh[i]; ++n) {
        if (atom.tag[list.firstneigh[i][n] & NEIGHMASK] != static_cast<int>(contact[0])) continue;
        std::copy_n(contact + 1, spring_numbers,
                    list.listgranhistory->firstdouble[i] + std::ptrdiff_t{n} * spring_numbers);
      }
    }
  }
}

bool LiggghtsSimulation::fits(std::span<const double> contacts) const {
  if (contacts.empty()) return true;
  const double partners = contacts.front();
  if (!(partners >= 0 && partners < 0x1p20)) return false;
  return contacts.size() == 1 + static_cast<std::size_t>(partners) * (1 + spring_numbers) +
                                static_cast<std::size_t>(walls_) * spring_numbers;
}

void LiggghtsSimulation::save(const ParticleState& spheres, std::vector<double>& rows) const {
  const LAMMPS_NS::Atom& atom = *library().atom;
  const std::vector<LAMMPS_NS::Fix*> walls = wall_springs();
  LAMMPS_NS::FixContactHistory& springs = *pairs().get_fix_history();
  if (springs.get_dnum() != spring_numbers) {
    throw SystemError("liggghts: a contact keeps {} numbers, and {} were expected",
                      springs.get_dnum(), spring_numbers);
  }
  springs.pre_exchange();  // from the list of pairs to the particles
  for (int i = 0; i < atom.nlocal; ++i) {
    rows.push_back(row_of(spheres, atom.tag[i]));
    for (const double* vector : {atom.x[i], atom.v[i], atom.omega[i], atom.f[i], atom.torque[i]}) {
      rows.insert(rows.end(), vector, vector + 3);
    }
    const int partners = springs.n_partner(i);
    rows.push_back(1 + partners * (1 + spring_numbers) +
                   static_cast<int>(walls.size()) * spring_numbers);
    rows.push_back(partners);
    for (int p = 0; p < partners; ++p) {
      rows.push_back(springs.partner(i, p));
      const double* const spring = springs.contacthistory(i, p);
      rows.insert(rows.end(), spring, spring + spring_numbers);
    }
    for (const LAMMPS_NS::Fix* wall : walls) {
      rows.insert(rows.end(), wall->array_atom[i], wall->array_atom[i] + spring_numbers);
    }
  }
}

}  // namespace

std::unique_ptr<ParticleEngine> make_liggghts_engine(const Scene& scene, const Mesh& mesh,
                                                     ParticleState initial) {
  ContactLaws laws(scene.particles);
  ParticleState spheres = checked_rows(std::move(initial), laws.walls());
  std::vector<SphereKind> kinds;
  const Domain domain = particle_domain(scene, mesh);
  const bool walls = std::ranges::count(domain.sides, SideKind::wall) > 0;
  add_kinds(spheres, walls, kinds);
  add_kinds(spheres_to_come(scene), walls, kinds);
  auto simulation = std::make_unique<LiggghtsSimulation>(domain, laws, scene.scene.gravity, spheres,
                                                         std::move(kinds));
  return make_granular_engine(scene, mesh, "liggghts", std::move(laws), std::move(spheres),
                              std::move(simulation));
}

}  // namespace fluxpact
