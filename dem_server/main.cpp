// The particle server: the engines that it has, and where the others are.
#include "dem_server/backends/kinematic/kinematic_engine.hpp"
#include "dem_server/backends/native/native_engine.hpp"
#include "dem_server/participant/particle_server.hpp"

int main(int argc, char** argv) {
  using fluxpact::ParticleBackend;
  return fluxpact::particle_server_main(
      argc, argv, "dem_server",
      {{ParticleBackend::native, {}, fluxpact::make_native_engine},
       {ParticleBackend::kinematic, fluxpact::check_kinematic_mesh,
        fluxpact::make_kinematic_engine}},
      {{"lammps", "dem_server_lammps"}, {"liggghts", "dem_server_liggghts"}});
}
