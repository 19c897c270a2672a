#include "cfd_server/linear/lattice_multigrid.hpp"

#include <HYPRE_struct_ls.h>
#include <mpi.h>

#include <array>
#include <cmath>

#include "cfd_server/linear/hypre_session.hpp"
#include "cfd_server/linear/preconditioned_gradients.hpp"

namespace fluxpact {
namespace {

class LatticeMultigrid final : public PressureSolver {
 public:
  LatticeMultigrid(const Lattice& lattice, const Stencil& stencil)
      : stencil_(stencil), gradients_(stencil) {
    start_hypre();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      size_[axis] = static_cast<int>(lattice.nodes[axis].size()) - 1;
      upper_[axis] = size_[axis] - 1;
      // Through a period of two cells both faces join the same pair: one coupling, no wrap needed.
      wrap_[axis] = lattice.periodic[axis] && size_[axis] > 2 ? size_[axis] : 0;
    }
    place_faces();
    create_grid();
    values_.assign(static_cast<std::size_t>(stencil.cells), 0.0);
  }

  ~LatticeMultigrid() override {
    destroy_cycle();
    HYPRE_StructVectorDestroy(solution_);
    HYPRE_StructVectorDestroy(rhs_);
    HYPRE_StructMatrixDestroy(matrix_);
    HYPRE_StructStencilDestroy(shape_);
    HYPRE_StructGridDestroy(grid_);
  }
  LatticeMultigrid(const LatticeMultigrid&) = delete;
  LatticeMultigrid& operator=(const LatticeMultigrid&) = delete;

  void setup(const PressureMatrix& matrix) override {
    const OneThread hypre;
    current_ = &matrix;
    std::array<double, 3> mean{};  // coupling along each axis, what multigrid coarsens by
    for (int entry = 0; entry < 4; ++entry) {
      if (entry == 0) {
        std::ranges::copy(matrix.diagonal, values_.begin());
      } else {
        mean[static_cast<std::size_t>(entry - 1)] = -gather_couplings(matrix, entry);
      }
      HYPRE_StructMatrixSetBoxValues(matrix_, lower_.data(), upper_.data(), 1, &entry,
                                     values_.data());
    }
    HYPRE_StructMatrixAssemble(matrix_);
    destroy_cycle();
    create_cycle(mean);
    HYPRE_StructPFMGSetup(cycle_, matrix_, rhs_, solution_);
    check_hypre("HYPRE_StructPFMGSetup");
  }

  int iterate(std::span<const double> rhs, std::span<double> x, double tolerance) override {
    constexpr int most_iterations = 500;
    const OneThread hypre;
    const int iterations = gradients_.solve(
        *current_, rhs, x, tolerance, most_iterations,
        [&](std::span<const double> r, std::span<double> z) {
          // hypre takes its input as non-const, and leaves it alone.
          HYPRE_StructVectorSetBoxValues(rhs_, lower_.data(), upper_.data(),
                                         const_cast<double*>(r.data()));
          HYPRE_StructPFMGSolve(cycle_, matrix_, rhs_, solution_);
          HYPRE_StructVectorGetBoxValues(solution_, lower_.data(), upper_.data(), z.data());
        });
    check_hypre("HYPRE_StructPFMGSolve");
    return iterations;
  }

 private:
  /// Entry `entry` of each cell, from the faces that have their place there; returns the sum.
  double gather_couplings(const PressureMatrix& matrix, int entry) {
    return blocked_sum<double>(stencil_.cells, stencil_.threads, [&](int cell) {
      double value = 0;
      for (int side = stencil_.side_offsets[cell]; side < stencil_.side_offsets[cell + 1]; ++side) {
        const int f = stencil_.side_face[side];
        if (f < stencil_.internal_faces && place_[f] == 4 * cell + entry)
          value -= matrix.coupling[f];
      }
      values_[cell] = value;
      return value;
    });
  }

  /// Where each internal face's coupling stands among the four entries a cell: with the later of
  /// its two cells, or, across a wrapped period, with the first cell of the row, whose lower
  /// neighbour is the last.
  void place_faces() {
    place_.assign(static_cast<std::size_t>(stencil_.internal_faces), -1);
    const std::array<int, 3> stride{1, size_[0], size_[0] * size_[1]};
    for (int f = 0; f < stencil_.internal_faces; ++f) {
      const int p = stencil_.owner[f];
      const int n = stencil_.neighbour[f];
      if (p == n) continue;
      int axis = 0;
      stencil_.area[f].cwiseAbs().maxCoeff(&axis);
      const bool adjacent = std::abs(p - n) == stride[static_cast<std::size_t>(axis)];
      place_[f] = 4 * (adjacent ? std::max(p, n) : std::min(p, n)) + 1 + axis;
    }
  }

