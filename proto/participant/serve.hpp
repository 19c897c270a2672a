// The loop that serves a participant to a coordinator: the same for every solver.
#pragma once

#include <string>

#include "proto/participant/participant.hpp"

namespace fluxpact {

struct ServeOptions {
  std::string endpoint;  ///< where the coordinator listens
  std::string name;      ///< how we appear in its messages
  double patience = 30;  ///< [s] for the coordinator to answer our hello
};

/// Take part in one session, from hello to bye. Returns when the coordinator says bye. Throws
/// ProtocolError if the coordinator is silent past the session's deadline or breaks the protocol;
/// an error of the solver is reported to the coordinator before it is thrown on.
void serve(Participant& participant, const ServeOptions& options);

}  // namespace fluxpact
