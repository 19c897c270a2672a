#include "proto/scene/read_value.hpp"

#include "proto/base/errors.hpp"
#include "proto/base/expression.hpp"

namespace fluxpact {
namespace {

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Words that YAML 1.1 readers turn into something else than text.
bool is_yaml_word(std::string_view text) {
  std::string lower;
  for (const char c : text) {
    lower += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  constexpr auto words = std::to_array<std::string_view>(
      {"yes", "no", "on", "off", "true", "false", "y", "n", "null", "~"});
  return std::find(words.begin(), words.end(), lower) != words.end();
}

/// Reads a list of exactly `size` values; false after a finding.
template <class T, std::size_t size>
bool read_fixed_list(const Spot& spot, std::array<T, size>& values, std::string_view expected) {
  if (spot.node.kind == TreeNode::Kind::refused) {
    return false;
  }
  if (spot.node.kind != TreeNode::Kind::list || spot.node.children.size() != size) {
    const std::string what = spot.node.kind == TreeNode::Kind::list
                                 ? fmt::format("a list of {}", spot.node.children.size())
                                 : seen(spot.node);
    spot.refuse(fmt::format("{} where {} is expected", what, expected));
    return false;
  }
  const std::size_t before = spot.findings.count();
  for (std::size_t i = 0; i < size; ++i) {
    const std::string path = fmt::format("{}[{}]", spot.path, i);
    spot.findings.remember(path, spot.node.children[i].place);
    read_value(Spot{spot.node.children[i], path, spot.key, spot.findings}, values.at(i));
  }
  return spot.findings.count() == before;
}

/// A plain scalar, or a finding that says what is expected.
bool is_plain(const Spot& spot, const std::string& expected) {
  if (spot.node.kind == TreeNode::Kind::scalar && !spot.node.quoted) {
    return true;
  }
  if (spot.node.kind != TreeNode::Kind::refused) {
    spot.refuse(fmt::format("{} where {} is expected", seen(spot.node), expected));
  }
  return false;
}

/// Takes what was parsed if it lies in the key's range, else says why not.
template <class T>
void accept(const Spot& spot, const Parsed<T>& parsed, T& value) {
  if (!parsed.problem.empty()) {
    spot.refuse(fmt::format("`{}`: {} (expected: {})", shown(spot.node.text), parsed.problem,
                            expectation<T>(spot.key)));
  } else if (!spot.key.range.holds(static_cast<double>(parsed.value))) {
    spot.refuse(fmt::format("`{}` is out of range; allowed: {}", shown(spot.node.text),
                            spot.key.range.text()));
  } else {
    value = parsed.value;
  }
}

}  // namespace

std::string seen(const TreeNode& node) {
  switch (node.kind) {
    case TreeNode::Kind::null:
      return "no value";
    case TreeNode::Kind::scalar:
      return node.quoted ? fmt::format("the text \"{}\"", shown(node.text))
                         : fmt::format("`{}`", shown(node.text));
    case TreeNode::Kind::list:
      return "a list";
    case TreeNode::Kind::map:
      return "a section";
    case TreeNode::Kind::refused:
      break;
  }
  return "what stands here";
}

bool is_name(std::string_view text) {
  return !text.empty() && is_letter(text[0]) && !is_yaml_word(text) &&
         std::all_of(text.begin(), text.end(),
                     [](char c) { return is_letter(c) || is_digit(c) || c == '-'; });
}

void read_value(const Spot& spot, double& value) {
  if (is_plain(spot, expectation<double>(spot.key))) {
    accept(spot, parse_number(spot.node.text, spot.key.dimension), value);
  }
}

void read_value(const Spot& spot, int& value) {
  if (is_plain(spot, expectation<int>(spot.key))) {
    accept(spot, parse_integer(spot.node.text), value);
  }
}

void read_value(const Spot& spot, std::string& value) {
  const TreeNode& node = spot.node;
  if (node.kind == TreeNode::Kind::refused) {
    return;
  }
  const auto is_control = [](char c) { return (c >= 0 && c < ' ') || c == '\x7f'; };
  if (node.kind != TreeNode::Kind::scalar || node.text.empty()) {
    spot.refuse(fmt::format("{} where a {} is expected",
                            node.text.empty() ? "no value" : seen(node),
                            ValueKind<std::string>::text(spot.key)));
  } else if (!node.quoted && is_yaml_word(node.text)) {
    spot.refuse(fmt::format(
        "`{}` is a truth value for other readers of YAML; text is expected, put it in quotes",
        node.text));
  } else if (std::any_of(node.text.begin(), node.text.end(), is_control)) {
    spot.refuse("the text contains a control character or line break");
  } else if (spot.key.text == TextRule::name && !is_name(node.text)) {
    spot.refuse(fmt::format("`{}` is not a name: a letter or _, then letters, digits, _ and -",
                            shown(node.text)));
  } else {
    value = node.text;
  }
}

void read_value(const Spot& spot, Vector3& value) {
  std::array<double, 3> components{};
  if (read_fixed_list(spot, components, expectation<Vector3>(spot.key))) {
    value = Vector3(components[0], components[1], components[2]);
  }
}

void read_value(const Spot& spot, Formula& value) {
  const TreeNode& node = spot.node;
  if (node.kind != TreeNode::Kind::scalar || node.text.empty()) {
    if (node.kind != TreeNode::Kind::refused) {
      spot.refuse(
          fmt::format("{} where {} is expected", seen(node), expectation<Formula>(spot.key)));
    }
    return;
  }
  const Parsed<double> number = parse_number(node.text, spot.key.dimension);
  if (!node.quoted && number.problem.empty()) {
    double accepted = 0;
    accept(spot, number, accepted);
    value = Formula(accepted);
    return;
  }
  try {
    const Expression formula(node.text);
    value.text = node.text;
  } catch (const ConfigError& error) {
    spot.refuse(fmt::format("`{}` is neither a number ({}) nor a formula: {}", shown(node.text),
                            number.problem, error.what()));
  }
}

void read_value(const Spot& spot, VectorFormula& value) {
  std::array<Formula, 3> components;
  if (read_fixed_list(spot, components, expectation<VectorFormula>(spot.key))) {
    value.components = components;
  }
}

/// The rows of a table: the first column ascends.
void read_value(const Spot& spot, std::vector<std::array<double, 2>>& value) {
  if (spot.node.kind != TreeNode::Kind::list || spot.node.children.empty()) {
    if (spot.node.kind != TreeNode::Kind::refused) {
      spot.refuse(fmt::format("{} where a list of pairs is expected, e.g. [[0, 0], [1, 2.5]]",
                              seen(spot.node)));
    }
    return;
  }
  value.clear();
  for (std::size_t i = 0; i < spot.node.children.size(); ++i) {
    const std::string path = fmt::format("{}[{}]", spot.path, i);
    const Spot row{spot.node.children[i], path, spot.key, spot.findings};
    std::array<double, 2> pair{};
    if (!read_fixed_list(row, pair, "a pair of numbers")) continue;
    if (!value.empty() && !(pair[0] > value.back()[0])) {
      row.refuse(fmt::format("{} does not lie above {} of the row before; rows ascend", pair[0],
                             value.back()[0]));
    }
    value.push_back(pair);
  }
}

void read_value(const Spot& spot, std::array<double, 2>& value) {
  std::array<double, 2> ends{};
  if (!read_fixed_list(spot, ends, expectation<std::array<double, 2>>(spot.key))) {
    return;
  }
  if (ends[0] < ends[1]) {
    value = ends;
  } else {
    spot.refuse(
        fmt::format("the range [{}, {}] is empty; the lower end comes first", ends[0], ends[1]));
  }
}

void read_value(const Spot& spot, std::array<int, 3>& value) {
  std::array<int, 3> numbers{};
  if (read_fixed_list(spot, numbers, expectation<std::array<int, 3>>(spot.key))) {
    value = numbers;
  }
}

/// A list of texts, each at most once.
void read_value(const Spot& spot, std::vector<std::string>& value) {
  if (spot.node.kind != TreeNode::Kind::list) {
    if (spot.node.kind != TreeNode::Kind::refused) {
      spot.refuse(fmt::format("{} where a list of {} is expected, e.g. [a, b]", seen(spot.node),
                              ValueKind<std::string>::text(spot.key)));
    }
    return;
  }
  value.clear();
  for (std::size_t i = 0; i < spot.node.children.size(); ++i) {
    const std::string path = fmt::format("{}[{}]", spot.path, i);
    spot.findings.remember(path, spot.node.children[i].place);
    const Spot item{spot.node.children[i], path, spot.key, spot.findings};
    std::string text;
    read_value(item, text);
    if (std::find(value.begin(), value.end(), text) != value.end()) {
      item.refuse(fmt::format("`{}` stands here a second time; keep one", text));
    } else if (!text.empty()) {
      value.push_back(text);
    }
  }
}

void read_value(const Spot& spot, std::array<std::string, 2>& value) {
  std::array<std::string, 2> names;
  if (read_fixed_list(spot, names, expectation<std::array<std::string, 2>>(spot.key))) {
    value = names;
  }
}

}  // namespace fluxpact
