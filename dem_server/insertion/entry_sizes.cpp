#include "dem_server/insertion/entry_sizes.hpp"

#include <cmath>

#include "dem_server/insertion/random.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

constexpr double most = 2e9;  // ids and rows are counted in ints

/// Another stream of random numbers than that of the places.
UniformRandom size_stream(const InsertionSettings& settings) {
  return UniformRandom(static_cast<std::uint64_t>(settings.seed) ^ 0x9e3779b97f4a7c15U);
}

void check_count(const std::string& entry, double count, double volume) {
  if (count >= 1 && count <= most) return;
  throw ConfigError(
      "{}: this makes {:.6g} spheres in {:.4g} m³; at least 1 and at most {:g} can be placed",
      entry, count, volume, most);
}

}  // namespace

std::vector<double> diameters_of_volume(const std::string& entry, const InsertionSettings& settings,
                                        double solids) {
  const SizeLaw sizes(settings.diameter, settings.sizes);
  check_count(entry, std::round(solids / sizes.mean_volume()), solids);
  UniformRandom random = size_stream(settings);
  std::vector<double> diameters;
  double sum = 0;
  while (true) {
    const double next = sizes.quantile(random.next());
    const double volume = sphere_volume(next);
    if (sum + 0.5 * volume > solids && !diameters.empty()) return diameters;
    sum += volume;
    diameters.push_back(next);
  }
}

std::vector<double> entry_diameters(const std::string& entry, const InsertionSettings& settings,
                                    double volume) {
  const SizeLaw sizes(settings.diameter, settings.sizes);
  if (!(sizes.smallest() > 0)) {
    throw ConfigError("{}: diameter is {} m; it must be positive", entry, sizes.smallest());
  }
  if (settings.fraction > 0) {
    return diameters_of_volume(entry, settings, settings.fraction * volume);
  }
  const double count = settings.number_density > 0 ? std::round(settings.number_density * volume)
                                                   : static_cast<double>(settings.count);
  check_count(entry, count, volume);
  UniformRandom random = size_stream(settings);
  std::vector<double> diameters(static_cast<std::size_t>(count));
  for (double& diameter : diameters) diameter = sizes.quantile(random.next());
  return diameters;
}

}  // namespace fluxpact
