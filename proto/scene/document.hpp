// YAML text -> a tree that keeps the place of everything, and refuses what hides mistakes.
//
// yaml-cpp alone takes the first of two equal keys, reads 012 as octal and `no` as false, and
// resolves aliases; so only its events are used, values stay text until the schema says what they
// are.
#pragma once

#include <string>
#include <vector>

#include "proto/scene/findings.hpp"

namespace fluxpact {

struct TreeNode {
  enum class Kind {
    null,
    scalar,
    list,
    map,
    refused,  ///< something that a finding was already written for: nothing more to say about it
  };

  Kind kind = Kind::null;
  Place place;
  std::string text;                ///< of a scalar
  bool quoted = false;             ///< the scalar stood in quotes: never a number or a choice
  std::vector<TreeNode> children;  ///< of a list or map, in the order of the file
  std::string key;                 ///< of an entry of a map
  Place key_place;                 ///< of an entry of a map

  /// The entry of a map, or nullptr.
  const TreeNode* find(const std::string& name) const;
  TreeNode* find(const std::string& name);
};

/// Limits that no scene of a person comes near; they bound memory and recursion before anything is
/// built.
inline constexpr std::size_t largest_scene = 1 << 20;  ///< [bytes]
inline constexpr std::size_t deepest_scene = 16;       ///< sections inside sections

/// The tree of one YAML document. Findings: aliases, anchors, tags, equal keys, keys that are not
/// plain words. Throws ConfigError with all findings so far if the text cannot be read on: not
/// YAML, too large, too deep, control characters, several documents.
TreeNode parse_document(const std::string& text, Findings& findings, int override_index = -1);

/// Put the value of `a.b[2].c=value` into the tree, over what stands there. `index` counts the
/// overrides for messages.
void apply_override(TreeNode& root, const std::string& assignment, int index, Findings& findings);

/// Where to point for something that a section lacks: its key, else its first line.
Place heading(const TreeNode& node);

}  // namespace fluxpact
