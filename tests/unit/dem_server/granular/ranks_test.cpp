// Two ranks, started by mpirun: their shares and sums, and an error on one that the other waits
// for. No GoogleTest: its output would be that of two programs at once.
#include "dem_server/backends/granular/ranks.hpp"

#include <fmt/core.h>

#include <cstdlib>

namespace fluxpact {
namespace {

void expect(bool fits, const char* what) {
  if (fits) return;
  fmt::print(stderr, "FAILED: {}\n", what);
  MPI_Abort(MPI_COMM_WORLD, 1);
}

void check_sums(const Ranks& ranks) {
  expect(ranks.size() == 2, "two ranks");
  expect(ranks.first_row(0, 7) == 0 && ranks.first_row(1, 7) == 3 && ranks.first_row(2, 7) == 7,
         "shares of 7 rows");
  // Parts of different length, one after the other, on both.
  const std::vector<double> part(ranks.rank() == 0 ? 2 : 3, ranks.rank() + 1.0);
  std::vector<double> all;
  ranks.gather(part, all);
  expect(all == std::vector<double>{1, 1, 2, 2, 2}, "gather");
  std::vector<double> values{1.0 + ranks.rank(), 0.1};
  ranks.add_up(values);
  expect(values == std::vector<double>{3, 0.2}, "sums");
}

/// Rank 1 fails before it comes to where rank 0 waits.
void check_report(const Ranks& ranks) {
  if (ranks.rank() == 1) ranks.report("particle 7 is lost", ExitCode::numerics);
  std::vector<double> values{1};
  try {
    ranks.add_up(values);
    expect(false, "an error of another rank is thrown");
  } catch (const Error& error) {
    expect(error.exit_code() == ExitCode::numerics, "its exit code");
    expect(std::string(error.what()) == "particle 7 is lost", "its text");
  }
}

}  // namespace
}  // namespace fluxpact

int main(int argc, char** argv) {
  const fluxpact::MpiSession mpi(&argc, &argv);
  const fluxpact::Ranks ranks;
  fluxpact::check_sums(ranks);
  fluxpact::check_report(ranks);
  fmt::print("all fits\n");
  std::fflush(stdout);
  MPI_Abort(MPI_COMM_WORLD, 42);  // rank 1 waits for ever
}
