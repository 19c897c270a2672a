// Writing: the schema, visited with a scene; every default stands in the text.
#include "proto/scene/read_scene.hpp"
#include "proto/scene/value_kind.hpp"

namespace fluxpact {
namespace {

// Values of one line. "{}" of fmt writes the shortest decimal text that reads back as the same
// bits.
std::string line_of(double value) { return fmt::format("{}", value); }
std::string line_of(int value) { return fmt::format("{}", value); }

std::string line_of(const std::string& text) {
  std::string quoted(1, '"');
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      quoted.push_back('\\');
    }
    quoted.push_back(c);
  }
  quoted.push_back('"');
  return quoted;
}

std::string line_of(const Formula& formula) {
  return formula.text.empty() ? line_of(formula.number) : line_of(formula.text);
}
std::string line_of(const VectorFormula& vector) {
  const auto& [x, y, z] = vector.components;
  return fmt::format("[{}, {}, {}]", line_of(x), line_of(y), line_of(z));
}

template <class Enum>
requires std::is_enum_v<Enum> std::string line_of(Enum value) {
  return std::string(name_of(value));
}

template <class List>
requires requires(const List& list) { list.begin(); }
std::string line_of(const List& values) {
  std::vector<std::string> items;
  items.reserve(static_cast<std::size_t>(values.size()));
  for (const auto& value : values) {
    items.push_back(line_of(value));
  }
  return fmt::format("[{}]", joined(items));
}

class SectionWriter {
 public:
  explicit SectionWriter(int indent) : indent_(static_cast<std::size_t>(indent), ' ') {}

  template <class T>
  void operator()(const Key& key, T& member) {
    if (key.applies) {
      write(key, member);
    }
  }

  const std::string& text() const { return text_; }

 private:
  template <class T>
  void write(const Key& key, T& value) {
    text_ += fmt::format("{}{}: {}\n", indent_, key.name, line_of(value));
  }
  void write(const Key& key, double& value) {
    if (key.otherwise.empty() || value != 0) {  // 0 stands for "not given" where the schema says so
      write<double>(key, value);
    }
  }
  void write(const Key& key, int& value) {
    if (key.otherwise.empty() || value != 0) write<int>(key, value);
  }
  void write(const Key& key, std::string& value) {
    if (key.otherwise.empty() || !value.empty()) {
      write<std::string>(key, value);
    }
  }
  template <class T>
  void write(const Key& key, std::optional<T>& value) {
    if (value) {
      write<T>(key, *value);
    }
  }

  template <Section S>
  void write(const Key& key, S& section) {
    const std::string inner = inside(section, 2);
    if (!inner.empty()) {
      text_ += fmt::format("{}{}:\n{}", indent_, key.name, inner);
    } else if (key.otherwise.empty()) {
      text_ += fmt::format("{}{}: {{}}\n", indent_, key.name);
    }
  }

  template <Section S>
  void write(const Key& key, std::vector<S>& sections) {
    text_ += fmt::format("{}{}:{}\n", indent_, key.name, sections.empty() ? " []" : "");
    for (S& section : sections) {
      std::string inner = inside(section, 4);
      inner.at(indent_.size() + 2) = '-';
      text_ += inner;
    }
  }

  template <Section S>
  void write(const Key& key, std::map<std::string, S>& sections) {
    write_named(key, sections);
  }
  template <Section S>
  void write(const Key& key, std::vector<std::pair<std::string, S>>& sections) {
    write_named(key, sections);
  }

  template <class Sections>
  void write_named(const Key& key, Sections& sections) {
    text_ += fmt::format("{}{}:{}\n", indent_, key.name, sections.empty() ? " {}" : "");
    for (auto& [name, section] : sections) {
      text_ += fmt::format("{}  {}:\n{}", indent_, name, inside(section, 4));
    }
  }

  template <Section S>
  std::string inside(S& section, int deeper) const {
    SectionWriter writer(static_cast<int>(indent_.size()) + deeper);
    describe(writer, section);
    return writer.text();
  }

  std::string indent_;
  std::string text_;
};

}  // namespace

std::string write_scene(const Scene& scene) {
  Scene copy = scene;  // the schema visits members that a reader may change
  SectionWriter writer(0);
  describe(writer, copy);
  return writer.text();
}

}  // namespace fluxpact
