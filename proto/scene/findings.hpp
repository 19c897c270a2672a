// What is wrong with a scene, collected so that the user sees all of it at once.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "proto/base/errors.hpp"

namespace fluxpact {

/// Where something stands: in the file, or in an override of the command line. Sorts file first.
struct Place {
  int override_index = -1;  ///< -1: in the file
  int line = 1;             ///< from 1
  int column = 1;           ///< from 1
  bool operator<(const Place& other) const {
    return std::tie(override_index, line, column) <
           std::tie(other.override_index, other.line, other.column);
  }
};

class Findings {
 public:
  /// `source` names the file in messages; `overrides` are the texts that Place::override_index
  /// counts.
  Findings(std::string source, std::vector<std::string> overrides)
      : source_(std::move(source)), overrides_(std::move(overrides)) {}

  /// A finding about the key `path` (empty: about the file as a whole).
  void add(const Place& place, const std::string& path, const std::string& text);

  /// A finding of a check after reading: the place is that of the path, or of the nearest section
  /// around it.
  void add(const std::string& path, const std::string& text);

  /// Remember where a path stands, for checks after reading.
  void remember(const std::string& path, const Place& place) { places_[path] = place; }

  /// True if nothing was found at the path, inside it, or in a section around it: a check of its
  /// value makes sense.
  bool sound(const std::string& path) const;

  std::size_t count() const { return entries_.size(); }

  /// All findings sorted by place, one a line. Throws nothing; for `throw findings.error()`.
  ConfigError error() const;

 private:
  struct Entry {
    Place place;
    std::string path;
    std::string text;
  };

  std::string source_;
  std::vector<std::string> overrides_;
  std::vector<Entry> entries_;
  std::map<std::string, Place> places_;
};

/// A value of the user in a message: at most 60 characters of it.
std::string shown(std::string_view text);

/// "; nearest: `x`" for the candidate with the fewest edits, if that is near enough to be a slip of
/// the hand: at most a third of the longer word. Else empty.
std::string nearest_hint(std::string_view word, std::span<const std::string> candidates);

/// "a, b, c"
std::string joined(std::span<const std::string> words);

}  // namespace fluxpact
