#include "proto/scene/findings.hpp"

#include <algorithm>
#include <numeric>

namespace fluxpact {
namespace {

/// True if `inner` is `outer` or stands inside it.
bool is_within(std::string_view inner, std::string_view outer) {
  return inner.substr(0, outer.size()) == outer &&
         (inner.size() == outer.size() || outer.empty() || inner[outer.size()] == '.' ||
          inner[outer.size()] == '[');
}

/// Fewest insertions, deletions, substitutions and swaps of neighbours (Damerau, Commun. ACM 7,
/// 1964, 171-176), no part edited twice.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1);
  std::vector<std::size_t> above(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    before.swap(above);
    above.swap(row);
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      row[j + 1] = std::min({above[j] + (a[i] == b[j] ? 0 : 1), row[j] + 1, above[j + 1] + 1});
      if (i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j]) {
        row[j + 1] = std::min(row[j + 1], before[j - 1] + 1);
      }
    }
  }
  return row[b.size()];
}

}  // namespace

void Findings::add(const Place& place, const std::string& path, const std::string& text) {
  entries_.push_back({place, path, text});
}

void Findings::add(const std::string& path, const std::string& text) {
  std::string around = path;
  while (!around.empty() && !places_.contains(around)) {
    const std::size_t cut = around.find_last_of(".[");
    around.resize(cut == std::string::npos ? 0 : cut);
  }
  const auto found = places_.find(around);
  add(found == places_.end() ? Place{} : found->second, path, text);
}

bool Findings::sound(const std::string& path) const {
  return std::none_of(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return is_within(entry.path, path) || is_within(path, entry.path);
  });
}

ConfigError Findings::error() const {
  std::vector<Entry> sorted = entries_;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Entry& a, const Entry& b) { return a.place < b.place; });
  constexpr std::size_t most_shown = 200;  // nobody reads more, and a garbled file may have 100 000
  std::string text;
  for (std::size_t i = 0; i < std::min(sorted.size(), most_shown); ++i) {
    const Entry& entry = sorted[i];
    const std::string where =
        entry.place.override_index < 0
            ? fmt::format("{}:{}:{}", source_, entry.place.line, entry.place.column)
            : fmt::format(
                  "--set {}",
                  shown(overrides_.at(static_cast<std::size_t>(entry.place.override_index))));
    text += fmt::format("{}{}: {}{}", i == 0 ? "" : "\n", where,
                        entry.path.empty() ? std::string{} : shown(entry.path) + ": ", entry.text);
  }
  if (sorted.size() > most_shown) {
    text += fmt::format("\n{}: {} more errors are not shown", source_, sorted.size() - most_shown);
  }
  return ConfigError("{}", text);
}

std::string shown(std::string_view text) {
  constexpr std::size_t longest = 60;
  return text.size() <= longest ? std::string(text) : std::string(text.substr(0, longest)) + "...";
}

std::string nearest_hint(std::string_view word, std::span<const std::string> candidates) {
  constexpr std::size_t longest = 60;  // of a word that may be a misspelling
  std::size_t best = word.size() > longest ? 0 : word.size() + longest;
  const std::string* nearest = nullptr;
  for (const std::string& candidate : candidates) {
    if (word.size() > longest) {
      break;
    }
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best && 3 * distance <= std::max(word.size(), candidate.size())) {
      best = distance;
      nearest = &candidate;
    }
  }
  return nearest == nullptr ? std::string{} : fmt::format("; nearest: `{}`", *nearest);
}

std::string joined(std::span<const std::string> words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace fluxpact
