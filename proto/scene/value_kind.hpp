// What the value of a key looks like, in words, for error messages and the reference.
#pragma once

#include <fmt/format.h>

#include <array>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "proto/scene/findings.hpp"
#include "proto/scene/key.hpp"
#include "proto/scene/names.hpp"
#include "proto/scene/schema.hpp"

namespace fluxpact {

/// The words of an enum, in order.
template <class Enum>
std::vector<std::string> words_of() {
  std::vector<std::string> words;
  words.reserve(enum_names<Enum>.size());
  for (const auto& entry : enum_names<Enum>) {
    words.emplace_back(entry.name);
  }
  return words;
}

template <class T>
struct ValueKind;  // specialised below for each type that a member may have

template <>
struct ValueKind<double> {
  static std::string text(const Key& /*key*/) { return "number"; }
};
template <>
struct ValueKind<int> {
  static std::string text(const Key& /*key*/) { return "whole number"; }
};
template <>
struct ValueKind<std::string> {
  static std::string text(const Key& key) { return key.text == TextRule::name ? "name" : "text"; }
};
template <>
struct ValueKind<Vector3> {
  static std::string text(const Key& /*key*/) { return "list of 3 numbers"; }
};
template <>
struct ValueKind<Formula> {
  static std::string text(const Key& /*key*/) { return "number or formula"; }
};
template <>
struct ValueKind<VectorFormula> {
  static std::string text(const Key& /*key*/) { return "list of 3 numbers or formulas"; }
};
template <>
struct ValueKind<std::vector<std::array<double, 2>>> {
  static std::string text(const Key& /*key*/) { return "list of pairs of numbers"; }
};
template <>
struct ValueKind<std::array<double, 2>> {
  static std::string text(const Key& /*key*/) { return "list of 2 numbers, the lower first"; }
};
template <>
struct ValueKind<std::array<int, 3>> {
  static std::string text(const Key& /*key*/) { return "list of 3 whole numbers"; }
};
template <>
struct ValueKind<std::array<std::string, 2>> {
  static std::string text(const Key& /*key*/) { return "list of 2 names"; }
};
template <class Enum>
requires std::is_enum_v<Enum>
struct ValueKind<Enum> {
  static std::string text(const Key& /*key*/) {
    return fmt::format("{}", fmt::join(words_of<Enum>(), " | "));
  }
};
template <Section S>
struct ValueKind<S> {
  static std::string text(const Key& /*key*/) { return "section"; }
};
template <class T>
struct ValueKind<std::optional<T>> : ValueKind<T> {};
template <class T>
struct ValueKind<std::vector<T>> {
  static std::string text(const Key& key) {
    return Section<T> ? "list of sections" : "list of " + ValueKind<T>::text(key);
  }
};
template <class T>
struct ValueKind<std::map<std::string, T>> {
  static std::string text(const Key& /*key*/) { return "sections by name"; }
};
template <class T>
struct ValueKind<std::vector<std::pair<std::string, T>>> {
  static std::string text(const Key& /*key*/) { return "sections by name, in order"; }
};

/// "a number in m/s, > 0"
template <class T>
std::string expectation(const Key& key) {
  std::string text = std::is_enum_v<T> ? "one of " : "a ";
  text += ValueKind<T>::text(key);
  if (key.dimension != Dimension::none) {
    text += fmt::format(" in {}", si_unit(key.dimension));
  }
  return key.range.text().empty() ? text : text + ", " + key.range.text();
}

}  // namespace fluxpact
