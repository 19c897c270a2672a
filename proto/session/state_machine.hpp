// The life of a session in one table, used by both sides: what may be said when, and what it leads
// to.
#pragma once

#include <optional>

#include "proto/message/message.hpp"

namespace fluxpact {

/// State of a participant as both sides know it.
enum class SessionState {
  greeting,    ///< hello sent, not yet answered
  welcomed,    ///< knows session and deadlines
  configured,  ///< knows the scene
  meshed,      ///< knows the mesh
  committed,   ///< holds one state, that of the last committed window
  offered,     ///< beside it, has made the offer for a window that it is yet to advance
  candidate,   ///< holds a second state, not yet committed
  closed,
};

std::string_view name_of(SessionState state);

/// Where a message of the coordinator leads from `state`, or nothing if it may not be said there.
std::optional<SessionState> next_state(SessionState state, MessageType said);

/// True if the coordinator waits for a `result` after saying this.
bool is_answered(MessageType said);

/// `next_state`, or ProtocolError naming peer, state and message.
SessionState require_next(SessionState state, MessageType said, std::string_view peer);

}  // namespace fluxpact
