// The particle server: command line only.
#include "dem_server/participant/particle_participant.hpp"
#include "proto/participant/server_main.hpp"

int main(int argc, char** argv) {
  return fluxpact::server_main(
      argc, argv,
      {.name = "dem_server",
       .description = "fluxpact particle server: takes part in a session as the particle side",
       .backends = {"native", "kinematic"},
       .make = fluxpact::make_particle_participant});
}
