// Diffusion from cell to cell over a fixed width: what makes a sharp map between particles and
// cells smooth. One operator carries all: amounts of the particles to the cells around, and, by its
// transpose, fields of the fluid to the particles.
//
// The operator is a product of exchanges between the two cells of a face, each the exact solution
// of the diffusion between these two. Every one of them keeps amounts, leaves a uniform field as it
// is, makes nothing negative and is self-adjoint with respect to the cells' volumes; so is their
// product, as its order is the same backwards. None of it depends on a step or on the tolerance of
// a solver, whatever the shape of the cells. Symmetric splitting: Strang, SIAM J. Numer. Anal. 5
// (1968) 506-517. Diffusion as a map of particles to cells: Sun and Xiao, Int. J. Multiphase Flow
// 77 (2015) 142-157.
#pragma once

#include <span>
#include <vector>

#include "proto/mesh/mesh.hpp"

namespace fluxpact {

class CellDiffusion {
 public:
  /// `width` [m]: of a point that has spread, at half of its height. The flux between two cells is
  /// that between their centres; nothing leaves the domain.
  CellDiffusion(const Mesh& mesh, double width, int threads);

  /// Spreads amounts (of anything, per cell) in place: their sum stays to round-off.
  void spread(std::span<double> amounts) const;
  void spread(std::span<Vector3> amounts) const;

  /// The transpose of `spread`: averages a field (per volume, or intensive) in place.
  void average(std::span<double> field) const;
  void average(std::span<Vector3> field) const;

  /// Symmetric steps over all faces that the width takes.
  int steps() const { return steps_; }

 private:
  struct Exchange {
    int a = 0, b = 0;
    double share_a = 0;  ///< of the difference a − b: what a loses as a field, b as an amount [-]
    double share_b = 0;  ///< the other way round [-]
  };

  template <class Apply>
  void each_step(const Apply& apply) const;

  std::vector<Exchange> exchanges_;   ///< by colours: no two of one colour share a cell
  std::vector<std::size_t> colours_;  ///< CSR into exchanges_
  int steps_ = 0;
  int threads_ = 1;
};

}  // namespace fluxpact
