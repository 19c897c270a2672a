#include "dem_server/insertion/read_particles.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string_view>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

constexpr std::array<std::string_view, 7> column_names{"x", "y", "z", "vx", "vy", "vz", "diameter"};
constexpr std::size_t first_velocity = 3;
constexpr std::size_t diameter_column = 6;

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> cells;
  std::size_t begin = 0;
  for (std::size_t comma = line.find(','); comma != std::string_view::npos;
       comma = line.find(',', begin)) {
    cells.push_back(trimmed(line.substr(begin, comma - begin)));
    begin = comma + 1;
  }
  cells.push_back(trimmed(line.substr(begin)));
  return cells;
}

/// Which column of the file holds each of our columns; -1: none.
struct Header {
  std::array<int, 7> at{};
  std::size_t columns = 0;
};

Header read_header(std::string_view line, const std::string& path) {
  Header header;
  header.at.fill(-1);
  const std::vector<std::string_view> cells = split(line);
  header.columns = cells.size();
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const auto name = std::find(column_names.begin(), column_names.end(), cells[c]);
    if (name == column_names.end()) {
      throw ConfigError(
          "{}:1: column `{}` is not known; the header may name x, y, z, vx, vy, vz, diameter", path,
          cells[c]);
    }
    int& at = header.at[name - column_names.begin()];
    if (at >= 0) throw ConfigError("{}:1: column `{}` stands twice", path, cells[c]);
    at = static_cast<int>(c);
  }
  const auto given = [&](std::size_t column) { return header.at[column] >= 0; };
  if (!given(0) || !given(1) || !given(2)) {
    throw ConfigError("{}:1: the header must name x, y and z; it is `{}`", path, line);
  }
  if (given(first_velocity) != given(first_velocity + 1) ||
      given(first_velocity) != given(first_velocity + 2)) {
    throw ConfigError("{}:1: the header must name all of vx, vy and vz, or none", path);
  }
  return header;
}

double read_number(std::string_view text, const std::string& path, int line) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) {
    throw ConfigError("{}:{}: `{}` is not a finite number", path, line, text);
  }
  return value;
}

ListedParticle read_row(std::string_view text, const Header& header, const std::string& path,
                        int line) {
  const std::vector<std::string_view> cells = split(text);
  if (cells.size() != header.columns) {
    throw ConfigError("{}:{}: {} values under a header of {} columns", path, line, cells.size(),
                      header.columns);
  }
  const auto value = [&](std::size_t column) {
    return read_number(cells[header.at[column]], path, line);
  };
  ListedParticle particle;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    particle.position[a] = value(axis);
    if (header.at[first_velocity] >= 0) particle.velocity[a] = value(first_velocity + axis);
  }
  if (header.at[diameter_column] >= 0) {
    particle.diameter = value(diameter_column);
    if (*particle.diameter <= 0) {
      throw ConfigError("{}:{}: diameter {} m; it must be positive", path, line,
                        *particle.diameter);
    }
  }
  return particle;
}

}  // namespace

std::vector<ListedParticle> read_particles(const std::string& path) {
  std::ifstream file(path);
  std::string text;
  if (!file || !std::getline(file, text)) {
    throw ConfigError(
        "{}: cannot be read, or is empty; a CSV file with the header x,y,z[,vx,vy,vz][,diameter] "
        "is "
        "needed (the path is taken from the directory in which the program runs)",
        path);
  }
  const Header header = read_header(text, path);
  std::vector<ListedParticle> particles;
  for (int line = 2; std::getline(file, text); ++line) {
    if (!trimmed(text).empty()) particles.push_back(read_row(text, header, path, line));
  }
  if (file.bad()) throw ConfigError("{}: reading failed", path);
  return particles;
}

}  // namespace fluxpact
