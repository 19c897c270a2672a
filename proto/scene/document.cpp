#include "proto/scene/document.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <set>
#include <sstream>

namespace fluxpact {
namespace {

/// Builds the tree from the events of yaml-cpp, one frame for each open list or map.
class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(Findings& findings, int override_index)
      : findings_(findings), override_index_(override_index) {}

  TreeNode take_root() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ > 1) {
      stop(mark,
           "a second document starts here; a scene is one document, remove `---` and what follows");
    }
  }
  void OnDocumentEnd() override {}
  void OnAnchor(const YAML::Mark& mark, const std::string& /*name*/) override {
    findings_.add(place(mark), path(),
                  "anchors (&name) are not used in scenes; write the value out");
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override {
    findings_.add(place(mark), path(),
                  "aliases (*name) are not used in scenes; write the value out");
    add(leaf(mark, TreeNode::Kind::refused));
  }
  void OnNull(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override {
    add(leaf(mark, TreeNode::Kind::null));
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t /*anchor*/,
                const std::string& value) override {
    TreeNode node = leaf(mark, TreeNode::Kind::scalar);
    node.text = value;
    node.quoted = tag == "!";  // the tag that yaml-cpp gives to quoted text
    if (tag != "!") {
      refuse_tag(mark, tag);
    }
    add(std::move(node));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t /*anchor*/,
                       YAML::EmitterStyle::value /*style*/) override {
    refuse_tag(mark, tag);
    open(mark, TreeNode::Kind::list);
  }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t /*anchor*/,
                  YAML::EmitterStyle::value /*style*/) override {
    refuse_tag(mark, tag);
    open(mark, TreeNode::Kind::map);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapEnd() override { close(); }

 private:
  struct Frame {
    TreeNode node;
    bool has_key = false;  ///< of a map: the key of the next value is known
    bool drop = false;     ///< of a map: the next value belongs to a refused key
    std::string key;
    Place key_place;
    std::set<std::string> keys;
  };

  Place place(const YAML::Mark& mark) const {
    return {override_index_, mark.line + 1, mark.column + 1};
  }

  TreeNode leaf(const YAML::Mark& mark, TreeNode::Kind kind) const {
    TreeNode node;
    node.kind = kind;
    node.place = place(mark);
    return node;
  }

  std::string path() const {
    std::string text;
    for (const Frame& frame : frames_) {
      if (frame.node.kind == TreeNode::Kind::list) {
        text += fmt::format("[{}]", frame.node.children.size());
      } else if (frame.has_key) {
        text += (text.empty() ? "" : ".") + frame.key;
      }
    }
    return text;
  }

  [[noreturn]] void stop(const YAML::Mark& mark, const std::string& text) {
    findings_.add(place(mark), path(), text);
    throw findings_.error();
  }

  /// yaml-cpp gives "?" or nothing to values without a tag.
  void refuse_tag(const YAML::Mark& mark, const std::string& tag) {
    if (tag != "?" && !tag.empty()) {
      findings_.add(place(mark), path(),
                    fmt::format("the tag `{}` is not used in scenes; remove it", shown(tag)));
    }
  }

  void open(const YAML::Mark& mark, TreeNode::Kind kind) {
    if (frames_.size() == deepest_scene) {
      stop(mark, fmt::format("more than {} sections inside each other; no scene is that deep",
                             deepest_scene));
    }
    frames_.emplace_back().node = leaf(mark, kind);
  }

  void close() {
    TreeNode node = std::move(frames_.back().node);
    frames_.pop_back();
    add(std::move(node));
  }

  void add(TreeNode node) {
    if (frames_.empty()) {
      root_ = std::move(node);
    } else if (frames_.back().node.kind == TreeNode::Kind::list) {
      frames_.back().node.children.push_back(std::move(node));
    } else if (!frames_.back().has_key) {
      add_key(node);
    } else {
      add_entry(std::move(node));
    }
  }

  void add_key(const TreeNode& node) {
    Frame& frame = frames_.back();
    const std::string section = path();
    frame.key = node.text;
    frame.key_place = node.place;
    frame.drop = true;
    if (node.kind != TreeNode::Kind::scalar) {
      findings_.add(node.place, section, "a key must be a plain word");
      frame.key = std::string(1, '?');
    } else if (!frame.keys.insert(node.text).second) {
      findings_.add(node.place, section.empty() ? node.text : section + "." + node.text,
                    "the key stands here a second time; keep one");
    } else {
      frame.drop = false;
    }
    frame.has_key = true;
  }

  void add_entry(TreeNode node) {
    Frame& frame = frames_.back();
    frame.has_key = false;
    if (frame.drop) {
      return;
    }
    node.key = frame.key;
    node.key_place = frame.key_place;
    if (node.kind == TreeNode::Kind::null) {
      node.place = frame.key_place;  // yaml-cpp marks what follows, often the next line
    }
    frame.node.children.push_back(std::move(node));
  }

  Findings& findings_;
  int override_index_ = -1;
  int documents_ = 0;
  std::vector<Frame> frames_;
  TreeNode root_;
};

/// yaml-cpp takes byte 4 for the end of the file and lets others pass: refuse them all with their
/// place.
void refuse_control_characters(const std::string& text, Findings& findings, int override_index) {
  Place place{override_index, 1, 1};
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    constexpr unsigned char first_printable = 0x20;
    constexpr unsigned char del = 0x7f;
    if ((byte < first_printable && c != '\n' && c != '\r' && c != '\t') || byte == del) {
      findings.add(place, "",
                   fmt::format("the control character 0x{:02x}; a scene is plain text", byte));
      throw findings.error();
    }
    place.column += 1;
    if (c == '\n') {
      place.line += 1;
      place.column = 1;
    }
  }
}

}  // namespace

const TreeNode* TreeNode::find(const std::string& name) const {
  const auto found = std::find_if(children.begin(), children.end(),
                                  [&](const TreeNode& child) { return child.key == name; });
  return kind == Kind::map && found != children.end() ? &*found : nullptr;
}

TreeNode* TreeNode::find(const std::string& name) {
  return const_cast<TreeNode*>(static_cast<const TreeNode*>(this)->find(name));
}

Place heading(const TreeNode& node) { return node.key.empty() ? node.place : node.key_place; }

TreeNode parse_document(const std::string& text, Findings& findings, int override_index) {
  if (text.size() > largest_scene) {
    findings.add({override_index, 1, 1}, "",
                 fmt::format("{} bytes; a scene has at most {}", text.size(), largest_scene));
    throw findings.error();
  }
  refuse_control_characters(text, findings, override_index);
  TreeBuilder builder(findings, override_index);
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& error) {
    const Place place{override_index, std::max(error.mark.line, 0) + 1,
                      std::max(error.mark.column, 0) + 1};
    findings.add(place, "", fmt::format("not valid YAML: {}", error.msg));
    throw findings.error();
  }
  return builder.take_root();
}

}  // namespace fluxpact
