// The mesh on the wire.
#pragma once

#include "proto/mesh/mesh.hpp"
#include "proto/message/message.hpp"

namespace fluxpact {

/// A `mesh` message on the memory of `mesh`.
Message mesh_message(const Mesh& mesh);

/// The inverse; throws ProtocolError (frames) or ConfigError (topology).
Mesh mesh_of(const Message& message);

/// The fingerprint as 16 hexadecimal digits.
std::string fingerprint_text(const MeshTopology& mesh);

}  // namespace fluxpact
