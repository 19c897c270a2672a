#include "dem_server/backends/engine_state.hpp"

#include <algorithm>
#include <cmath>

#include "dem_server/backends/particle_rows.hpp"

namespace fluxpact {
namespace {

constexpr double largest_whole = 0x1p53;  // beyond it doubles skip whole numbers

template <class T>
void store_as_doubles(const std::vector<T>& values, std::vector<double>& stored) {
  stored.reserve(values.size());
  for (const T value : values) stored.push_back(static_cast<double>(value));
}

}  // namespace

std::vector<double>& EngineState::add_scalars(std::string name) {
  return scalars_.emplace_back(Named<double>{std::move(name), {}}).values;
}

std::vector<Vector3>& EngineState::add_vectors(std::string name) {
  return vectors_.emplace_back(Named<Vector3>{std::move(name), {}}).values;
}

Fields EngineState::fields() const {
  Fields fields;
  for (const auto& array : scalars_) fields.add(array.name, std::span<const double>(array.values));
  for (const auto& array : vectors_) fields.add(array.name, std::span<const Vector3>(array.values));
  for (const auto& [name, value] : numbers_) fields.add_number(name, value);
  return fields;
}

StateReader::StateReader(const Fields& fields, const std::string& kind, int version)
    : fields_(fields) {
  if (!fields.numbers().contains(kind)) {
    throw ConfigError(
        "the stored state has no number `{}`: it is of another particle engine; restore it into "
        "the engine that stored it",
        kind);
  }
  if (number(kind) != version) {
    throw ConfigError(
        "the stored state has the form {} of `{}`, and this program reads {}; restore it with the "
        "version of the program that stored it",
        number(kind), kind, version);
  }
}

double StateReader::number(std::string_view name) const {
  const auto found = fields_.numbers().find(std::string(name));
  if (found == fields_.numbers().end()) {
    throw ConfigError("the stored state has no number `{}`: it is not whole", name);
  }
  return found->second;
}

int StateReader::count(std::string_view name, double end) const {
  return static_cast<int>(whole(name, 0, number(name), end));
}

void StateReader::require(std::string_view name, double own, std::string_view what) const {
  if (number(name) == own) return;
  throw ConfigError(
      "the stored state is of another scene: its {} (`{}`) is {}, and {} here; restore it with the "
      "scene that it was stored with",
      what, name, number(name), own);
}

const FieldView& StateReader::find(std::string_view name, int components, std::size_t rows) const {
  const auto found = std::ranges::find(fields_.views(), name, &FieldView::name);
  if (found == fields_.views().end()) {
    throw ConfigError("the stored state has no array `{}`: it is not whole", name);
  }
  if (found->components != components ||
      found->values.size() != static_cast<std::size_t>(components) * rows) {
    throw ConfigError(
        "the stored state's array `{}` has {} numbers in rows of {}, where {} rows of {} belong: "
        "it is not whole, or of another scene",
        name, found->values.size(), found->components, rows, components);
  }
  return *found;
}

std::span<const double> StateReader::scalars(std::string_view name, std::size_t rows) const {
  return find(name, 1, rows).values;
}

std::span<const Vector3> StateReader::vectors(std::string_view name, std::size_t rows) const {
  return as_vectors(find(name, 3, rows).values);
}

double StateReader::whole(std::string_view name, std::size_t row, double value, double end) {
  if (value >= 0 && value < end && value == std::floor(value)) return value;
  throw ConfigError(
      "the stored state's `{}` has {} in row {}, where a whole number from 0 to below {} belongs: "
      "it is damaged, or of another scene",
      name, value, row, end);
}

void store_rows(const ParticleState& particles, EngineState& state) {
  state.add_number("particles", particles.size());
  store_as_doubles(particles.id, state.add_scalars("id"));
  state.add_scalars("radius") = particles.radius;
  state.add_scalars("density") = particles.density;
  store_as_doubles(particles.material, state.add_scalars("material"));
  std::vector<double>& fixed = state.add_scalars("fixed");
  for (int row = 0; row < particles.size(); ++row) fixed.push_back(particles.is_fixed(row) ? 1 : 0);
}

ParticleState restored_rows(const StateReader& state, int materials, const ParticleState& own,
                            bool flow) {
  const auto rows = static_cast<std::size_t>(state.count("particles", 0x1p31));
  ParticleState stored;
  stored.id = state.wholes<std::int64_t>("id", rows, largest_whole);
  if (!flow && stored.id != own.id) {
    throw ConfigError(
        "the stored state is of another scene: it has {} particles, and the scene, through whose "
        "boundaries none come or go, has {} (or others); restore it with the scene that it was "
        "stored with",
        rows, own.size());
  }
  const auto assign = [](std::span<const double> values, std::vector<double>& to) {
    to.assign(values.begin(), values.end());
  };
  assign(state.scalars("radius", rows), stored.radius);
  assign(state.scalars("density", rows), stored.density);
  stored.material = state.wholes<int>("material", rows, materials);
  stored.fixed = state.wholes<std::uint8_t>("fixed", rows, 2);
  if (std::ranges::count(stored.fixed, 1) == 0) stored.fixed.clear();
  stored.position.assign(rows, Vector3::Zero());
  stored.velocity = stored.spin = stored.position;
  if (!std::ranges::is_sorted(stored.id)) {
    throw ConfigError("the stored state's array `id` does not ascend: it is damaged");
  }
  return checked_rows(std::move(stored), materials);
}

}  // namespace fluxpact
