#include "dem_server/backends/granular/ranks.hpp"

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

namespace fluxpact {
namespace {

constexpr int error_tag = 1;

}  // namespace

MpiSession::MpiSession(int* argc, char*** argv) {
  // A process that no mpirun started would start a daemon of Open MPI, which outlives it and keeps
  // the files open that it had; one of its own kind alone has no need of it.
  if (std::getenv("OMPI_COMM_WORLD_SIZE") == nullptr) {
    setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
  }
  setenv("OMPI_MCA_mpi_yield_when_idle", "1", 0);  // the fluid's server is on the same machine
  MPI_Init(argc, argv);
}
MpiSession::~MpiSession() { MPI_Finalize(); }

Ranks::Ranks() {
  MPI_Comm_rank(all_, &rank_);
  MPI_Comm_size(all_, &size_);
}

/// The error that another rank reports ends the wait: that rank will never come.
void Ranks::wait(MPI_Request request) const {
  for (int done = 0; done == 0;) {
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    if (done == 0 && rank_ == 0) throw_reported();
    if (done == 0) sched_yield();  // who is waited for may need this processor
  }
}

void Ranks::throw_reported() const {
  int there = 0;
  MPI_Status status;
  MPI_Iprobe(MPI_ANY_SOURCE, error_tag, all_, &there, &status);
  if (there == 0) return;
  int size = 0;
  MPI_Get_count(&status, MPI_CHAR, &size);
  std::string text(static_cast<std::size_t>(size), ' ');
  MPI_Recv(text.data(), size, MPI_CHAR, status.MPI_SOURCE, error_tag, all_, MPI_STATUS_IGNORE);
  throw Error(static_cast<ExitCode>(text.front()), text.substr(1));
}

void Ranks::report(const std::string& text, ExitCode code) const {
  const std::string message = static_cast<char>(code) + text;
  MPI_Send(message.data(), static_cast<int>(message.size()), MPI_CHAR, 0, error_tag, all_);
  for (;;) sleep(1);
}

void Ranks::meet() const {
  if (size_ == 1) return;
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Ibarrier(all_, &request);
  wait(request);
}

void Ranks::broadcast(std::span<std::byte> bytes) const {
  constexpr std::size_t most = std::size_t{1} << 30;  // MPI counts in int
  for (std::size_t first = 0; first < bytes.size(); first += most) {
    const std::size_t count = std::min(most, bytes.size() - first);
    MPI_Bcast(bytes.data() + first, static_cast<int>(count), MPI_BYTE, 0, all_);
  }
}

void Ranks::gather(std::span<const double> part, std::vector<double>& all) const {
  if (size_ == 1) {
    all.assign(part.begin(), part.end());
    return;
  }
  const auto ranks = static_cast<std::size_t>(size_);
  std::vector<int> counts(ranks);
  std::vector<int> starts(ranks);
  const int own = static_cast<int>(part.size());
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Iallgather(&own, 1, MPI_INT, counts.data(), 1, MPI_INT, all_, &request);
  wait(request);
  int total = 0;
  for (std::size_t rank = 0; rank < ranks; ++rank) {
    starts[rank] = total;
    total += counts[rank];
  }
  all.resize(static_cast<std::size_t>(total));
  MPI_Iallgatherv(part.data(), own, MPI_DOUBLE, all.data(), counts.data(), starts.data(),
                  MPI_DOUBLE, all_, &request);
  wait(request);
}

void Ranks::add_up(std::span<double> values) const {
  if (size_ == 1) return;
  // One rank adds, and all get its bits.
  const int count = static_cast<int>(values.size());
  MPI_Request request = MPI_REQUEST_NULL;
  if (rank_ == 0) {
    MPI_Ireduce(MPI_IN_PLACE, values.data(), count, MPI_DOUBLE, MPI_SUM, 0, all_, &request);
  } else {
    MPI_Ireduce(values.data(), nullptr, count, MPI_DOUBLE, MPI_SUM, 0, all_, &request);
  }
  wait(request);
  MPI_Ibcast(values.data(), count, MPI_DOUBLE, 0, all_, &request);
  wait(request);
}

}  // namespace fluxpact
