// The sockets: one ROUTER at the coordinator, one DEALER at each participant. Each is used by one
// thread only.
//
// The defaults of libzmq that would hang, drop silently or exhaust memory are changed here: LINGER
// 0, MANDATORY on the ROUTER, small high-water marks, a size limit on every frame, a short
// handshake time.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "proto/message/message.hpp"

namespace fluxpact {

using Milliseconds = std::chrono::milliseconds;

/// The participant's end.
class ParticipantChannel {
 public:
  /// Throws SystemError if the endpoint is malformed. Connecting itself happens in the background.
  explicit ParticipantChannel(const std::string& endpoint);

  /// Send; fills in the sequence number. Throws ProtocolError if the peer takes nothing within
  /// `patience`.
  void send(Message& message, Milliseconds patience);

  /// Let what was sent last leave when this channel is closed, for at most `patience`. Otherwise it
  /// is dropped.
  void linger(Milliseconds patience);

  /// The next message, checked; nothing after `patience`. Throws ProtocolError on a malformed one.
  std::optional<Message> receive(Milliseconds patience);

 private:
  zmq::context_t context_;
  zmq::socket_t socket_;
  std::int64_t sent_ = 0;
  std::int64_t received_ = 0;
};

/// A message that came to the coordinator: from whom, and either the message or what is wrong with
/// it.
struct Arrival {
  std::string peer;  ///< routing id, chosen by libzmq
  std::optional<Message> message;
  std::string defect;
};

/// The coordinator's end.
class CoordinatorChannel {
 public:
  /// Binds. `frame_limit` [bytes] is the largest frame that is accepted from a peer.
  /// Throws SystemError naming the endpoint and the system's reason.
  CoordinatorChannel(const std::string& endpoint, std::int64_t frame_limit);

  /// The endpoint with wildcards resolved, for others to connect to.
  std::string endpoint() const;

  /// Throws ProtocolError if the peer is gone or takes nothing.
  void send(const std::string& peer, Message& message);

  struct Wakeup {
    std::optional<Arrival> arrival;
    std::vector<int> ready;  ///< those of `watched` that are readable
  };
  /// The next message or event on one of the watched descriptors, or neither after `patience`.
  Wakeup wait(const std::vector<int>& watched, Milliseconds patience);

 private:
  zmq::context_t context_;
  zmq::socket_t socket_;
};

}  // namespace fluxpact
