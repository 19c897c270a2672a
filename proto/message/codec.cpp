// Header <-> MessagePack, with limits before allocation.
#include <algorithm>
#include <bit>
#include <limits>
#include <msgpack.hpp>

#include "proto/base/errors.hpp"
#include "proto/message/message.hpp"

namespace fluxpact {
namespace {

constexpr std::array<std::string_view, 15> type_names{
    "hello",  "welcome", "reject",   "configure", "mesh",      "start", "offer", "advance",
    "result", "commit",  "rollback", "snapshot",  "heartbeat", "error", "bye"};
constexpr std::size_t max_arrays = 256;
constexpr std::size_t max_body = 256;
constexpr std::size_t max_depth = 6;

using Packer = msgpack::packer<msgpack::sbuffer>;

void pack_text(Packer& packer, std::string_view text) {
  packer.pack_str(static_cast<std::uint32_t>(text.size()));
  packer.pack_str_body(text.data(), static_cast<std::uint32_t>(text.size()));
}

/// msgpack-cxx packs a double with a whole value as an integer; ours stay doubles, to the bit.
void pack_double(msgpack::sbuffer& buffer, double value) {
  std::array<char, 9> bytes{'\xcb'};
  const auto bits = std::bit_cast<std::uint64_t>(value);
  for (std::size_t i = 0; i < 8; ++i) bytes[i + 1] = static_cast<char>(bits >> (56 - 8 * i) & 0xff);
  buffer.write(bytes.data(), bytes.size());
}

void pack_value(msgpack::sbuffer& buffer, Packer& packer, const Value& value) {
  std::visit(
      [&](const auto& item) {
        using Item = std::decay_t<decltype(item)>;
        if constexpr (std::is_same_v<Item, std::string>) {
          pack_text(packer, item);
        } else if constexpr (std::is_same_v<Item, std::vector<std::string>>) {
          packer.pack_array(static_cast<std::uint32_t>(item.size()));
          for (const std::string& text : item) pack_text(packer, text);
        } else if constexpr (std::is_same_v<Item, double>) {
          pack_double(buffer, item);
        } else {
          packer.pack(item);
        }
      },
      value);
}

std::string text_of(const msgpack::object& object, std::string_view key) {
  if (object.type != msgpack::type::STR)
    throw ProtocolError("message header: '{}' is not a string", key);
  return {object.via.str.ptr, object.via.str.size};
}

std::int64_t integer_of(const msgpack::object& object, std::string_view key) {
  constexpr auto largest = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  if (object.type == msgpack::type::NEGATIVE_INTEGER) return object.via.i64;
  if (object.type != msgpack::type::POSITIVE_INTEGER || object.via.u64 > largest) {
    throw ProtocolError("message header: '{}' is not an integer below 2^63", key);
  }
  return static_cast<std::int64_t>(object.via.u64);
}

Value value_of(const msgpack::object& object, std::string_view key) {
  switch (object.type) {
    case msgpack::type::POSITIVE_INTEGER:
    case msgpack::type::NEGATIVE_INTEGER:
      return integer_of(object, key);
    case msgpack::type::FLOAT32:
    case msgpack::type::FLOAT64:
      return object.via.f64;
    case msgpack::type::STR:
      return text_of(object, key);
    case msgpack::type::ARRAY: {
      std::vector<std::string> texts;
      for (const msgpack::object& item : std::span(object.via.array.ptr, object.via.array.size))
        texts.push_back(text_of(item, key));
      return texts;
    }
    default:
      throw ProtocolError(
          "message header: body '{}' is neither a number, a string nor a list of strings", key);
  }
}

template <class Visit>
void for_each_pair(const msgpack::object& map, std::string_view what, const Visit& visit) {
  if (map.type != msgpack::type::MAP) throw ProtocolError("message header: {} is not a map", what);
  for (const msgpack::object_kv& pair : std::span(map.via.map.ptr, map.via.map.size))
    visit(text_of(pair.key, what), pair.val);
}

ArrayInfo array_of(const msgpack::object& object) {
  ArrayInfo info;
  std::string dtype;
  for_each_pair(object, "an array's description",
                [&](const std::string& key, const msgpack::object& value) {
                  if (key == "name") info.name = text_of(value, key);
                  if (key == "dtype") dtype = text_of(value, key);
                  if (key == "shape") {
                    if (value.type != msgpack::type::ARRAY)
                      throw ProtocolError("message header: a shape is not a list");
                    for (const msgpack::object& extent :
                         std::span(value.via.array.ptr, value.via.array.size)) {
                      info.shape.push_back(integer_of(extent, key));
                    }
                  }
                });
  if (dtype != "f64" && dtype != "i32")
    throw ProtocolError("array '{}': dtype '{}' is neither f64 nor i32", info.name, dtype);
  info.dtype = dtype == "f64" ? Dtype::f64 : Dtype::i32;
  constexpr std::int64_t largest_extent = std::int64_t{1} << 40;
  const auto bad = [](std::int64_t extent) { return extent < 0 || extent > largest_extent; };
  if (info.name.empty() || info.shape.empty() || info.shape.size() > 2 ||
      std::ranges::any_of(info.shape, bad) || (info.shape.size() == 2 && info.shape[1] > 9)) {
    throw ProtocolError(
        "array '{}': a shape is one or two extents from 0 to 2^40, at most 9 columns", info.name);
  }
  return info;
}

MessageType type_of(const std::string& text) {
  const auto found = std::ranges::find(type_names, text);
  if (found == type_names.end()) throw ProtocolError("message header: unknown type '{}'", text);
  return static_cast<MessageType>(found - type_names.begin());
}

}  // namespace

std::string_view name_of(MessageType type) { return type_names.at(static_cast<std::size_t>(type)); }
std::string_view name_of(Role role) { return role == Role::fluid ? "fluid" : "particles"; }
std::size_t size_of(Dtype dtype) { return dtype == Dtype::f64 ? 8 : 4; }

std::string encode_header(const Header& header) {
  msgpack::sbuffer buffer;
  Packer packer(buffer);
  packer.pack_map(8);
  pack_text(packer, "version");
  packer.pack(header.version);
  pack_text(packer, "type");
  pack_text(packer, name_of(header.type));
  pack_text(packer, "session");
  pack_text(packer, header.session);
  pack_text(packer, "sequence");
  packer.pack(header.sequence);
  pack_text(packer, "step");
  packer.pack(header.step);
  pack_text(packer, "attempt");
  packer.pack(header.attempt);
  pack_text(packer, "body");
  packer.pack_map(static_cast<std::uint32_t>(header.body.size()));
  for (const auto& [key, value] : header.body) {
    pack_text(packer, key);
    pack_value(buffer, packer, value);
  }
  pack_text(packer, "arrays");
  packer.pack_array(static_cast<std::uint32_t>(header.arrays.size()));
  for (const ArrayInfo& info : header.arrays) {
    packer.pack_map(3);
    pack_text(packer, "name");
    pack_text(packer, info.name);
    pack_text(packer, "dtype");
    pack_text(packer, info.dtype == Dtype::f64 ? "f64" : "i32");
    pack_text(packer, "shape");
    packer.pack(info.shape);
  }
  return {buffer.data(), buffer.size()};
}

Header decode_header(std::span<const std::byte> bytes) {
  if (bytes.size() > max_header_bytes) {
    throw ProtocolError("message header: {} bytes, at most {} are read", bytes.size(),
                        max_header_bytes);
  }
  const msgpack::unpack_limit limit(std::max(max_arrays, max_body), std::max(max_arrays, max_body),
                                    max_header_bytes, 0, 0, max_depth);
  const auto by_reference = [](msgpack::type::object_type, std::size_t, void*) { return true; };
  msgpack::object_handle handle;
  std::size_t used = 0;
  try {
    handle = msgpack::unpack(reinterpret_cast<const char*>(bytes.data()), bytes.size(), used,
                             by_reference, nullptr, limit);
  } catch (const std::exception& error) {
    throw ProtocolError("message header: not MessagePack within limits ({})", error.what());
  }
  if (used != bytes.size())
    throw ProtocolError("message header: {} bytes after its end", bytes.size() - used);

  Header header;
  header.version = -1;
  bool has_type = false;
  for_each_pair(
      handle.get(), "the header", [&](const std::string& key, const msgpack::object& value) {
        if (key == "version")
          header.version =
              static_cast<int>(std::clamp<std::int64_t>(integer_of(value, key), -1, 1 << 20));
        if (key == "session") header.session = text_of(value, key);
        if (key == "sequence") header.sequence = integer_of(value, key);
        if (key == "step") header.step = integer_of(value, key);
        if (key == "attempt") header.attempt = integer_of(value, key);
        if (key == "type") {
          header.type = type_of(text_of(value, key));
          has_type = true;
        }
        if (key == "body") {
          for_each_pair(value, "the body",
                        [&](const std::string& name, const msgpack::object& item) {
                          header.body[name] = value_of(item, name);
                        });
        }
        if (key == "arrays") {
          if (value.type != msgpack::type::ARRAY)
            throw ProtocolError("message header: 'arrays' is not a list");
          for (const msgpack::object& item : std::span(value.via.array.ptr, value.via.array.size))
            header.arrays.push_back(array_of(item));
        }
      });
  if (header.version < 0) throw ProtocolError("message header: no version");
  if (!has_type) throw ProtocolError("message header: no type");
  return header;
}

}  // namespace fluxpact
