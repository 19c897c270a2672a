// Values of the command line, put into the tree before anything is checked.
#include <charconv>
#include <system_error>

#include "proto/scene/document.hpp"

namespace fluxpact {
namespace {

/// One step of a path: a key, or the index of a list.
struct Step {
  std::string key = {};
  std::size_t index = 0;
  bool is_index = false;
};

/// `a.b[2].c` in steps; empty if it is not of that form.
std::vector<Step> split_path(std::string_view path) {
  std::vector<Step> steps;
  std::size_t at = 0;
  while (at < path.size()) {
    if (path[at] == '[') {
      Step step{.is_index = true};
      const char* const end = path.data() + path.size();
      const auto read = std::from_chars(path.data() + at + 1, end, step.index);
      if (read.ec != std::errc() || read.ptr == end || *read.ptr != ']' || steps.empty()) {
        return {};
      }
      at = static_cast<std::size_t>(read.ptr - path.data()) + 1;
      steps.push_back(step);
    } else {
      at += path[at] == '.' && !steps.empty() ? 1 : 0;
      const std::size_t end = std::min(path.find_first_of(".[", at), path.size());
      if (end == at) {
        return {};
      }
      steps.push_back({.key = std::string(path.substr(at, end - at))});
      at = end;
    }
  }
  return !path.empty() && path.back() != '.' ? steps : std::vector<Step>{};
}

/// Go down one step; makes the section if it is not there. nullptr after a finding.
TreeNode* descend(TreeNode& node, const Step& step, const std::string& path, const Place& place,
                  Findings& findings) {
  if (step.is_index) {
    if (node.kind != TreeNode::Kind::list || step.index >= node.children.size()) {
      findings.add(
          place, path,
          fmt::format("[{}] does not exist in the scene; the list has {} entries, the first is [0]",
                      step.index, node.kind == TreeNode::Kind::list ? node.children.size() : 0));
      return nullptr;
    }
    return &node.children[step.index];
  }
  if (node.kind == TreeNode::Kind::null) {
    node.kind = TreeNode::Kind::map;
  }
  if (node.kind != TreeNode::Kind::map) {
    findings.add(place, path,
                 fmt::format("`{}` cannot be set: the scene has no section there", step.key));
    return nullptr;
  }
  if (TreeNode* const known = node.find(step.key)) {
    return known;
  }
  TreeNode entry;
  entry.place = place;
  entry.key = step.key;
  entry.key_place = place;
  node.children.push_back(std::move(entry));
  return &node.children.back();
}

}  // namespace

void apply_override(TreeNode& root, const std::string& assignment, int index, Findings& findings) {
  const Place place{index, 1, 1};
  const std::size_t equals = assignment.find('=');
  const std::string path = assignment.substr(0, std::min(equals, assignment.size()));
  const std::vector<Step> steps = split_path(path);
  if (equals == std::string::npos || steps.empty()) {
    findings.add(
        place, "",
        "expected key.path=value, e.g. coupling.window=1e-4 or particles.insertion[0].count=100");
    return;
  }
  TreeNode value = parse_document(assignment.substr(equals + 1), findings, index);
  TreeNode* target = &root;
  for (const Step& step : steps) {
    target = descend(*target, step, path, place, findings);
    if (target == nullptr) {
      return;
    }
  }
  value.key = target->key;
  value.key_place = place;
  *target = std::move(value);
}

}  // namespace fluxpact
