#include "proto/scene/size_law.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fluxpact {
namespace {

constexpr int steps = 4096;

/// Density by number or mass at a diameter, to a constant factor.
double density(const SizeSettings& sizes, double diameter) {
  const auto bell = [](double x) { return std::exp(-0.5 * x * x); };
  switch (sizes.distribution) {
    case SizeDistribution::normal:
      return bell((diameter / sizes.mean - 1) / sizes.deviation);
    case SizeDistribution::lognormal:
      return bell(std::log(diameter / sizes.mean) / sizes.deviation) / diameter;
    case SizeDistribution::uniform:
    case SizeDistribution::table:
      break;
  }
  return 1;
}

/// What makes a number of a weight: a sphere's share of the mass grows with its volume.
double per_number(const SizeSettings& sizes, double diameter) {
  return sizes.by == SizeWeight::mass ? 1 / sphere_volume(diameter) : 1.0;
}

/// Mean volume of spheres spread evenly between two diameters: the mean of d³ is that of its ends
/// and squares.
double mean_between(double low, double high) {
  return std::numbers::pi / 24 * (low + high) * (low * low + high * high);
}

}  // namespace

double sphere_volume(double diameter) {
  return std::numbers::pi / 6 * diameter * diameter * diameter;
}

SizeLaw::SizeLaw(double diameter, const std::optional<SizeSettings>& sizes) {
  std::vector<double> weights;  // of each diameter, or of each step but the first place
  if (!sizes) {
    diameters_ = {diameter};
    weights = {1};
  } else if (sizes->distribution == SizeDistribution::table) {
    for (const auto& [size, weight] : sizes->table) {
      diameters_.push_back(size);
      weights.push_back(weight * per_number(*sizes, size));
    }
  } else {
    steps_ = true;
    const auto [low, high] = sizes->range;
    diameters_.push_back(low);
    weights.push_back(0);
    for (int step = 1; step <= steps; ++step) {
      const double end = step == steps ? high : low + (high - low) * step / steps;
      const double middle = 0.5 * (diameters_.back() + end);
      diameters_.push_back(end);
      weights.push_back(density(*sizes, middle) * per_number(*sizes, middle));
    }
  }
  double sum = 0;
  double volume = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += weights[i];
    cumulative_.push_back(sum);
    if (weights[i] == 0) continue;
    volume += weights[i] * (steps_ ? mean_between(diameters_[i - 1], diameters_[i])
                                   : sphere_volume(diameters_[i]));
  }
  for (double& share : cumulative_) share /= sum;
  mean_volume_ = volume / sum;
}

double SizeLaw::quantile(double share) const {
  const auto above = std::upper_bound(cumulative_.begin(), cumulative_.end(), share);
  if (above == cumulative_.end()) return diameters_.back();
  const auto place = static_cast<std::size_t>(above - cumulative_.begin());
  if (!steps_ || place == 0) return diameters_[place];
  const double part =
      (share - cumulative_[place - 1]) / (cumulative_[place] - cumulative_[place - 1]);
  return diameters_[place - 1] + part * (diameters_[place] - diameters_[place - 1]);
}

}  // namespace fluxpact
