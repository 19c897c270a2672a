#include "cfd_server/linear/algebraic_multigrid.hpp"

#include <HYPRE.h>
#include <HYPRE_krylov.h>
#include <HYPRE_parcsr_ls.h>
#include <mpi.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "cfd_server/linear/hypre_session.hpp"

namespace fluxpact {
namespace {

class AlgebraicMultigrid final : public PressureSolver {
 public:
  explicit AlgebraicMultigrid(const Stencil& stencil) : stencil_(stencil) {
    start_hypre();
    build_pattern();
    const int last = stencil.cells - 1;
    HYPRE_IJMatrixCreate(MPI_COMM_SELF, 0, last, 0, last, &matrix_);
    HYPRE_IJMatrixSetObjectType(matrix_, HYPRE_PARCSR);
    HYPRE_IJMatrixSetRowSizes(matrix_, row_sizes_.data());
    for (auto* vector : {&rhs_, &solution_}) {
      HYPRE_IJVectorCreate(MPI_COMM_SELF, 0, last, vector);
      HYPRE_IJVectorSetObjectType(*vector, HYPRE_PARCSR);
      HYPRE_IJVectorInitialize(*vector);
    }
    check_hypre("the set-up of the matrix");
  }

  ~AlgebraicMultigrid() override {
    destroy_solver();
    HYPRE_IJVectorDestroy(solution_);
    HYPRE_IJVectorDestroy(rhs_);
    HYPRE_IJMatrixDestroy(matrix_);
  }
  AlgebraicMultigrid(const AlgebraicMultigrid&) = delete;
  AlgebraicMultigrid& operator=(const AlgebraicMultigrid&) = delete;

  void setup(const PressureMatrix& matrix) override {
    const OneThread one_thread;
    std::ranges::fill(values_, 0.0);
    for (int cell = 0; cell < stencil_.cells; ++cell)
      values_[diagonal_place_[cell]] = matrix.diagonal[cell];
    for (int f = 0; f < stencil_.internal_faces; ++f) {
      if (stencil_.owner[f] == stencil_.neighbour[f]) continue;
      values_[upper_place_[f]] -= matrix.coupling[f];
      values_[lower_place_[f]] -= matrix.coupling[f];
    }
    HYPRE_IJMatrixInitialize(matrix_);
    HYPRE_IJMatrixSetValues(matrix_, stencil_.cells, row_sizes_.data(), rows_.data(),
                            columns_.data(), values_.data());
    HYPRE_IJMatrixAssemble(matrix_);
    destroy_solver();
    create_solver();
    HYPRE_ParCSRPCGSetup(solver_, parcsr(), vector_of(rhs_), vector_of(solution_));
    check_hypre("HYPRE_ParCSRPCGSetup");
  }

  int iterate(std::span<const double> rhs, std::span<double> x, double tolerance) override {
    const OneThread one_thread;
    HYPRE_IJVectorSetValues(rhs_, stencil_.cells, rows_.data(), rhs.data());
    HYPRE_IJVectorSetValues(solution_, stencil_.cells, rows_.data(), x.data());
    HYPRE_IJVectorAssemble(rhs_);
    HYPRE_IJVectorAssemble(solution_);
    HYPRE_PCGSetTol(solver_, tolerance);
    HYPRE_ParCSRPCGSolve(solver_, parcsr(), vector_of(rhs_), vector_of(solution_));
    int iterations = 0;
    HYPRE_PCGGetNumIterations(solver_, &iterations);
    HYPRE_IJVectorGetValues(solution_, stencil_.cells, rows_.data(), x.data());
    check_hypre("HYPRE_ParCSRPCGSolve");
    return iterations;
  }

 private:
  /// Rows with their columns, one entry for all faces that join the same pair; and where each
  /// face's value goes.
  void build_pattern() {
    rows_.resize(static_cast<std::size_t>(stencil_.cells));
    std::iota(rows_.begin(), rows_.end(), 0);
    upper_place_.assign(static_cast<std::size_t>(stencil_.internal_faces), 0);
    lower_place_.assign(static_cast<std::size_t>(stencil_.internal_faces), 0);
    for (int cell = 0; cell < stencil_.cells; ++cell) {
      std::map<int, int> place_of_column;
      const auto place = [&](int column) {
        const auto [entry, added] =
            place_of_column.try_emplace(column, static_cast<int>(columns_.size()));
        if (added) columns_.push_back(column);
        return entry->second;
      };
      diagonal_place_.push_back(place(cell));
      for (int side = stencil_.side_offsets[cell]; side < stencil_.side_offsets[cell + 1]; ++side) {
        const int other = stencil_.side_other[side];
        if (other < 0 || other == cell) continue;
        (stencil_.side_sign[side] > 0 ? upper_place_ : lower_place_)[stencil_.side_face[side]] =
            place(other);
      }
      row_sizes_.push_back(static_cast<int>(place_of_column.size()));
    }
    values_.assign(columns_.size(), 0.0);
  }

  HYPRE_ParCSRMatrix parcsr() const {
    void* object = nullptr;
    HYPRE_IJMatrixGetObject(matrix_, &object);
    return static_cast<HYPRE_ParCSRMatrix>(object);
  }

  static HYPRE_ParVector vector_of(HYPRE_IJVector vector) {
    void* object = nullptr;
    HYPRE_IJVectorGetObject(vector, &object);
    return static_cast<HYPRE_ParVector>(object);
  }

  void create_solver() {
    HYPRE_BoomerAMGCreate(&preconditioner_);
    HYPRE_BoomerAMGSetCoarsenType(preconditioner_, 10);  // HMIS
    HYPRE_BoomerAMGSetInterpType(preconditioner_, 6);    // extended+i
    HYPRE_BoomerAMGSetPMaxElmts(preconditioner_, 4);
    HYPRE_BoomerAMGSetAggNumLevels(preconditioner_, 1);
    HYPRE_BoomerAMGSetRelaxType(preconditioner_,
                                8);  // symmetric l1-Gauss-Seidel, as conjugate gradients ask
    HYPRE_BoomerAMGSetStrongThreshold(preconditioner_, 0.5);
    HYPRE_BoomerAMGSetMaxIter(preconditioner_, 1);
    HYPRE_BoomerAMGSetTol(preconditioner_, 0.0);
    HYPRE_ParCSRPCGCreate(MPI_COMM_SELF, &solver_);
    HYPRE_PCGSetTwoNorm(solver_, 1);
    HYPRE_PCGSetMaxIter(solver_, 500);
    HYPRE_ParCSRPCGSetPrecond(solver_, HYPRE_BoomerAMGSolve, HYPRE_BoomerAMGSetup, preconditioner_);
  }

  void destroy_solver() {
    if (solver_ == nullptr) return;
    HYPRE_ParCSRPCGDestroy(solver_);
    HYPRE_BoomerAMGDestroy(preconditioner_);
    solver_ = nullptr;
    preconditioner_ = nullptr;
  }

  const Stencil& stencil_;
  std::vector<int> rows_, row_sizes_, columns_, diagonal_place_, upper_place_, lower_place_;
  std::vector<double> values_;
  HYPRE_IJMatrix matrix_ = nullptr;
  HYPRE_IJVector rhs_ = nullptr;
  HYPRE_IJVector solution_ = nullptr;
  HYPRE_Solver preconditioner_ = nullptr;
  HYPRE_Solver solver_ = nullptr;
};

}  // namespace

std::unique_ptr<PressureSolver> make_algebraic_multigrid(const Stencil& stencil) {
  return std::make_unique<AlgebraicMultigrid>(stencil);
}

}  // namespace fluxpact
