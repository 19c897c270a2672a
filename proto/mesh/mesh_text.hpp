// The text of a mesh file, read from its begin to its end: numbers, words and signs, with the line
// for messages. The readers of both formats stand on it. They are our own because the formats are
// small, and the libraries that read them (OpenFOAM, gmsh, VTK) are larger than this project.
#pragma once

#include <string>
#include <string_view>

#include "proto/base/errors.hpp"

namespace fluxpact {

/// What separates the tokens besides white space.
enum class Comments { none, cpp };

class MeshText {
 public:
  /// `path` names the file in messages. With `Comments::cpp`, // and /* */ are white space.
  MeshText(std::string text, std::string path, Comments comments)
      : text_(std::move(text)), path_(std::move(path)), comments_(comments) {}

  bool at_end();
  /// The next character that is no white space, 0 at the end; stays before it.
  char peek();
  /// Takes the sign if it comes next.
  bool take(char sign);
  void expect(char sign);
  double number();
  int whole();
  /// A tag of Gmsh: up to 64 bits.
  long long tag();
  /// Up to white space, a bracket, `;`, or the quotes that end a text in quotes.
  std::string word();
  /// The rest of the line, without the line's end.
  std::string_view rest_of_line();
  void skip_line() { rest_of_line(); }
  /// A number of things, so many that the file can hold them at `least_bytes` each: a damaged file
  /// must not reserve memory for more.
  int count(std::string_view of_what, std::size_t least_bytes);

  /// Throws ConfigError "path:line: ...".
  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
    throw ConfigError("{}:{}: {}", path_, line(), fmt::format(text, std::forward<Args>(args)...));
  }
  const std::string& path() const { return path_; }

 private:
  void skip_space();
  int line() const;
  template <class Number>
  Number parse(const char* what);
  std::string seen() const;

  std::string text_;
  std::string path_;
  Comments comments_;
  std::size_t at_ = 0;
};

}  // namespace fluxpact
