#include "proto/mesh/mesh_text.hpp"

#include <algorithm>
#include <charconv>
#include <limits>

namespace fluxpact {
namespace {

bool is_space(char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; }
bool ends_word(char c) {
  return is_space(c) || c == '(' || c == ')' || c == '{' || c == '}' || c == ';' || c == '"';
}

}  // namespace

void MeshText::skip_space() {
  while (at_ < text_.size()) {
    if (is_space(text_[at_])) {
      ++at_;
    } else if (comments_ == Comments::cpp && text_.compare(at_, 2, "//") == 0) {
      at_ = std::min(text_.find('\n', at_), text_.size());
    } else if (comments_ == Comments::cpp && text_.compare(at_, 2, "/*") == 0) {
      const std::size_t end = text_.find("*/", at_ + 2);
      at_ = end == std::string::npos ? text_.size() : end + 2;
    } else {
      return;
    }
  }
}

bool MeshText::at_end() { return peek() == 0; }

char MeshText::peek() {
  skip_space();
  return at_ < text_.size() ? text_[at_] : '\0';
}

bool MeshText::take(char sign) {
  if (peek() != sign) return false;
  ++at_;
  return true;
}

void MeshText::expect(char sign) {
  if (!take(sign)) fail("{} where `{}` is expected", seen(), sign);
}

template <class Number>
Number MeshText::parse(const char* what) {
  skip_space();
  Number value{};
  const char* const begin = text_.data() + at_;
  const char* const end = text_.data() + text_.size();
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (error != std::errc() || (stop != end && !ends_word(*stop))) {
    fail("{} where {} is expected", seen(), what);
  }
  at_ += static_cast<std::size_t>(stop - begin);
  return value;
}

double MeshText::number() {
  const double value = parse<double>("a number");
  // Infinity and nan are numbers to from_chars.
  if (!(value - value == 0)) fail("{} where a finite number is expected", value);
  return value;
}
int MeshText::whole() { return parse<int>("a whole number"); }
long long MeshText::tag() { return parse<long long>("a whole number"); }

std::string MeshText::word() {
  skip_space();
  std::size_t end = at_;
  if (end < text_.size() && text_[end] == '"') {
    end = text_.find('"', at_ + 1);
    if (end == std::string::npos) fail("a text in quotes does not end");
    std::string quoted = text_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
    return quoted;
  }
  while (end < text_.size() && !ends_word(text_[end])) ++end;
  if (end == at_) fail("{} where a word is expected", seen());
  std::string found = text_.substr(at_, end - at_);
  at_ = end;
  return found;
}

std::string_view MeshText::rest_of_line() {
  const std::size_t begin = at_;
  const std::size_t end = std::min(text_.find('\n', at_), text_.size());
  at_ = std::min(end + 1, text_.size());
  std::string_view rest(text_.data() + begin, end - begin);
  while (!rest.empty() && is_space(rest.back())) rest.remove_suffix(1);
  return rest;
}

int MeshText::count(std::string_view of_what, std::size_t least_bytes) {
  const long long number = tag();
  if (number < 0 || number > std::numeric_limits<int>::max() ||
      static_cast<std::size_t>(number) > (text_.size() - at_) / least_bytes) {
    fail("{} {} are announced, more than the file holds; it is damaged or cut off", number,
         of_what);
  }
  return static_cast<int>(number);
}

int MeshText::line() const {
  const auto end = text_.begin() + static_cast<std::ptrdiff_t>(std::min(at_, text_.size()));
  return 1 + static_cast<int>(std::count(text_.begin(), end, '\n'));
}

std::string MeshText::seen() const {
  if (at_ >= text_.size()) return "the end of the file";
  std::size_t end = at_ + 1;
  while (end < text_.size() && !ends_word(text_[end]) && end - at_ < 30) ++end;
  return fmt::format("`{}`", text_.substr(at_, end - at_));
}

}  // namespace fluxpact
