// The one map between particles and cells: sparse weights w(particle, cell), each particle's adding
// up to 1. Every quantity crosses by these weights, in both directions, so that what leaves one
// side arrives on the other. Rebuilt at the end of each window, for the new positions.
//
// A map may go on from cell to cell: diffusion over a width, and what over-full cells pass on. Then
// the whole map is W = w D, where D does not stand in the sparse part: `spread` applies its
// transpose to what was deposited, `seen` applies D to a field before it is gathered.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dem_server/backends/particle_engine.hpp"
#include "dem_server/interphase/cell_locator.hpp"
#include "dem_server/interphase/diffusion.hpp"
#include "dem_server/interphase/excess.hpp"
#include "dem_server/interphase/lattice_bell.hpp"
#include "dem_server/interphase/lattice_shares.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// The weights by rows (particles) and, the same numbers again, by columns (cells, in each of which
/// the particles ascend). A cell may stand twice in a row: once for each periodic image.
struct ParticleCellWeights {
  std::vector<std::int64_t> row_offsets;  ///< particles + 1
  std::vector<int> row_cells;
  std::vector<double> row_weights;         ///< [-]
  std::vector<std::int64_t> cell_offsets;  ///< cells + 1
  std::vector<int> cell_particles;
  std::vector<double> cell_weights;  ///< [-]
  bool whole = false;  ///< every particle is in one cell, with the weight 1: no need to read them

  const CellDiffusion* diffusion = nullptr;  ///< none: what is deposited stays there
  ExcessMoves excess;                        ///< then; `map_voidage` fills it

  int particles() const { return static_cast<int>(row_offsets.size()) - 1; }
  int cells() const { return static_cast<int>(cell_offsets.size()) - 1; }

  /// Amounts of the cells, as deposited -> as they arrive, in place.
  template <class Value>
  void spread(std::span<Value> amounts) const {
    if (diffusion != nullptr) diffusion->spread(amounts);
    if (!excess.empty()) excess.spread(amounts);
  }

  /// A field of the cells -> what to gather from; the transpose of `spread`. `room` holds it if it
  /// is not the field itself.
  template <class Value>
  std::span<const Value> seen(std::span<const Value> field, std::vector<Value>& room) const {
    if (diffusion == nullptr && excess.empty()) return field;
    room.assign(field.begin(), field.end());
    const std::span<Value> values(room);
    if (!excess.empty()) excess.average(values);
    if (diffusion != nullptr) diffusion->average(values);
    return values;
  }

  /// Σ_c w f_c for one particle: what it sees of a field of the cells.
  template <class Value>
  Value gather(int particle, std::span<const Value> cell_values, Value sum) const {
    if (whole) return sum + cell_values[row_cells[particle]];
    for (auto k = row_offsets[particle]; k < row_offsets[particle + 1]; ++k) {
      sum += row_weights[k] * cell_values[row_cells[k]];
    }
    return sum;
  }

  /// Calls use(particle, w) for all particles of one cell, in their order.
  template <class Use>
  void each_in(int cell, Use&& use) const {
    const auto last = cell_offsets[cell + 1];
    if (whole) {
      for (auto k = cell_offsets[cell]; k < last; ++k) use(cell_particles[k], 1.0);
    } else {
      for (auto k = cell_offsets[cell]; k < last; ++k) use(cell_particles[k], cell_weights[k]);
    }
  }

  /// Σ_p w f(p) for one cell, always in the order of the particles; the adjoint of `gather`.
  template <class Sum, class ParticleValue>
  void deposit(int cell, Sum&& add, ParticleValue&& value) const {
    each_in(cell, [&](int particle, double weight) { add(weight * value(particle)); });
  }
};

class WeightsBuilder {
 public:
  /// Throws ConfigError for VoidageMap::prescribed, which has no particles. `threads` >= 1. Must
  /// outlive the weights that it builds.
  WeightsBuilder(const Mesh& mesh, const VoidageSettings& settings, int threads);
  WeightsBuilder(const WeightsBuilder&) = delete;
  WeightsBuilder& operator=(const WeightsBuilder&) = delete;

  /// Weights of all particles where they are now. `exact`: the share of the ball in each cell, over
  /// its share in all cells: what pokes out of a wall goes back to its cells in proportion.
  /// `centroid`: 1 for the cell of the centre. `satellite`: the share of the points in each cell.
  /// `kernel`: the bell (1 − r²/h²)³ integrated over each cell, by midpoints of pieces no larger
  /// than h/2. `diffusion`: those of exact or centroid, with `diffusion` set. The same bits for any
  /// number of threads.
  /// Throws NumericsError (id, position, step) for a particle whose centre is outside the mesh, or
  /// with a radius beyond the shortest period.
  void build(const ParticleState& particles, std::int64_t step, ParticleCellWeights& weights);

 private:
  struct Row {
    std::vector<CellImage> images;
    LatticeShares shares;
    BellRoom bell;
    std::vector<int> cells;  ///< of all rows of one thread, one after the other
    std::vector<double> weights;
    int bad_particle = -1;
  };

  void build_rows(const ParticleState& particles, std::int64_t step, ParticleCellWeights& weights);
  void build_whole(const ParticleState& particles, std::int64_t step,
                   ParticleCellWeights& weights) const;
  bool append_row(const Ball& ball, Row& row) const;
  bool append_exact(int home, const Ball& ball, Row& row) const;
  bool append_points(int home, const Ball& ball, Row& row) const;
  bool append_bell(int home, const Ball& ball, Row& row) const;
  void integrate_bell(const Ball& ball, Row& row) const;
  double reach(double radius) const;
  int cell_of(const Vector3& point) const;
  void join_rows(const ParticleState& particles, ParticleCellWeights& weights);
  void transpose(ParticleCellWeights& weights);
  [[noreturn]] void refuse(const ParticleState& particles, int particle, std::int64_t step) const;

  CellShapes shapes_;
  CellLocator locator_;
  VoidageMap map_;         ///< of the sparse part
  double half_width_ = 0;  ///< [m] of the bell; 0: from the diameter
  int threads_;
  std::optional<LatticeOverlap> lattice_;
  std::optional<LatticeBell> lattice_bell_;
  std::optional<CellDiffusion> diffusion_;
  std::vector<Vector3> points_;  ///< of the unit ball
  std::vector<Row> rows_;        ///< one for each thread, reused
  std::vector<std::int64_t> next_;
};

}  // namespace fluxpact
