#include "dem_server/insertion/particle_columns.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

enum Column { x = 0, vx = 3, wx = 6, radius = 9, diameter = 10 };

/// Names of each column; the first is ours.
constexpr std::array<std::array<std::string_view, 2>, 12> names_of{{{"x", "xu"},
                                                                    {"y", "yu"},
                                                                    {"z", "zu"},
                                                                    {"vx", "vx"},
                                                                    {"vy", "vy"},
                                                                    {"vz", "vz"},
                                                                    {"wx", "omegax"},
                                                                    {"wy", "omegay"},
                                                                    {"wz", "omegaz"},
                                                                    {"radius", "radius"},
                                                                    {"diameter", "diameter"},
                                                                    {"id", "id"}}};

}  // namespace

double read_number(const TextLine& line, const TextCell& cell) {
  double value = 0;
  const char* const last = cell.text.data() + cell.text.size();
  const auto [end, error] = std::from_chars(cell.text.data(), last, value);
  if (error != std::errc{} || end != last || !std::isfinite(value)) {
    throw ConfigError("{}:{}:{}: `{}` is not a finite number", line.path, line.number, cell.column,
                      cell.text);
  }
  return value;
}

ParticleColumns::ParticleColumns(const TextLine& line, const std::vector<TextCell>& names,
                                 bool skip_others)
    : width_(names.size()) {
  at_.fill(-1);
  for (std::size_t c = 0; c < names.size(); ++c) {
    const auto found = std::find_if(names_of.begin(), names_of.end(), [&](const auto& known) {
      return known[0] == names[c].text || known[1] == names[c].text;
    });
    const bool known = found != names_of.end() && (skip_others || found->front() == names[c].text);
    if (!known && skip_others) continue;
    if (!known || (*found)[0] == "id") {
      if (known && skip_others) {
        at_[id_column] = static_cast<int>(c);
        continue;
      }
      throw ConfigError(
          "{}:{}:{}: column `{}` is not known; the header may name x, y, z, vx, vy, vz, wx, wy, "
          "wz, "
          "radius, diameter",
          line.path, line.number, names[c].column, names[c].text);
    }
    int& at = at_.at(static_cast<std::size_t>(found - names_of.begin()));
    if (at >= 0) {
      throw ConfigError("{}:{}:{}: column `{}` stands twice", line.path, line.number,
                        names[c].column, names[c].text);
    }
    at = static_cast<int>(c);
  }
  const auto given = [&](std::size_t column) { return at_.at(column) >= 0; };
  if (!given(x) || !given(x + 1) || !given(x + 2)) {
    throw ConfigError("{}:{}: the columns must name x, y and z", line.path, line.number);
  }
  for (const std::size_t first : {vx, wx}) {
    if (given(first) == given(first + 1) && given(first) == given(first + 2)) continue;
    throw ConfigError("{}:{}: the header must name all of {}, {} and {}, or none", line.path,
                      line.number, names_of.at(first)[0], names_of.at(first + 1)[0],
                      names_of.at(first + 2)[0]);
  }
  if (given(radius) && given(diameter)) {
    throw ConfigError("{}:{}: radius and diameter both have a column; keep one", line.path,
                      line.number);
  }
}

ListedParticle ParticleColumns::read(const TextLine& line,
                                     const std::vector<TextCell>& cells) const {
  if (cells.size() != width_) {
    throw ConfigError("{}:{}: {} values under a header of {} columns", line.path, line.number,
                      cells.size(), width_);
  }
  const auto vector = [&](std::size_t first, Vector3& value) {
    if (at_.at(first) < 0) return;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      value[static_cast<Eigen::Index>(axis)] = read_number(line, cells[at_.at(first + axis)]);
    }
  };
  ListedParticle particle;
  vector(x, particle.position);
  vector(vx, particle.velocity);
  vector(wx, particle.spin);
  for (const std::size_t column : {radius, diameter}) {
    if (at_.at(column) < 0) continue;
    const TextCell& cell = cells[at_.at(column)];
    const double value = read_number(line, cell);
    if (value <= 0) {
      throw ConfigError("{}:{}:{}: {} {} m; it must be positive", line.path, line.number,
                        cell.column, names_of.at(column)[0], value);
    }
    particle.diameter = column == radius ? 2 * value : value;
  }
  return particle;
}

}  // namespace fluxpact
