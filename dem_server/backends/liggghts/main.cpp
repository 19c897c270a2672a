// The particle server with LIGGGHTS: a program of its own, since it and LAMMPS define the same
// symbols. `dem_server --backend liggghts` becomes it.
#include "dem_server/backends/domain.hpp"
#include "dem_server/backends/granular/rank_server.hpp"
#include "dem_server/backends/granular/ranks.hpp"
#include "dem_server/backends/liggghts/liggghts_engine.hpp"

int main(int argc, char** argv) {
  using namespace fluxpact;
  const MpiSession mpi(&argc, &argv);
  return rank_server_main(argc, argv,
                          {ParticleBackend::liggghts, check_box_mesh, make_liggghts_engine});
}
