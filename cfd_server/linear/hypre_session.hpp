// hypre and the MPI it is built on, started on first use and ended when the program ends.
#pragma once

namespace fluxpact {

/// Start MPI (as one process, without its launcher daemon) and hypre unless that has been done. MPI
/// that somebody else started is left to them to end.
void start_hypre();

/// Sets the number of threads for what hypre does meanwhile (Debian's hypre knows none; one built
/// with OpenMP does).
class HypreThreads {
 public:
  explicit HypreThreads(int threads);
  ~HypreThreads();
  HypreThreads(const HypreThreads&) = delete;
  HypreThreads& operator=(const HypreThreads&) = delete;

 private:
  int before_;
};

/// Throws NumericsError naming the call if hypre reports an error other than "not converged yet".
void check_hypre(const char* call);

}  // namespace fluxpact
