// A message between coordinator and participant: a small header, and one raw frame for each array.
// docs/protocol.md is the normative text.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>
#include <zmq.hpp>

#include "proto/participant/participant.hpp"

namespace fluxpact {

inline constexpr int protocol_version = 1;

enum class MessageType {
  hello,      ///< participant: who I am
  welcome,    ///< coordinator: you are in
  reject,     ///< coordinator: you are not, and why
  configure,  ///< coordinator: the scene
  mesh,       ///< coordinator: the mesh; answered by `result` with its fingerprint
  start,      ///< coordinator: initial fields of the others; answered by `result` with yours
  offer,      ///< coordinator: what do you offer the fluid for this window; answered by `result`
  advance,    ///< coordinator: one window; answered by `result`
  result,     ///< participant: the answer to mesh, start, offer, advance, snapshot
  commit,     ///< coordinator: the candidate is now the committed state
  rollback,   ///< coordinator: forget the candidate
  snapshot,   ///< coordinator: send what only you hold; answered by `result`
  heartbeat,  ///< either: I am alive
  error,      ///< either: I cannot go on, and why
  bye,        ///< coordinator: the session is over
};

std::string_view name_of(MessageType type);
std::string_view name_of(Role role);

/// A value in the body of a header.
using Value = std::variant<std::int64_t, double, std::string, std::vector<std::string>>;
using Body = std::map<std::string, Value>;

enum class Dtype { f64, i32 };
std::size_t size_of(Dtype dtype);

struct ArrayInfo {
  std::string name;
  Dtype dtype = Dtype::f64;
  std::vector<std::int64_t> shape;  ///< rows, or rows and columns
};

struct Header {
  MessageType type = MessageType::heartbeat;
  int version = protocol_version;
  std::string session;        ///< given by `welcome`; empty in `hello`
  std::int64_t sequence = 0;  ///< counts a sender's messages to one peer from 0
  std::int64_t step = 0;      ///< number of the window, 0 before the first
  std::int64_t attempt = 0;   ///< at this window, from 0
  Body body;
  std::vector<ArrayInfo> arrays;
};

/// Header and array frames. Frames are aligned for their type when they have come through a
/// channel.
struct Message {
  Header header;
  std::vector<zmq::message_t> frames;
};

/// Largest header that is read, in bytes: the scene travels in one.
inline constexpr std::size_t max_header_bytes = std::size_t{4} << 20;

/// Bytes of a header; `decode_header` is the inverse.
std::string encode_header(const Header& header);

/// Throws ProtocolError saying what is wrong: not MessagePack, trailing bytes, a missing or
/// mistyped key, an unknown type or dtype, a foreign major version, a bad shape. Allocates no more
/// than the bytes justify.
Header decode_header(std::span<const std::byte> bytes);

/// Throws ProtocolError unless the frames' sizes are those that the header declares.
void check_frames(const Message& message);

// ---- building
// -----------------------------------------------------------------------------------------

/// Append an array without copying: its memory must stay as it is until the peer has answered, and
/// must not be freed before the channel that sends it is closed, if no answer comes.
void add_array(Message& message, const FieldView& view);
void add_ints(Message& message, std::string name, std::span<const int> values);

/// Append all arrays and numbers of `fields`.
void add_fields(Message& message, const Fields& fields);

/// Append an array that came in another message; the frame is shared, nothing is copied.
void share_array(Message& to, Message& from, std::string_view name);

// ---- reading
// ------------------------------------------------------------------------------------------

/// Views of all f64 arrays and all numbers of the body; valid as long as the message.
Fields fields_of(const Message& message);

/// Throws ProtocolError if the array is missing or not i32.
std::span<const int> ints(const Message& message, std::string_view name);

/// Values of the body by type; throw ProtocolError naming message type and key.
std::int64_t integer(const Header& header, const std::string& key);
double number(const Header& header, const std::string& key);
const std::string& text(const Header& header, const std::string& key);
const std::vector<std::string>& texts(const Header& header, const std::string& key);

}  // namespace fluxpact
