#include "proto/mesh/stl.hpp"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>

#include "proto/base/errors.hpp"
#include "proto/io/text_file.hpp"

namespace fluxpact {
namespace {

constexpr std::size_t header_size = 80;     // [bytes]
constexpr std::size_t first_triangle = 84;  // after the header and the count
constexpr std::size_t triangle_size = 50;   // normal, three corners, two unused bytes
static_assert(std::endian::native == std::endian::little, "binary STL is little-endian");

template <class T>
T value_at(std::string_view bytes, std::size_t place) {
  T value{};
  std::memcpy(&value, bytes.data() + place, sizeof(T));
  return value;
}

/// The number of triangles if the bytes are a binary file, else -1. A binary header may begin with
/// `solid`, too, so only the length tells.
std::int64_t binary_count(std::string_view bytes) {
  if (bytes.size() < first_triangle) return -1;
  const auto count = value_at<std::uint32_t>(bytes, header_size);
  return bytes.size() == first_triangle + triangle_size * count ? std::int64_t{count} : -1;
}

/// A file that is not as long as its count of triangles says would be read as text, of which a
/// binary file has bytes that no text has.
void refuse_cut_binary(std::string_view bytes, const std::string& path) {
  if (bytes.size() < first_triangle || bytes.find('\0') == std::string_view::npos) return;
  const std::size_t count = value_at<std::uint32_t>(bytes, header_size);
  throw ConfigError(
      "{}: neither an ascii STL file nor a whole binary one: its count of {} triangles makes {} "
      "bytes, but it has {}; copy or export it anew",
      path, count, first_triangle + triangle_size * count, bytes.size());
}

void add_triangle(TriangleSurface& surface) {
  const int last = static_cast<int>(surface.points.size());
  surface.triangles.push_back({last - 3, last - 2, last - 1});
}

TriangleSurface read_binary(std::string_view bytes, std::int64_t count, const std::string& path) {
  TriangleSurface surface;
  for (std::int64_t t = 0; t < count; ++t) {
    const std::size_t start = first_triangle + triangle_size * static_cast<std::size_t>(t);
    for (std::size_t corner = 0; corner < 3; ++corner) {
      Vector3 point;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        point[static_cast<Eigen::Index>(axis)] =
            value_at<float>(bytes, start + 4 * (3 + 3 * corner + axis));
      }
      if (!point.allFinite()) {
        throw ConfigError("{}: triangle {}: a corner is not finite; export the file anew", path,
                          t + 1);
      }
      surface.points.push_back(point);
    }
    add_triangle(surface);
  }
  return surface;
}

/// Words of a text with the line of the last one.
class Words {
 public:
  Words(std::string_view text, const std::string& path) : text_(text), path_(path) {}

  /// Empty at the end.
  std::string_view next() {
    while (at_ < text_.size() && is_blank(text_[at_])) line_ += text_[at_++] == '\n' ? 1 : 0;
    const std::size_t start = at_;
    while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
    return text_.substr(start, at_ - start);
  }
  void skip_line() {
    while (at_ < text_.size() && text_[at_] != '\n') ++at_;
  }
  void expect(std::string_view word) {
    const std::string_view found = next();
    if (!same(found, word)) {
      throw ConfigError("{}:{}: `{}` where `{}` is expected{}", path_, line_, found.substr(0, 40),
                        word, found.empty() ? "; the file ends too early" : "");
    }
  }
  double number() {
    std::string_view word = next();
    double value = std::numeric_limits<double>::quiet_NaN();
    if (word.starts_with('+')) word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    const bool tiny = error == std::errc::result_out_of_range && word.find('-') != word.npos;
    if (tiny && word.find("e-") != word.npos) return 0;  // 1e-320: some programs write such zeros
    if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value)) {
      throw ConfigError("{}:{}: `{}` is not a finite number{}", path_, line_, word.substr(0, 40),
                        word.empty() ? "; the file ends too early" : "");
    }
    return value;
  }
  int line() const { return line_; }

  static bool same(std::string_view word, std::string_view lower) {
    if (word.size() != lower.size()) return false;
    for (std::size_t i = 0; i < word.size(); ++i) {
      const char c = word[i];
      if ((c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c) != lower[i]) return false;
    }
    return true;
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

  std::string_view text_;
  const std::string& path_;
  std::size_t at_ = 0;
  int line_ = 1;
};

void read_facet(Words& words, TriangleSurface& surface) {
  words.expect("normal");
  for (int axis = 0; axis < 3; ++axis) words.next();  // not needed, and often wrong
  words.expect("outer");
  words.expect("loop");
  for (int corner = 0; corner < 3; ++corner) {
    words.expect("vertex");
    Vector3 point;
    for (int axis = 0; axis < 3; ++axis) point[axis] = words.number();
    surface.points.push_back(point);
  }
  words.expect("endloop");
  words.expect("endfacet");
  add_triangle(surface);
}

TriangleSurface read_ascii(std::string_view text, const std::string& path) {
  TriangleSurface surface;
  Words words(text, path);
  bool inside = false;
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    if (inside && Words::same(word, "facet")) {
      read_facet(words, surface);
    } else if (Words::same(word, inside ? "endsolid" : "solid")) {
      inside = !inside;
      words.skip_line();  // the name
    } else {
      throw ConfigError("{}:{}: `{}` where `{}` is expected; is this an STL file?", path,
                        words.line(), word.substr(0, 40), inside ? "facet` or `endsolid" : "solid");
    }
  }
  if (inside) throw ConfigError("{}:{}: `endsolid` is missing", path, words.line());
  return surface;
}

/// A direction needs an area: no more than rounding of the coordinates is none.
void refuse_slivers(const TriangleSurface& surface, double tolerance, const std::string& path) {
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto& [i, j, k] = surface.triangles[t];
    const Vector3& a = surface.points[i];
    const Vector3& b = surface.points[j];
    const Vector3& c = surface.points[k];
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    if ((b - a).cross(c - a).norm() > tolerance * longest) continue;
    throw ConfigError(
        "{}: triangle {} near ({:.6g}, {:.6g}, {:.6g}) m has its corners on one line, so it has no "
        "normal; mend the surface (remesh it, or remove such triangles with admesh or meshlab)",
        path, surface.number[t], a.x(), a.y(), a.z());
  }
}

}  // namespace

TriangleSurface read_stl(const std::filesystem::path& path, double scale) {
  const std::string name = path.string();
  if (!std::filesystem::is_regular_file(path)) {
    throw ConfigError("{}: no such file; a relative path starts at the scene's folder", name);
  }
  const std::string bytes = read_file(path);
  const std::int64_t count = binary_count(bytes);
  if (count < 0) refuse_cut_binary(bytes, name);
  TriangleSurface surface = count >= 0 ? read_binary(bytes, count, name) : read_ascii(bytes, name);
  if (surface.triangles.empty()) throw ConfigError("{}: no triangle in it", name);
  double largest = 0;
  for (Vector3& point : surface.points) {
    point *= scale;
    largest = std::max(largest, point.cwiseAbs().maxCoeff());
  }
  const double tolerance = 1e-6 * largest;
  if (largest > 0) surface = with_merged_points(surface, tolerance);
  if (largest == 0 || surface.triangles.empty()) {
    throw ConfigError("{}: all its triangles are smaller than single precision can tell", name);
  }
  refuse_slivers(surface, tolerance, name);
  return surface;
}

}  // namespace fluxpact
