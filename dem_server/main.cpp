// The particle server: the engines that it has, and where the others are.
#include "dem_server/backends/domain.hpp"
#include "dem_server/backends/hard_sphere/hard_sphere_engine.hpp"
#include "dem_server/backends/kinematic/kinematic_engine.hpp"
#include "dem_server/backends/native/native_engine.hpp"
#include "dem_server/participant/particle_server.hpp"
#ifdef FLUXPACT_WITH_YADE
#include "dem_server/backends/yade/yade_engine.hpp"
#endif

int main(int argc, char** argv) {
  using fluxpact::ParticleBackend;
  std::vector<fluxpact::EngineMaker> engines{
      {ParticleBackend::native, {}, fluxpact::make_native_engine},
      {ParticleBackend::hard_sphere, fluxpact::check_box_mesh, fluxpact::make_hard_sphere_engine},
      {ParticleBackend::kinematic, fluxpact::check_box_mesh, fluxpact::make_kinematic_engine}};
#ifdef FLUXPACT_WITH_YADE
  engines.push_back({ParticleBackend::yade, fluxpact::check_box_mesh, fluxpact::make_yade_engine});
#endif
  return fluxpact::particle_server_main(
      argc, argv, "dem_server", std::move(engines),
      {{"lammps", "dem_server_lammps"}, {"liggghts", "dem_server_liggghts"}});
}
