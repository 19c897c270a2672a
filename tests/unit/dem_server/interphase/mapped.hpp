// Particles on a mesh, mapped: for the tests of the maps.
#pragma once

#include <span>
#include <vector>

#include "dem_server/interphase/voidage.hpp"
#include "proto/base/compensated_sum.hpp"

namespace fluxpact {

struct Mapped {
  Mapped(const Mesh& mesh_, const VoidageSettings& settings, int threads = 1)
      : mesh(mesh_),
        builder(mesh_, settings, threads),
        excess(mesh_, settings.smallest),
        voidage(mesh_.cell_volumes.size()) {}

  /// At the end of step 7.
  void map(const ParticleState& particles, int threads = 1) {
    builder.build(particles, 7, weights);
    particle_volumes(particles, volumes);
    moved = map_voidage(weights, volumes, mesh.cell_volumes, excess, 7, threads, voidage);
  }
  /// (Σ (1−ε) V − Σ V_p)/Σ V_p.
  double volume_error() const {
    CompensatedSum sum;
    CompensatedSum solids;
    for (std::size_t c = 0; c < voidage.size(); ++c) {
      sum.add((1 - voidage[c]) * mesh.cell_volumes[c]);
    }
    for (const double volume : volumes) {
      sum.add(-volume);
      solids.add(volume);
    }
    return sum.value() / solids.value();
  }
  std::vector<double> deposited(std::span<const double> of_particles) const {
    std::vector<double> cells(voidage.size());
    for (int c = 0; c < mesh.cells(); ++c) {
      weights.deposit(
          c, [&](double part) { cells[c] += part; }, [&](int p) { return of_particles[p]; });
    }
    weights.spread(std::span<double>(cells));
    return cells;
  }

  const Mesh& mesh;
  WeightsBuilder builder;
  ExcessFinder excess;
  ParticleCellWeights weights;
  std::vector<double> volumes;
  std::vector<double> voidage;
  double moved = 0;
};

}  // namespace fluxpact
