#include "proto/session/channel.hpp"

#include <algorithm>
#include <cstring>
#include <memory>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

constexpr int high_water_mark = 16;
constexpr std::size_t max_frames = 300;

void set_common_options(zmq::socket_t& socket) {
  socket.set(zmq::sockopt::linger, 0);
  socket.set(zmq::sockopt::sndhwm, high_water_mark);
  socket.set(zmq::sockopt::rcvhwm, high_water_mark);
  socket.set(zmq::sockopt::handshake_ivl, 3000);
}

/// libzmq hands out small frames at any address; arrays of doubles need their alignment.
zmq::message_t aligned(zmq::message_t frame) {
  if (reinterpret_cast<std::uintptr_t>(frame.data()) % alignof(double) == 0) return frame;
  const std::size_t doubles = frame.size() / sizeof(double) + 1;
  auto copy = std::make_unique<double[]>(doubles);
  std::memcpy(copy.get(), frame.data(), frame.size());
  const std::size_t bytes = frame.size();
  return {copy.release(), bytes, [](void* data, void*) { delete[] static_cast<double*>(data); },
          nullptr};
}

void send_frames(zmq::socket_t& socket, Message& message) {
  const std::string header = encode_header(message.header);
  const bool last = message.frames.empty();
  zmq::message_t first(header.data(), header.size());
  if (!socket.send(first, last ? zmq::send_flags::none : zmq::send_flags::sndmore))
    throw zmq::error_t();
  for (std::size_t i = 0; i < message.frames.size(); ++i) {
    zmq::message_t frame;
    frame.copy(message.frames[i]);  // shares large frames; the message can be sent again
    const bool more = i + 1 < message.frames.size();
    if (!socket.send(frame, more ? zmq::send_flags::sndmore : zmq::send_flags::none))
      throw zmq::error_t();
  }
}

std::vector<zmq::message_t> receive_frames(zmq::socket_t& socket) {
  std::vector<zmq::message_t> frames;
  bool more = true;
  while (more) {
    zmq::message_t frame;
    if (!socket.recv(frame, zmq::recv_flags::none)) break;
    more = frame.more();
    if (frames.size() <= max_frames) frames.push_back(aligned(std::move(frame)));
  }
  return frames;
}

/// Frames from `first` on as a checked message; throws ProtocolError.
Message message_of(std::vector<zmq::message_t> frames, std::size_t first) {
  if (frames.size() <= first) throw ProtocolError("message without a header");
  if (frames.size() > max_frames)
    throw ProtocolError("message with more than {} frames", max_frames);
  Message message;
  message.header =
      decode_header({static_cast<const std::byte*>(frames[first].data()), frames[first].size()});
  frames.erase(frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(first) + 1);
  message.frames = std::move(frames);
  check_frames(message);
  return message;
}

/// Poll, going on after a signal until the time is over.
bool poll(std::vector<zmq::pollitem_t>& items, Milliseconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (true) {
    const auto left =
        std::chrono::duration_cast<Milliseconds>(deadline - std::chrono::steady_clock::now());
    try {
      return zmq::poll(items, std::max(left, Milliseconds(0))) > 0;
    } catch (const zmq::error_t& error) {
      if (error.num() != EINTR) throw SystemError("waiting on sockets: {}", error.what());
    }
  }
}

}  // namespace

ParticipantChannel::ParticipantChannel(const std::string& endpoint)
    : context_(1), socket_(context_, zmq::socket_type::dealer) {
  set_common_options(socket_);
  try {
    socket_.connect(endpoint);
  } catch (const zmq::error_t& error) {
    throw SystemError("cannot connect to '{}': {}; expected ipc://PATH or tcp://HOST:PORT",
                      endpoint, error.what());
  }
}

void ParticipantChannel::send(Message& message, Milliseconds patience) {
  message.header.sequence = sent_++;
  socket_.set(zmq::sockopt::sndtimeo, static_cast<int>(patience.count()));
  try {
    send_frames(socket_, message);
  } catch (const zmq::error_t& error) {
    throw ProtocolError("coordinator: takes no '{}' message within {} ms ({})",
                        name_of(message.header.type), patience.count(), error.what());
  }
}

void ParticipantChannel::linger(Milliseconds patience) {
  socket_.set(zmq::sockopt::linger, static_cast<int>(patience.count()));
}

std::optional<Message> ParticipantChannel::receive(Milliseconds patience) {
  std::vector<zmq::pollitem_t> items{{socket_.handle(), 0, ZMQ_POLLIN, 0}};
  if (!poll(items, patience)) return std::nullopt;
  Message message = message_of(receive_frames(socket_), 0);
  if (message.header.sequence != received_) {
    throw ProtocolError(
        "coordinator: message '{}' has sequence {}, expected {}: messages were lost",
        name_of(message.header.type), message.header.sequence, received_);
  }
  ++received_;
  return message;
}

CoordinatorChannel::CoordinatorChannel(const std::string& endpoint, std::int64_t frame_limit)
    : context_(1), socket_(context_, zmq::socket_type::router) {
  set_common_options(socket_);
  socket_.set(zmq::sockopt::router_mandatory, 1);
  socket_.set(zmq::sockopt::maxmsgsize, frame_limit);
  socket_.set(zmq::sockopt::sndtimeo, 2000);
  try {
    socket_.bind(endpoint);
  } catch (const zmq::error_t& error) {
    throw SystemError("cannot listen on '{}': {}; choose a free address in launch.listen", endpoint,
                      error.what());
  }
}

std::string CoordinatorChannel::endpoint() const {
  return socket_.get(zmq::sockopt::last_endpoint);
}

void CoordinatorChannel::send(const std::string& peer, Message& message) {
  try {
    zmq::message_t address(peer.data(), peer.size());
    if (!socket_.send(address, zmq::send_flags::sndmore)) throw zmq::error_t();
    send_frames(socket_, message);
  } catch (const zmq::error_t& error) {
    throw ProtocolError("cannot send '{}': {}", name_of(message.header.type), error.what());
  }
}

CoordinatorChannel::Wakeup CoordinatorChannel::wait(const std::vector<int>& watched,
                                                    Milliseconds patience) {
  std::vector<zmq::pollitem_t> items{{socket_.handle(), 0, ZMQ_POLLIN, 0}};
  for (const int descriptor : watched) items.push_back({nullptr, descriptor, ZMQ_POLLIN, 0});
  Wakeup wakeup;
  if (!poll(items, patience)) return wakeup;
  for (std::size_t i = 0; i < watched.size(); ++i) {
    if (items[i + 1].revents != 0) wakeup.ready.push_back(watched[i]);
  }
  if (items[0].revents == 0) return wakeup;
  auto frames = receive_frames(socket_);
  Arrival& arrival = wakeup.arrival.emplace();
  if (!frames.empty()) arrival.peer = frames.front().to_string();
  try {
    arrival.message = message_of(std::move(frames), 1);
  } catch (const ProtocolError& error) {
    arrival.defect = error.what();
  }
  return wakeup;
}

}  // namespace fluxpact
