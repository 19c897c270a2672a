#include "proto/session/state_machine.hpp"

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

struct Transition {
  SessionState from;
  MessageType said;
  SessionState to;
};

using enum SessionState;
constexpr std::array<Transition, 12> transitions{{
    {greeting, MessageType::welcome, welcomed},
    {greeting, MessageType::reject, closed},
    {welcomed, MessageType::configure, configured},
    {configured, MessageType::mesh, meshed},
    {meshed, MessageType::start, committed},
    {committed, MessageType::advance, candidate},
    {committed, MessageType::snapshot, committed},
    {committed, MessageType::offer, offered},
    {offered, MessageType::advance, candidate},
    {offered, MessageType::rollback, committed},
    {candidate, MessageType::commit, committed},
    {candidate, MessageType::rollback, committed},
}};

}  // namespace

std::string_view name_of(SessionState state) {
  constexpr std::array<std::string_view, 8> names{"greeting",  "welcomed", "configured", "meshed",
                                                  "committed", "offered",  "candidate",  "closed"};
  return names.at(static_cast<std::size_t>(state));
}

std::optional<SessionState> next_state(SessionState state, MessageType said) {
  if (state != closed) {
    if (said == MessageType::heartbeat) return state;
    if (said == MessageType::bye || said == MessageType::error) return closed;
  }
  for (const Transition& transition : transitions) {
    if (transition.from == state && transition.said == said) return transition.to;
  }
  return std::nullopt;
}

bool is_answered(MessageType said) {
  return said == MessageType::mesh || said == MessageType::start || said == MessageType::offer ||
         said == MessageType::advance || said == MessageType::snapshot;
}

SessionState require_next(SessionState state, MessageType said, std::string_view peer) {
  const auto next = next_state(state, said);
  if (!next)
    throw ProtocolError("{}: message '{}' may not be said in state '{}'", peer, name_of(said),
                        name_of(state));
  return *next;
}

}  // namespace fluxpact
