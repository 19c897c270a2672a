#include "cfd_server/linear/lattice_multigrid.hpp"

#include <HYPRE_krylov.h>
#include <HYPRE_struct_ls.h>
#include <mpi.h>

#include <array>

#include "cfd_server/linear/hypre_session.hpp"

namespace fluxpact {
namespace {

class LatticeMultigrid final : public PressureSolver {
 public:
  LatticeMultigrid(const Lattice& lattice, const Stencil& stencil) : stencil_(stencil) {
    start_hypre();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      size_[axis] = static_cast<int>(lattice.nodes[axis].size()) - 1;
      upper_[axis] = size_[axis] - 1;
      // Through a period of two cells both faces join the same pair: one coupling, no wrap needed.
      wrap_[axis] = lattice.periodic[axis] && size_[axis] > 2 ? size_[axis] : 0;
    }
    place_faces();
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
    values_.assign(4 * static_cast<std::size_t>(stencil.cells), 0.0);
    check_hypre("the set-up of the lattice");
  }

  ~LatticeMultigrid() override {
    destroy_solver();
    HYPRE_StructVectorDestroy(solution_);
    HYPRE_StructVectorDestroy(rhs_);
    HYPRE_StructMatrixDestroy(matrix_);
    HYPRE_StructStencilDestroy(shape_);
    HYPRE_StructGridDestroy(grid_);
  }
  LatticeMultigrid(const LatticeMultigrid&) = delete;
  LatticeMultigrid& operator=(const LatticeMultigrid&) = delete;

  void setup(const PressureMatrix& matrix) override {
    const OneThread one_thread;
    for (int cell = 0; cell < stencil_.cells; ++cell) {
      double* entry = &values_[4 * static_cast<std::size_t>(cell)];
      entry[0] = matrix.diagonal[cell];
      entry[1] = entry[2] = entry[3] = 0;
    }
    for (int f = 0; f < stencil_.internal_faces; ++f) {
      if (place_[f] >= 0) values_[static_cast<std::size_t>(place_[f])] -= matrix.coupling[f];
    }
    std::array<int, 4> entries{0, 1, 2, 3};
    HYPRE_StructMatrixSetBoxValues(matrix_, lower_.data(), upper_.data(), 4, entries.data(),
                                   values_.data());
    HYPRE_StructMatrixAssemble(matrix_);
    destroy_solver();
    create_solver();
    HYPRE_StructPCGSetup(solver_, matrix_, rhs_, solution_);
    check_hypre("HYPRE_StructPCGSetup");
  }

  int iterate(std::span<const double> rhs, std::span<double> x, double tolerance) override {
    const OneThread one_thread;
    // hypre takes its input as non-const, and leaves it alone.
    HYPRE_StructVectorSetBoxValues(rhs_, lower_.data(), upper_.data(),
                                   const_cast<double*>(rhs.data()));
    HYPRE_StructVectorSetBoxValues(solution_, lower_.data(), upper_.data(), x.data());
    HYPRE_StructPCGSetTol(solver_, tolerance);
    HYPRE_StructPCGSolve(solver_, matrix_, rhs_, solution_);
    int iterations = 0;
    HYPRE_StructPCGGetNumIterations(solver_, &iterations);
    HYPRE_StructVectorGetBoxValues(solution_, lower_.data(), upper_.data(), x.data());
    check_hypre("HYPRE_StructPCGSolve");
    return iterations;
  }

 private:
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

  void create_solver() {
    HYPRE_StructPFMGCreate(MPI_COMM_SELF, &preconditioner_);
    HYPRE_StructPFMGSetMaxIter(preconditioner_, 1);
    HYPRE_StructPFMGSetTol(preconditioner_, 0.0);
    HYPRE_StructPFMGSetZeroGuess(preconditioner_);
    HYPRE_StructPFMGSetNumPreRelax(preconditioner_, 1);
    HYPRE_StructPFMGSetNumPostRelax(preconditioner_, 1);
    // Conjugate gradients ask for a symmetric smoother. Symmetric red-black Gauss-Seidel (2) is the
    // best, but a period that is odd on some level has no two colours: then weighted Jacobi (1).
    const bool wraps = wrap_[0] + wrap_[1] + wrap_[2] > 0;
    HYPRE_StructPFMGSetRelaxType(preconditioner_, wraps ? 1 : 2);
    HYPRE_StructPFMGSetRAPType(preconditioner_, 0);
    HYPRE_StructPCGCreate(MPI_COMM_SELF, &solver_);
    HYPRE_StructPCGSetTwoNorm(solver_, 1);
    HYPRE_StructPCGSetMaxIter(solver_, 500);
    HYPRE_StructPCGSetPrecond(solver_, HYPRE_StructPFMGSolve, HYPRE_StructPFMGSetup,
                              preconditioner_);
  }

  void destroy_solver() {
    if (solver_ == nullptr) return;
    HYPRE_StructPCGDestroy(solver_);
    HYPRE_StructPFMGDestroy(preconditioner_);
    solver_ = nullptr;
    preconditioner_ = nullptr;
  }

  const Stencil& stencil_;
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
  HYPRE_StructSolver preconditioner_ = nullptr;
  HYPRE_StructSolver solver_ = nullptr;
};

}  // namespace

std::unique_ptr<PressureSolver> make_lattice_multigrid(const Lattice& lattice,
                                                       const Stencil& stencil) {
  return std::make_unique<LatticeMultigrid>(lattice, stencil);
}

}  // namespace fluxpact
