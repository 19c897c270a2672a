// From where an endpoint can be reached.
#pragma once

#include <string_view>

namespace fluxpact {

enum class Reach {
  unknown,       ///< not an endpoint that the coordinator can listen on
  this_machine,  ///< ipc, or the loopback device
  network,
};

/// For `tcp://HOST:PORT` (PORT may be `*`: any free one) and `ipc://PATH`. Only 127.x.y.z,
/// localhost and [::1] are loopback: what a name resolves to may change after this check.
Reach reach_of(std::string_view endpoint);

}  // namespace fluxpact
