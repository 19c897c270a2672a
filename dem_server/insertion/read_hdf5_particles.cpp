// HDF5: columns x, y, z ... as beds are often kept, or the vectors of our own records.
#include <array>
#include <cmath>

#include "dem_server/insertion/particle_columns.hpp"
#include "proto/base/errors.hpp"
#include "proto/io/hdf5.hpp"

namespace fluxpact {
namespace {

struct Source {
  const Hdf5File& file;
  const std::string& path;
  std::string group;  // ends with /
};

/// The group given; else the top, or the last record of a results.h5.
std::string find_group(const Hdf5File& file, const std::string& path, const std::string& group) {
  if (!group.empty()) {
    const std::string name = (group.front() == '/' ? "" : "/") + group;
    if (!file.exists(name)) throw ConfigError("{}: there is no group {}", path, name);
    return name.back() == '/' ? name : name + "/";
  }
  if (!file.exists("/particles")) return "/";
  const std::vector<std::string> records = file.members("/particles");
  if (records.empty()) throw ConfigError("{}: /particles holds no record", path);
  return "/particles/" + records.back() + "/";
}

std::vector<double> numbers(const Source& from, const std::string& name, std::size_t count) {
  std::vector<double> values = from.file.read_doubles(from.group + name);
  if (values.size() != count) {
    throw ConfigError("{}: dataset {}{} has {} values where {} are expected", from.path, from.group,
                      name, values.size(), count);
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) continue;
    throw ConfigError("{}: dataset {}{}: value {} is {}", from.path, from.group, name, i,
                      values[i]);
  }
  return values;
}

/// A vector from one dataset of rows of 3, or three columns; false if there is neither.
bool read_vectors(const Source& from, const char* whole, std::array<const char*, 3> parts,
                  std::size_t count, std::vector<Vector3>& vectors) {
  if (from.file.exists(from.group + whole)) {
    const std::vector<double> values = numbers(from, whole, 3 * count);
    for (std::size_t i = 0; i < count; ++i) {
      vectors.emplace_back(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
    }
    return true;
  }
  if (!from.file.exists(from.group + parts[0])) return false;
  std::array<std::vector<double>, 3> columns;
  for (std::size_t axis = 0; axis < 3; ++axis) columns[axis] = numbers(from, parts[axis], count);
  for (std::size_t i = 0; i < count; ++i) {
    vectors.emplace_back(columns[0][i], columns[1][i], columns[2][i]);
  }
  return true;
}

std::vector<double> read_diameters(const Source& from, std::size_t count) {
  const bool radius = from.file.exists(from.group + "radius");
  const bool diameter = from.file.exists(from.group + "diameter");
  if (radius && diameter) {
    throw ConfigError("{}: {} holds both radius and diameter; keep one", from.path, from.group);
  }
  if (!radius && !diameter) return {};
  std::vector<double> values = numbers(from, radius ? "radius" : "diameter", count);
  for (double& value : values) {
    if (!(value > 0)) {
      throw ConfigError("{}: a {} in {} is {} m; it must be positive", from.path,
                        radius ? "radius" : "diameter", from.group, value);
    }
    if (radius) value *= 2;
  }
  return values;
}

}  // namespace

std::vector<ListedParticle> read_hdf5_particles(const std::string& path, const std::string& group) {
  const Hdf5File file = Hdf5File::open(path);
  const Source from{file, path, find_group(file, path, group)};
  std::size_t count = 0;
  if (file.exists(from.group + "position")) {
    count = file.shape(from.group + "position").front();
  } else if (file.exists(from.group + "x")) {
    count = file.shape(from.group + "x").front();
  } else {
    throw ConfigError(
        "{}: {} holds neither a dataset `position` nor `x`, `y` and `z`; name their group with "
        "`group`",
        path, from.group);
  }
  std::vector<Vector3> position;
  std::vector<Vector3> velocity;
  std::vector<Vector3> spin;
  read_vectors(from, "position", {"x", "y", "z"}, count, position);
  const bool moves = read_vectors(from, "velocity", {"vx", "vy", "vz"}, count, velocity);
  const bool spins = read_vectors(from, "spin", {"wx", "wy", "wz"}, count, spin);
  const std::vector<double> diameter = read_diameters(from, count);
  std::vector<ListedParticle> particles(count);
  for (std::size_t i = 0; i < count; ++i) {
    particles[i].position = position[i];
    if (moves) particles[i].velocity = velocity[i];
    if (spins) particles[i].spin = spin[i];
    if (!diameter.empty()) particles[i].diameter = diameter[i];
  }
  return particles;
}

}  // namespace fluxpact
