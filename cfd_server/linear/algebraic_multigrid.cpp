#include "cfd_server/linear/algebraic_multigrid.hpp"

#include <HYPRE.h>
#include <HYPRE_parcsr_ls.h>
#include <mpi.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "cfd_server/linear/hypre_session.hpp"
#include "cfd_server/linear/preconditioned_gradients.hpp"

namespace fluxpact {
namespace {

/// Rows with their columns, one entry for all faces that join the same pair; and where each face's
/// value goes.
struct RowPattern {
  std::vector<int> rows, row_sizes, columns, diagonal_place, upper_place, lower_place;

  explicit RowPattern(const Stencil& s) {
    rows.resize(static_cast<std::size_t>(s.cells));
    std::iota(rows.begin(), rows.end(), 0);
    upper_place.assign(static_cast<std::size_t>(s.internal_faces), 0);
    lower_place.assign(static_cast<std::size_t>(s.internal_faces), 0);
    for (int cell = 0; cell < s.cells; ++cell) {
      const auto first = static_cast<std::ptrdiff_t>(columns.size());
      const auto place = [&](int column) {
        const auto found = std::find(columns.begin() + first, columns.end(), column);
        const auto at = static_cast<int>(found - columns.begin());
        if (found == columns.end()) columns.push_back(column);
        return at;
      };
      diagonal_place.push_back(place(cell));
      for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
        const int other = s.side_other[side];
        if (other < 0 || other == cell) continue;
        (s.side_sign[side] > 0 ? upper_place : lower_place)[s.side_face[side]] = place(other);
      }
      row_sizes.push_back(static_cast<int>(columns.size()) - static_cast<int>(first));
    }
  }
};

/// A matrix and the multigrid that was set up for it. BoomerAMG's smoother refers to its matrix, so
/// the two live and die together.
class Hierarchy {
 public:
  Hierarchy(const Stencil& s, const RowPattern& pattern, std::vector<double>& values,
            const PressureMatrix& matrix, HYPRE_IJVector rhs, HYPRE_IJVector solution) {
    const int last = s.cells - 1;
    std::ranges::fill(values, 0.0);
    for (int cell = 0; cell < s.cells; ++cell)
      values[pattern.diagonal_place[cell]] = matrix.diagonal[cell];
    for (int f = 0; f < s.internal_faces; ++f) {
      if (s.owner[f] == s.neighbour[f]) continue;
      values[pattern.upper_place[f]] -= matrix.coupling[f];
      values[pattern.lower_place[f]] -= matrix.coupling[f];
    }
    HYPRE_IJMatrixCreate(MPI_COMM_SELF, 0, last, 0, last, &matrix_);
    HYPRE_IJMatrixSetObjectType(matrix_, HYPRE_PARCSR);
    HYPRE_IJMatrixSetRowSizes(matrix_, pattern.row_sizes.data());
    HYPRE_IJMatrixInitialize(matrix_);
    HYPRE_IJMatrixSetValues(matrix_, s.cells, const_cast<int*>(pattern.row_sizes.data()),
                            pattern.rows.data(), pattern.columns.data(), values.data());
    HYPRE_IJMatrixAssemble(matrix_);
    HYPRE_BoomerAMGCreate(&cycle_);
    HYPRE_BoomerAMGSetCoarsenType(cycle_, 10);  // HMIS
    HYPRE_BoomerAMGSetInterpType(cycle_, 6);    // extended+i
    HYPRE_BoomerAMGSetPMaxElmts(cycle_, 4);
    HYPRE_BoomerAMGSetAggNumLevels(cycle_, 1);
    // Symmetric l1-Gauss-Seidel, as conjugate gradients ask.
    HYPRE_BoomerAMGSetRelaxType(cycle_, 8);
    HYPRE_BoomerAMGSetStrongThreshold(cycle_, 0.5);
    HYPRE_BoomerAMGSetMaxIter(cycle_, 1);
    HYPRE_BoomerAMGSetTol(cycle_, 0.0);
    HYPRE_BoomerAMGSetup(cycle_, parcsr(), vector_of(rhs), vector_of(solution));
    check_hypre("HYPRE_BoomerAMGSetup");
  }
  ~Hierarchy() {
    HYPRE_BoomerAMGDestroy(cycle_);
    HYPRE_IJMatrixDestroy(matrix_);
  }
  Hierarchy(const Hierarchy&) = delete;
  Hierarchy& operator=(const Hierarchy&) = delete;

  /// One cycle from zero.
  void apply(HYPRE_IJVector rhs, HYPRE_IJVector solution) {
    HYPRE_ParVectorSetConstantValues(vector_of(solution), 0.0);
    HYPRE_BoomerAMGSolve(cycle_, parcsr(), vector_of(rhs), vector_of(solution));
  }

