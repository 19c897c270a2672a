// The ranks of MPI that share one particle side. Each presents a constant share of the particles,
// a run of rows, whatever rank the library has them on.
#pragma once

#include <mpi.h>

#include <span>
#include <vector>

namespace fluxpact {

/// MPI from the first line of a program to its last.
class MpiSession {
 public:
  MpiSession(int* argc, char*** argv);
  ~MpiSession();
  MpiSession(const MpiSession&) = delete;
  MpiSession& operator=(const MpiSession&) = delete;
};

class Ranks {
 public:
  /// All ranks of the program, which has an MpiSession.
  Ranks();

  MPI_Comm all() const { return all_; }
  int rank() const { return rank_; }
  int size() const { return size_; }
  /// First row of a rank's share of `rows`; that of rank `size` is `rows`.
  int first_row(int rank, int rows) const {
    return static_cast<int>(static_cast<long long>(rows) * rank / size_);
  }
  int first_row(int rows) const { return first_row(rank_, rows); }
  int end_row(int rows) const { return first_row(rank_ + 1, rows); }

  /// The parts of all ranks, one after the other, on each rank.
  void gather(std::span<const double> part, std::vector<double>& all) const;
  /// The sums over all ranks, on each rank, in place: the same bits everywhere.
  void add_up(std::span<double> values) const;

 private:
  MPI_Comm all_ = MPI_COMM_WORLD;
  int rank_ = 0;
  int size_ = 1;
};

}  // namespace fluxpact