  void create_grid() {
    HYPRE_StructGridCreate(MPI_COMM_SELF, 3, &grid_);
    HYPRE_StructGridSetExtents(grid_, lower_.data(), upper_.data());
    HYPRE_StructGridSetPeriodic(grid_, wrap_.data());
    HYPRE_StructGridAssemble(grid_);
    HYPRE_StructStencilCreate(3, 4, &shape_);
    std::array<std::array<int, 3>, 4> offsets{{{0, 0, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
    for (int entry = 0; entry < 4; ++entry) {
      HYPRE_StructStencilSetElement(shape_, entry, offsets[static_cast<std::size_t>(entry)].data());
    }
    HYPRE_StructMatrixCreate(MPI_COMM_SELF, grid_, shape_, &matrix_);
    HYPRE_StructMatrixSetSymmetric(matrix_, 1);
    HYPRE_StructMatrixInitialize(matrix_);
    for (auto* vector : {&rhs_, &solution_}) {
      HYPRE_StructVectorCreate(MPI_COMM_SELF, grid_, vector);
      HYPRE_StructVectorInitialize(*vector);
      HYPRE_StructVectorAssemble(*vector);
    }
    check_hypre("the set-up of the lattice");
  }

  /// One symmetric cycle from zero. PFMG coarsens the axis of the strongest coupling first: it is
  /// given the mean couplings.
  void create_cycle(const std::array<double, 3>& mean) {
    HYPRE_StructPFMGCreate(MPI_COMM_SELF, &cycle_);
    HYPRE_StructPFMGSetMaxIter(cycle_, 1);
    HYPRE_StructPFMGSetTol(cycle_, 0.0);
    HYPRE_StructPFMGSetZeroGuess(cycle_);
    HYPRE_StructPFMGSetNumPreRelax(cycle_, 1);
    HYPRE_StructPFMGSetNumPostRelax(cycle_, 1);
    // Conjugate gradients ask for a symmetric smoother. Symmetric red-black Gauss-Seidel (2) is the
    // best, but a period that is odd on some level has no two colours: then weighted Jacobi (1).
    const bool wraps = wrap_[0] + wrap_[1] + wrap_[2] > 0;
    HYPRE_StructPFMGSetRelaxType(cycle_, wraps ? 1 : 2);
    if (wraps) HYPRE_StructPFMGSetJacobiWeight(cycle_, 2.0 / 3.0);
    HYPRE_StructPFMGSetRAPType(cycle_, 0);
    const double strongest = std::max({mean[0], mean[1], mean[2]});
    std::array<double, 3> spacing{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      spacing[axis] = mean[axis] > 0 ? std::sqrt(strongest / mean[axis]) : 1e150;
    if (strongest == 0) spacing = {1, 1, 1};
    HYPRE_StructPFMGSetDxyz(cycle_, spacing.data());
    // PFMG saves time by smoothing only where it coarsens an axis anew. In tall cells, with two
    // strong axes beside a weak one, that takes 62 iterations instead of 13.
    const double weakest = std::max({spacing[0], spacing[1], spacing[2]});
    HYPRE_StructPFMGSetSkipRelax(cycle_, weakest > 10 ? 0 : 1);
  }

  void destroy_cycle() {
    if (cycle_ != nullptr) HYPRE_StructPFMGDestroy(cycle_);
    cycle_ = nullptr;
  }

  const Stencil& stencil_;
  PreconditionedGradients gradients_;
  const PressureMatrix* current_ = nullptr;
  std::array<int, 3> size_{};
  std::array<int, 3> lower_{};
  std::array<int, 3> upper_{};
  std::array<int, 3> wrap_{};
  std::vector<int> place_;
  std::vector<double> values_;
  HYPRE_StructGrid grid_ = nullptr;
  HYPRE_StructStencil shape_ = nullptr;
  HYPRE_StructMatrix matrix_ = nullptr;
  HYPRE_StructVector rhs_ = nullptr;
  HYPRE_StructVector solution_ = nullptr;
  HYPRE_StructSolver cycle_ = nullptr;
};

}  // namespace

std::unique_ptr<PressureSolver> make_lattice_multigrid(const Lattice& lattice,
                                                       const Stencil& stencil) {
  return std::make_unique<LatticeMultigrid>(lattice, stencil);
}

}  // namespace fluxpact
