// Reading: the schema, visited with the tree of the file.
#include "proto/scene/check.hpp"
#include "proto/scene/read_scene.hpp"
#include "proto/scene/read_value.hpp"

namespace fluxpact {
namespace {

/// Visits the keys of one section: reads what is there, and says what is missing or not known.
class SectionReader {
 public:
  SectionReader(const TreeNode& node, const std::string& path, Findings& findings)
      : node_(node), path_(path), findings_(findings), found_before_(findings.count()) {}

  template <class T>
  void operator()(const Key& key, T& member) {
    known_.emplace_back(key.name);
    const std::string path = path_of(known_.back());
    const TreeNode* const value = node_.find(known_.back());
    if (value == nullptr) {
      // After an error in this section its conditions may be wrong: `type` may be what is misspelt.
      if (key.required && key.applies && (key.only_with.empty() || is_clean())) {
        findings_.add(heading(node_), path,
                      fmt::format("missing; required{}: {}", condition(key), expectation<T>(key)));
      }
      return;
    }
    findings_.remember(path,
                       value->kind == TreeNode::Kind::scalar ? value->place : value->key_place);
    if (!key.applies) {
      if (is_clean()) {
        findings_.add(value->key_place, path,
                      fmt::format("has no meaning here, only{}; remove it", condition(key)));
      }
      return;
    }
    read_value(Spot{*value, path, key, findings_}, member);
  }

  void refuse_unknown_keys() const {
    for (const TreeNode& child : node_.children) {
      if (std::find(known_.begin(), known_.end(), child.key) == known_.end()) {
        findings_.add(child.key_place, path_of(child.key),
                      fmt::format("unknown key{}; allowed here: {}",
                                  nearest_hint(child.key, known_), joined(known_)));
      }
    }
  }

 private:
  std::string path_of(const std::string& name) const {
    return path_.empty() ? name : path_ + "." + name;
  }
  bool is_clean() const { return findings_.count() == found_before_; }
  static std::string condition(const Key& key) {
    return key.only_with.empty() ? std::string{} : fmt::format(" with `{}`", key.only_with);
  }

  const TreeNode& node_;
  const std::string& path_;
  Findings& findings_;
  std::size_t found_before_ = 0;
  std::vector<std::string> known_;
};

/// The entries of a map; `insert(name)` gives the section to read into.
template <class Insert>
void read_named(const Spot& spot, const Insert& insert) {
  if (spot.node.kind == TreeNode::Kind::refused) {
    return;
  }
  if (spot.node.kind != TreeNode::Kind::map) {
    return spot.refuse(fmt::format("{} where sections by name are expected", seen(spot.node)));
  }
  for (const TreeNode& child : spot.node.children) {
    const std::string path = spot.path + "." + child.key;
    spot.findings.remember(path, child.key_place);
    if (is_name(child.key)) {
      read_value(Spot{child, path, spot.key, spot.findings}, insert(child.key));
    } else {
      spot.findings.add(
          child.key_place, path,
          fmt::format(
              "`{}` is not a name: a letter or _, then letters, digits, _ and -; no truth value",
              shown(child.key)));
    }
  }
}

/// A scene of another version may differ in anything: that is the one thing to say then.
void refuse_other_version(const TreeNode& root, Findings& findings) {
  const TreeNode* const version = root.find("version");
  if (version == nullptr || version->kind != TreeNode::Kind::scalar || version->quoted) {
    return;
  }
  constexpr int read_here = 1;
  const Parsed<int> number = parse_integer(version->text);
  if (number.problem.empty() && number.value != read_here) {
    findings.add(version->place, "version",
                 fmt::format("`{}` is not supported; this program reads version {}", number.value,
                             read_here));
    throw findings.error();
  }
}

/// Defaults that follow from other values of the scene.
void fill_in(Scene& scene) {
  if (scene.output.directory.empty()) {
    scene.output.directory = "runs/" + scene.scene.name;
  }
  for (PairSettings& pair : scene.particles.contact.pairs) {
    if (pair.normal_stiffness && !pair.tangential_stiffness) {
      pair.tangential_stiffness = 2.0 / 7.0 * *pair.normal_stiffness;
    }
    if (scene.particles.contact.rolling == RollingLaw::spring_dashpot && !pair.rolling_damping) {
      pair.rolling_damping = 0.3;
    }
  }
  for (InsertionSettings& entry : scene.particles.insertion) {
    if (entry.type == InsertionType::lattice && entry.spacing == 0) {
      entry.spacing = 1.001 * entry.diameter;
    }
  }
}

}  // namespace

template <Section S>
void read_value(const Spot& spot, S& section) {
  if (spot.node.kind == TreeNode::Kind::refused) {
    return;
  }
  if constexpr (requires { S::short_form; }) {
    if (spot.node.kind == TreeNode::Kind::scalar) {  // stands for the section with this one key
      TreeNode only = spot.node;
      only.key = S::short_form;
      TreeNode around;
      around.kind = TreeNode::Kind::map;
      around.place = spot.node.place;
      around.children.push_back(std::move(only));
      return read_value(Spot{around, spot.path, spot.key, spot.findings}, section);
    }
  }
  if (spot.node.kind != TreeNode::Kind::map) {
    return spot.refuse(fmt::format("{} where a section with keys is expected", seen(spot.node)));
  }
  SectionReader reader(spot.node, spot.path, spot.findings);
  describe(reader, section);
  reader.refuse_unknown_keys();
}

template <Section S>
void read_value(const Spot& spot, std::vector<S>& sections) {
  if (spot.node.kind == TreeNode::Kind::refused) {
    return;
  }
  if (spot.node.kind != TreeNode::Kind::list) {
    return spot.refuse(fmt::format("{} where a list of sections is expected", seen(spot.node)));
  }
  sections.clear();
  for (std::size_t i = 0; i < spot.node.children.size(); ++i) {
    const std::string path = fmt::format("{}[{}]", spot.path, i);
    spot.findings.remember(path, spot.node.children[i].place);
    read_value(Spot{spot.node.children[i], path, spot.key, spot.findings}, sections.emplace_back());
  }
}

template <Section S>
void read_value(const Spot& spot, std::map<std::string, S>& sections) {
  read_named(spot, [&](const std::string& name) -> S& { return sections[name]; });
}

template <Section S>
void read_value(const Spot& spot, std::vector<std::pair<std::string, S>>& sections) {
  read_named(
      spot, [&](const std::string& name) -> S& { return sections.emplace_back(name, S{}).second; });
}

Scene read_scene(const std::string& text, const std::string& source,
                 const std::vector<std::string>& overrides) {
  Findings findings(source, overrides);
  TreeNode root = parse_document(text, findings);
  for (std::size_t i = 0; i < overrides.size(); ++i) {
    apply_override(root, overrides[i], static_cast<int>(i), findings);
  }
  refuse_other_version(root, findings);
  Scene scene;
  const std::string no_path;
  read_value(Spot{root, no_path, Key{}, findings}, scene);
  check_scene(scene, findings);
  if (findings.count() > 0) {
    throw findings.error();
  }
  fill_in(scene);
  return scene;
}

}  // namespace fluxpact
