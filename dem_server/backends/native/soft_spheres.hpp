// The native engine: its state and what it does with it. Soft spheres of one precision, with or
// without spins; the parts stand in
// soft_spheres_{setup,run,candidate,lists,exchange,state}-inl.hpp.
#pragma once

#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "dem_server/backends/engine_state.hpp"
#include "dem_server/backends/native/block_turns.hpp"
#include "dem_server/backends/native/contact_pass.hpp"
#include "dem_server/backends/native/soundness.hpp"
#include "dem_server/backends/native/step_limit.hpp"
#include "dem_server/backends/particle_rows.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {

template <class Real>
struct SavedSprings {
  BlockSprings<Real> pairs;
  Springs<Real> plane, surface;
  std::vector<SurfaceTouch> touches;
};

/// What the places of the bodies hold once particles have left and entered.
struct Places {
  std::vector<int> row;       // of the presented state
  std::vector<int> previous;  // the place in the list in use, -1: not in it
};

/// Lengths and limits that follow from the particles.
struct Sizes {
  StepLimit limit;
  RootMasses root_masses;
  double largest_radius = 0;  // [m]
  Slack slack;
  double beyond_contact = 0;  // [m] that a law reaches beyond touching surfaces
};

/// A body that its list has beyond a periodic side, through which it is presented.
struct Beyond {
  int place;
  Vector3 position;  ///< [m] of the body
};

/// Of a window in which particles entered or left: what rollback brings back.
struct BeforeExchange {
  ParticleState presented;
  Sizes sizes;
};

template <class Real, bool turning>
class SoftSpheres final : public ParticleEngine {
 public:
  SoftSpheres(const Scene& scene, const Mesh& mesh, ContactLaws laws, ParticleState initial);

  const ParticleState& particles() const override { return presented_; }
  bool mobile() const override { return true; }
  EngineCounters counters() const override;
  void advance(double window, int sub_steps, std::span<const Vector3> force,
               const Progress& progress) override;
  void exchange(std::span<const int> leaving, const ParticleState& entering) override;
  void commit() override;
  void rollback() override;
  void store(EngineState& state) const override;
  void restore(const Fields& state) override;

 private:
  using BodyRow = Body<Real, turning>;
  using LoadRow = KeptLoad<Real, turning>;
  using List = ContactList<Real>;

  void name_walls();
  void expect_inflow(const Scene& scene);
  void check_inflow() const;
  void place_walls(double time);
  bool walls_moved_far() const;
  void check_surfaces() const;
  void size_up();
  BodyRow body_of(int row) const;
  void tabulate_sides();
  void set_drive(std::span<const Vector3> force);
  void plan_turns();
  void meet(const BlockPass<Real, turning>& pass) const;
  double kick(int block) const;
  bool sweep(Phase phase, double time_step, double spring_step);
  void sort_and_list(const Places* places, bool carry_springs);
  Places take_out(std::span<const int> leaving);
  void put_in(const ParticleState& entering, Places& places);
  void wrap();
  void check(double time_step, int sub_step, int sub_steps) const;
  void set_motion(int row, BodyRow& body) const;
  void present_motion(int place);
  void present();
  void present_candidate();
  void take_back_motion();
  void give_committed(ParticleState& to) const;
  void put_beyond(const std::vector<Beyond>& bodies);
  void save_springs();
  void bring_back_springs();
  template <class Visit>
  void visit_scene(const Visit& visit) const;
  List restored_list(const StateReader& state, int count) const;
  int threads_for(const Blocks& blocks) const {
    return std::clamp(threads_, 1, std::max(1, blocks.count()));
  }

  Domain domain_;
  ContactLaws laws_;
  LawTable<Real> law_table_;
  std::array<double[4], 27> shifts_{};
  std::array<double[4], 6> planes_{};
  Vector3 gravity_;
  bool any_periodic_;
  bool flow_;  // particles come and go
  int threads_;
  Walls walls_;
  std::vector<int> surface_materials_;       // of each surface
  std::vector<WallsPresent> walls_present_;  // the materials of all walls, each once
  ParticleState to_come_;  // the smallest and the largest that each inflow can bring
  double placed_at_ = 0;   // [s] where the walls stand
  double time_ = 0;        // [s] of the committed state
  double window_ = 0;      // [s] of the candidate
  double time_step_;       // [s] of the scene
  Sizes sizes_;

  // The presented state is the newest. From the end of a window until it is rolled back or the next
  // one begins, the bodies hold the motion (positions, velocities, spins) that the window began
  // with: `swapped_`.
  ParticleState presented_;
  HugeVector<BodyRow> bodies_;
  HugeVector<LoadRow> loads_;       // of the newest state, between windows; within: drives
  HugeVector<LoadRow> kept_loads_;  // while there is a candidate: of the committed state
  std::vector<Beyond> beyond_, kept_beyond_;  // of the newest and of the committed state
  std::array<List, 3> lists_;                 // in use, kept for rollback, being made
  int list_ = 0;
  int committed_list_ = 0;
  std::vector<SavedSprings<Real>> saved_springs_;  // by block of the committed list
  std::optional<BeforeExchange> before_exchange_;
  bool has_candidate_ = false;
  bool swapped_ = false;
  BlockTurns turns_;
  HugeVector<Load<Real, turning>> sums_;  // rooms of each thread
  std::vector<double> kicks_;  // [m/s] of each block, the largest of a particle since blocks met

  // Kept between rebuilds so that they need no memory of their own each time.
  SizeLevels levels_;
  std::vector<std::array<std::int8_t, 3>> periods_;
  std::vector<bool> moved_;
  ListMaking<Real> making_;
  std::vector<CloseSearch<Real>> searches_;  // of each thread
  std::int64_t rebuilds_ = 0;
  std::int64_t sub_steps_ = 0;
};

}  // namespace fluxpact

#include "dem_server/backends/native/soft_spheres_candidate-inl.hpp"
#include "dem_server/backends/native/soft_spheres_exchange-inl.hpp"
#include "dem_server/backends/native/soft_spheres_lists-inl.hpp"
#include "dem_server/backends/native/soft_spheres_run-inl.hpp"
#include "dem_server/backends/native/soft_spheres_setup-inl.hpp"
#include "dem_server/backends/native/soft_spheres_state-inl.hpp"
