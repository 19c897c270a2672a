#include "cfd_server/linear/hypre_session.hpp"

#include <HYPRE_utilities.h>
#include <mpi.h>
#include <omp.h>

#include <cstdlib>

#include "proto/base/errors.hpp"

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

namespace fluxpact {
namespace {

/// Open MPI keeps what it allocates in MPI_Init, partly in plug-ins that are gone when the leak
/// check looks: not ours to report.
class LeaksNotOurs {
 public:
#ifdef __SANITIZE_ADDRESS__
  LeaksNotOurs() { __lsan_disable(); }
  ~LeaksNotOurs() { __lsan_enable(); }
#else
  LeaksNotOurs() = default;
  ~LeaksNotOurs() {}
#endif
  LeaksNotOurs(const LeaksNotOurs&) = delete;
  LeaksNotOurs& operator=(const LeaksNotOurs&) = delete;
};

void end_mpi() {
  int finalized = 0;
  MPI_Finalized(&finalized);
  const LeaksNotOurs leaks;
  if (finalized == 0) MPI_Finalize();
}

}  // namespace

void start_hypre() {
  int initialized = 0;
  MPI_Initialized(&initialized);
  if (initialized == 0) {
    // One process needs no daemon and no network; what the user has set stays. Nor has it anybody
    // to meet in a folder of the temporary files, which has the same name for all such processes:
    // two that start or end at once would trip over each other's.
    setenv("OMPI_MCA_orte_create_session_dirs", "false", 0);
    setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
    setenv("OMPI_MCA_btl", "self", 0);
    setenv("OMPI_MCA_pml", "ob1", 0);
    const LeaksNotOurs leaks;
    if (MPI_Init(nullptr, nullptr) != MPI_SUCCESS) {
      throw SystemError(
          "hypre: MPI_Init failed; choose fluid.numerics.solver: conjugate_gradient to do without");
    }
    HYPRE_Init();
    std::atexit(end_mpi);
  }
}

OneThread::OneThread() : before_(omp_get_max_threads()) { omp_set_num_threads(1); }
OneThread::~OneThread() { omp_set_num_threads(before_); }

void check_hypre(const char* call) {
  const int error = HYPRE_GetError();
  if (error == 0) return;
  HYPRE_ClearAllErrors();
  if (error == HYPRE_ERROR_CONV) return;
  throw NumericsError(
      "fluid: hypre reports error {} in {}; choose fluid.numerics.solver: conjugate_gradient to do "
      "without",
      error, call);
}

}  // namespace fluxpact
