// A particle server of one engine on one or several ranks of MPI: rank 0 takes part in the session
// and passes on what it is asked; all ranks do it, each with its share of the particles.
#pragma once

#include "dem_server/participant/particle_server.hpp"

namespace fluxpact {

/// The whole of a server program, which has an MpiSession. Returns the exit code. An error on any
/// rank is told to the coordinator, and ends all ranks.
int rank_server_main(int argc, char** argv, const EngineMaker& engine);

}  // namespace fluxpact
