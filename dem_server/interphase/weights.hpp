// The one map between particles and cells: sparse weights w(particle, cell), each particle's adding
// up to 1. Every quantity crosses by these weights, in both directions, so that what leaves one
// side arrives on the other. Rebuilt at the end of each window, for the new positions.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dem_server/backends/particle_engine.hpp"
#include "dem_server/interphase/cell_locator.hpp"
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

  int particles() const { return static_cast<int>(row_offsets.size()) - 1; }
  int cells() const { return static_cast<int>(cell_offsets.size()) - 1; }

  /// Σ_c w f_c for one particle: what it sees of a field of the cells.
  template <class Value>
  Value gather(int particle, std::span<const Value> cell_values, Value sum) const {
    for (auto k = row_offsets[particle]; k < row_offsets[particle + 1]; ++k) {
      sum += row_weights[k] * cell_values[row_cells[k]];
    }
    return sum;
  }

  /// Σ_p w f(p) for one cell, always in the order of the particles; the adjoint of `gather`.
  template <class Sum, class ParticleValue>
  void deposit(int cell, Sum&& add, ParticleValue&& value) const {
    for (auto k = cell_offsets[cell]; k < cell_offsets[cell + 1]; ++k) {
      add(cell_weights[k] * value(cell_particles[k]));
    }
  }
};

class WeightsBuilder {
 public:
  /// Throws ConfigError for VoidageMap::prescribed, which has no particles. `threads` >= 1.
  WeightsBuilder(const Mesh& mesh, VoidageMap map, int threads);
  WeightsBuilder(const WeightsBuilder&) = delete;
  WeightsBuilder& operator=(const WeightsBuilder&) = delete;

  /// Weights of all particles where they are now. `exact`: the share of the ball in each cell, over
  /// its share in all cells: what pokes out of a wall goes back to its cells in proportion.
  /// `centroid`: 1 for the cell of the centre. The same bits for any number of threads.
  /// Throws NumericsError (id, position, step) for a particle whose centre is outside the mesh, or
  /// with a radius beyond the shortest period.
  void build(const ParticleState& particles, std::int64_t step, ParticleCellWeights& weights);

 private:
  struct Row {
    std::vector<CellImage> images;
    std::vector<int> cells;  ///< of all rows of one thread, one after the other
    std::vector<double> weights;
    int bad_particle = -1;
  };

  bool append_row(const Ball& ball, Row& row) const;
  void join_rows(const ParticleState& particles, ParticleCellWeights& weights) const;
  void transpose(ParticleCellWeights& weights);
  [[noreturn]] void refuse(const ParticleState& particles, int particle, std::int64_t step) const;

  CellShapes shapes_;
  CellLocator locator_;
  VoidageMap map_;
  int threads_;
  std::vector<Row> rows_;  ///< one for each thread, reused
  std::vector<std::int64_t> next_;
};

}  // namespace fluxpact
