// One value of the scene's tree -> a member of the scene, or a finding that says what is wrong with
// it.
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "proto/scene/document.hpp"
#include "proto/scene/value_kind.hpp"

namespace fluxpact {

/// A value, where it stands, and what the schema says of it.
struct Spot {
  const TreeNode& node;
  const std::string& path;
  const Key& key;
  Findings& findings;

  void refuse(const std::string& text) const { findings.add(node.place, path, text); }
};

/// "`abc`", "a list", ... for messages.
std::string seen(const TreeNode& node);

/// True if the text is a name: a letter or `_`, then letters, digits, `_`, `-`; no word that YAML
/// takes for a truth value.
bool is_name(std::string_view text);

// Each reads one type; on a finding the member keeps its value.
void read_value(const Spot& spot, double& value);
void read_value(const Spot& spot, int& value);
void read_value(const Spot& spot, std::string& value);
void read_value(const Spot& spot, Vector3& value);
void read_value(const Spot& spot, std::array<double, 2>& value);
void read_value(const Spot& spot, std::vector<std::array<double, 2>>& value);
void read_value(const Spot& spot, Formula& value);
void read_value(const Spot& spot, VectorFormula& value);
void read_value(const Spot& spot, std::array<int, 3>& value);
void read_value(const Spot& spot, std::array<std::string, 2>& value);
void read_value(const Spot& spot, std::vector<std::string>& value);

template <class Enum>
requires std::is_enum_v<Enum>
void read_value(const Spot& spot, Enum& value) {
  const bool plain = spot.node.kind == TreeNode::Kind::scalar && !spot.node.quoted;
  const std::optional<Enum> found = plain ? value_of<Enum>(spot.node.text) : std::nullopt;
  if (found) {
    value = *found;
  } else if (spot.node.kind != TreeNode::Kind::refused) {
    spot.refuse(fmt::format("{} is none of {}{}", seen(spot.node), joined(words_of<Enum>()),
                            nearest_hint(spot.node.text, words_of<Enum>())));
  }
}

/// A list of choices, each at most once.
template <class Enum>
requires std::is_enum_v<Enum>
void read_value(const Spot& spot, std::vector<Enum>& values) {
  if (spot.node.kind != TreeNode::Kind::list) {
    return spot.refuse(fmt::format("{} where a list of {} is expected, e.g. [{}]", seen(spot.node),
                                   ValueKind<Enum>::text(spot.key),
                                   name_of(enum_names<Enum>.front().value)));
  }
  values.clear();
  for (std::size_t i = 0; i < spot.node.children.size(); ++i) {
    const std::string path = fmt::format("{}[{}]", spot.path, i);
    const Spot item{spot.node.children[i], path, spot.key, spot.findings};
    const std::size_t before = spot.findings.count();
    Enum value{};
    read_value(item, value);
    if (spot.findings.count() > before) {
      continue;
    }
    if (std::find(values.begin(), values.end(), value) != values.end()) {
      item.refuse(fmt::format("`{}` stands here a second time; keep one", name_of(value)));
    } else {
      values.push_back(value);
    }
  }
}

// Sections and what holds them are read through the schema: reader.cpp.
template <Section S>
void read_value(const Spot& spot, S& section);
template <Section S>
void read_value(const Spot& spot, std::vector<S>& sections);
template <Section S>
void read_value(const Spot& spot, std::map<std::string, S>& sections);
template <Section S>
void read_value(const Spot& spot, std::vector<std::pair<std::string, S>>& sections);

template <class T>
void read_value(const Spot& spot, std::optional<T>& value) {
  T given{};
  read_value(spot, given);
  value = std::move(given);
}

}  // namespace fluxpact
