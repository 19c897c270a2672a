// The particle server with LAMMPS: a program of its own, since LAMMPS and LIGGGHTS define the same
// symbols. `dem_server --backend lammps` becomes it.
#include "dem_server/backends/domain.hpp"
#include "dem_server/backends/granular/rank_server.hpp"
#include "dem_server/backends/granular/ranks.hpp"
#include "dem_server/backends/lammps/lammps_engine.hpp"

int main(int argc, char** argv) {
  using namespace fluxpact;
  const MpiSession mpi(&argc, &argv);
  return rank_server_main(argc, argv,
                          {ParticleBackend::lammps, check_box_mesh, make_lammps_engine});
}
