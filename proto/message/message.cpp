#include "proto/message/message.hpp"

#include <algorithm>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

template <class T>
const T& value_as(const Header& header, const std::string& key, std::string_view kind) {
  const auto found = header.body.find(key);
  if (found == header.body.end())
    throw ProtocolError("message '{}': '{}' is missing from its body", name_of(header.type), key);
  const T* value = std::get_if<T>(&found->second);
  if (value == nullptr)
    throw ProtocolError("message '{}': '{}' is not {}", name_of(header.type), key, kind);
  return *value;
}

std::size_t index_of(const Message& message, std::string_view name) {
  const auto found = std::ranges::find(message.header.arrays, name, &ArrayInfo::name);
  if (found == message.header.arrays.end()) {
    throw ProtocolError("message '{}': array '{}' is missing", name_of(message.header.type), name);
  }
  return static_cast<std::size_t>(found - message.header.arrays.begin());
}

/// A frame on memory that its owner keeps: nothing to free.
zmq::message_t borrowed(const void* data, std::size_t bytes) {
  return {const_cast<void*>(data), bytes, [](void*, void*) {}, nullptr};
}

std::size_t declared_bytes(const ArrayInfo& info) {
  std::size_t bytes = size_of(info.dtype);
  for (const std::int64_t extent : info.shape) bytes *= static_cast<std::size_t>(extent);
  return bytes;
}

}  // namespace

void check_frames(const Message& message) {
  const auto& arrays = message.header.arrays;
  if (arrays.size() != message.frames.size()) {
    throw ProtocolError("message '{}': {} arrays declared, {} frames came",
                        name_of(message.header.type), arrays.size(), message.frames.size());
  }
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    if (message.frames[i].size() != declared_bytes(arrays[i])) {
      throw ProtocolError("message '{}': array '{}' has {} bytes, its shape says {}",
                          name_of(message.header.type), arrays[i].name, message.frames[i].size(),
                          declared_bytes(arrays[i]));
    }
  }
}

void add_array(Message& message, const FieldView& view) {
  const auto rows = static_cast<std::int64_t>(view.values.size()) / view.components;
  ArrayInfo info{view.name, Dtype::f64, {rows}};
  if (view.components > 1) info.shape.push_back(view.components);
  message.header.arrays.push_back(std::move(info));
  message.frames.push_back(borrowed(view.values.data(), view.values.size_bytes()));
}

void add_ints(Message& message, std::string name, std::span<const int> values) {
  message.header.arrays.push_back(
      {std::move(name), Dtype::i32, {static_cast<std::int64_t>(values.size())}});
  message.frames.push_back(borrowed(values.data(), values.size_bytes()));
}

void add_fields(Message& message, const Fields& fields) {
  for (const FieldView& view : fields.views()) add_array(message, view);
  for (const auto& [name, value] : fields.numbers()) message.header.body[name] = value;
}

void share_array(Message& to, Message& from, std::string_view name) {
  const std::size_t index = index_of(from, name);
  to.header.arrays.push_back(from.header.arrays[index]);
  to.frames.emplace_back();
  to.frames.back().copy(from.frames[index]);
}

Fields fields_of(const Message& message) {
  Fields fields;
  for (std::size_t i = 0; i < message.frames.size(); ++i) {
    const ArrayInfo& info = message.header.arrays[i];
    if (info.dtype != Dtype::f64) continue;
    const std::span values(static_cast<const double*>(message.frames[i].data()),
                           message.frames[i].size() / sizeof(double));
    if (info.shape.size() == 2 && info.shape[1] == 3) {
      fields.add(info.name, as_vectors(values));
    } else {
      fields.add(info.name, values);
    }
  }
  for (const auto& [name, value] : message.header.body) {
    if (const double* real = std::get_if<double>(&value)) fields.add_number(name, *real);
    if (const std::int64_t* whole = std::get_if<std::int64_t>(&value))
      fields.add_number(name, static_cast<double>(*whole));
  }
  return fields;
}

std::span<const int> ints(const Message& message, std::string_view name) {
  const std::size_t index = index_of(message, name);
  if (message.header.arrays[index].dtype != Dtype::i32) {
    throw ProtocolError("message '{}': array '{}' is not i32", name_of(message.header.type), name);
  }
  return {static_cast<const int*>(message.frames[index].data()),
          message.frames[index].size() / sizeof(int)};
}

std::int64_t integer(const Header& header, const std::string& key) {
  return value_as<std::int64_t>(header, key, "an integer");
}
double number(const Header& header, const std::string& key) {
  const auto found = header.body.find(key);
  if (found != header.body.end() && std::holds_alternative<std::int64_t>(found->second)) {
    return static_cast<double>(
        std::get<std::int64_t>(found->second));  // languages without a type of its own for reals
  }
  return value_as<double>(header, key, "a number");
}
const std::string& text(const Header& header, const std::string& key) {
  return value_as<std::string>(header, key, "a string");
}
const std::vector<std::string>& texts(const Header& header, const std::string& key) {
  return value_as<std::vector<std::string>>(header, key, "a list of strings");
}

}  // namespace fluxpact
