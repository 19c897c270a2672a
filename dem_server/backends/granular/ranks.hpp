// The ranks of MPI that share one particle side. Each presents a constant share of the particles,
// a run of rows, whatever rank the library has them on. Rank 0 speaks to the coordinator: it gets
// to know of an error on any other rank wherever it waits for them.
#pragma once

#include <mpi.h>

#include <span>
#include <string>
#include <vector>

#include "proto/base/errors.hpp"

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

  // Every rank must call these alike. On rank 0 they throw the error that another rank has
  // reported, whose type is Error with its exit code.

  /// The parts of all ranks, one after the other, on each rank.
  void gather(std::span<const double> part, std::vector<double>& all) const;
  /// The sums over all ranks, on each rank, in place: the same bits everywhere.
  void add_up(std::span<double> values) const;
  /// Until all ranks have come here.
  void meet() const;

  /// From rank 0 to all, which give room of the same size.
  void broadcast(std::span<std::byte> bytes) const;

  /// Tell rank 0 of an error, and wait for the end, which it brings.
  [[noreturn]] void report(const std::string& text, ExitCode code) const;

 private:
  void wait(MPI_Request request) const;
  void throw_reported() const;

  MPI_Comm all_ = MPI_COMM_WORLD;
  int rank_ = 0;
  int size_ = 1;
};

}  // namespace fluxpact
