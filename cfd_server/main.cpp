// The fluid server: command line only.
#include "cfd_server/backends/native/fluid_participant.hpp"
#include "proto/participant/server_main.hpp"

int main(int argc, char** argv) {
  return fluxpact::server_main(
      argc, argv,
      {.name = "cfd_server",
       .description = "fluxpact fluid server: takes part in a session as the fluid side",
       .backends = {"native"},
       .make = [](const std::string&) { return std::make_unique<fluxpact::NativeFluid>(); }});
}
