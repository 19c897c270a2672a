#include "dem_server/backends/granular/ranks.hpp"

#include <cstdlib>

namespace fluxpact {

MpiSession::MpiSession(int* argc, char*** argv) {
  // A process that no mpirun started would start a daemon of Open MPI, which outlives it and keeps
  // the files open that it had; one of its own kind alone has no need of it.
  if (std::getenv("OMPI_COMM_WORLD_SIZE") == nullptr) {
    setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
  }
  MPI_Init(argc, argv);
}
MpiSession::~MpiSession() { MPI_Finalize(); }

Ranks::Ranks() {
  MPI_Comm_rank(all_, &rank_);
  MPI_Comm_size(all_, &size_);
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
  MPI_Allgather(&own, 1, MPI_INT, counts.data(), 1, MPI_INT, all_);
  int total = 0;
  for (std::size_t rank = 0; rank < ranks; ++rank) {
    starts[rank] = total;
    total += counts[rank];
  }
  all.resize(static_cast<std::size_t>(total));
  MPI_Allgatherv(part.data(), own, MPI_DOUBLE, all.data(), counts.data(), starts.data(), MPI_DOUBLE,
                 all_);
}

void Ranks::add_up(std::span<double> values) const {
  if (size_ == 1) return;
  // One rank adds, in the order of the algorithm for this size, and all get its bits.
  const int count = static_cast<int>(values.size());
  if (rank_ == 0) {
    MPI_Reduce(MPI_IN_PLACE, values.data(), count, MPI_DOUBLE, MPI_SUM, 0, all_);
  } else {
    MPI_Reduce(values.data(), nullptr, count, MPI_DOUBLE, MPI_SUM, 0, all_);
  }
  MPI_Bcast(values.data(), count, MPI_DOUBLE, 0, all_);
}

}  // namespace fluxpact