 private:
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

  HYPRE_IJMatrix matrix_ = nullptr;
  HYPRE_Solver cycle_ = nullptr;
};

class AlgebraicMultigrid final : public PressureSolver {
 public:
  explicit AlgebraicMultigrid(const Stencil& stencil)
      : stencil_(stencil), gradients_(stencil), pattern_(stencil) {
    start_hypre();
    values_.assign(pattern_.columns.size(), 0.0);
    for (auto* vector : {&rhs_, &solution_}) {
      HYPRE_IJVectorCreate(MPI_COMM_SELF, 0, stencil.cells - 1, vector);
      HYPRE_IJVectorSetObjectType(*vector, HYPRE_PARCSR);
      HYPRE_IJVectorInitialize(*vector);
      HYPRE_IJVectorAssemble(*vector);
    }
    check_hypre("the set-up of the vectors");
  }

  ~AlgebraicMultigrid() override {
    HYPRE_IJVectorDestroy(solution_);
    HYPRE_IJVectorDestroy(rhs_);
  }
  AlgebraicMultigrid(const AlgebraicMultigrid&) = delete;
  AlgebraicMultigrid& operator=(const AlgebraicMultigrid&) = delete;

  void begin_window() override {
    fresh_.reset();
    iterations_ = 0;
  }

  void commit() override {
    if (fresh_) {
      kept_ = std::move(fresh_);
      fewest_iterations_ = iterations_;
      lost_ = 0;
    } else {
      fewest_iterations_ = std::min(fewest_iterations_, iterations_);
      lost_ += iterations_ - fewest_iterations_;
      if (lost_ >= iterations_of_setup) kept_.reset();
    }
  }

  void forget() override {
    kept_.reset();
    fresh_.reset();
  }

  void setup(const PressureMatrix& matrix) override {
    current_ = &matrix;
    if (!kept_ && !fresh_) build();
  }

  int iterate(std::span<const double> rhs, std::span<double> x, double tolerance) override {
    // A kept multigrid that suits the matrix no more gets no longer than this before it is renewed.
    int iterations = solve(rhs, x, tolerance, fresh_ ? 500 : 50);
    if (!gradients_.converged() && !fresh_) {
      build();
      iterations += solve(rhs, x, tolerance, 500);
    }
    iterations_ += iterations;
    return iterations;
  }

 private:
  /// What a set-up costs, in iterations: 7 at two million cells, 12 at 64 thousand.
  static constexpr int iterations_of_setup = 10;

  void build() {
    // hypre's Gauss-Seidel works on the threads' blocks: its result must not depend on their
    // number.
    const HypreThreads one(1);
    fresh_.reset();
    fresh_ = std::make_unique<Hierarchy>(stencil_, pattern_, values_, *current_, rhs_, solution_);
  }

  int solve(std::span<const double> rhs, std::span<double> x, double tolerance, int most) {
    const HypreThreads one(1);
    Hierarchy& hierarchy = fresh_ ? *fresh_ : *kept_;
    const int iterations = gradients_.solve(
        *current_, rhs, x, tolerance, most, [&](std::span<const double> r, std::span<double> z) {
          HYPRE_IJVectorSetValues(rhs_, stencil_.cells, pattern_.rows.data(), r.data());
          hierarchy.apply(rhs_, solution_);
          HYPRE_IJVectorGetValues(solution_, stencil_.cells, pattern_.rows.data(), z.data());
        });
    check_hypre("HYPRE_BoomerAMGSolve");
    return iterations;
  }

  const Stencil& stencil_;
  PreconditionedGradients gradients_;
  RowPattern pattern_;
  std::vector<double> values_;
  HYPRE_IJVector rhs_ = nullptr;
  HYPRE_IJVector solution_ = nullptr;
  const PressureMatrix* current_ = nullptr;

  // What decides about the next set-up changes on commit only: a repeated window finds it as it
  // was.
  std::unique_ptr<Hierarchy> kept_;   ///< of a committed window; none: the next window builds anew
  std::unique_ptr<Hierarchy> fresh_;  ///< built in the window in hand
  int fewest_iterations_ = 0;         ///< of a window with kept_
  int lost_ = 0;        ///< iterations beyond these in the windows since kept_ was built
  int iterations_ = 0;  ///< of the window in hand
};

}  // namespace

std::unique_ptr<PressureSolver> make_algebraic_multigrid(const Stencil& stencil) {
  return std::make_unique<AlgebraicMultigrid>(stencil);
}

}  // namespace fluxpact
