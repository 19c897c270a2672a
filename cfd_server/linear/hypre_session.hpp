// hypre and the MPI it is built on, started on first use and ended when the program ends.
#pragma once

namespace fluxpact {

/// Start MPI (as one process, without its launcher daemon) and hypre unless that has been done. MPI
/// that somebody else started is left to them to end.
void start_hypre();

/// Holds OpenMP to one thread while hypre works. Debian's hypre knows no threads; in one that is
/// built with OpenMP (2.26) even the structured cycle gives other bits for other numbers of them.
class OneThread {
 public:
  OneThread();
  ~OneThread();
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int before_;
};

/// Throws NumericsError naming the call if hypre reports an error other than "not converged yet".
void check_hypre(const char* call);

}  // namespace fluxpact
