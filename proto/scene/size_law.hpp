// The diameters of spheres as a scene spreads them: how many particles a mass or a volume makes,
// and the draw of each. Behind the insertion of the particle side and the coordinator's `check`.
#pragma once

#include <optional>
#include <vector>

#include "proto/scene/scene.hpp"

namespace fluxpact {

/// A distribution of diameters by number. Densities (uniform, normal, lognormal) are held as 4096
/// equal steps of constant density between the ends of their range, which is off by less than 1e-6
/// of the number anywhere.
class SizeLaw {
 public:
  /// One diameter [m], or a distribution, which wins.
  SizeLaw(double diameter, const std::optional<SizeSettings>& sizes);

  double smallest() const { return diameters_.front(); }  ///< [m]
  double largest() const { return diameters_.back(); }    ///< [m]

  /// Mean volume of a sphere, by number [m³].
  double mean_volume() const { return mean_volume_; }

  /// The diameter [m] below which the share `share` in [0, 1) of the spheres lies.
  double quantile(double share) const;

 private:
  std::vector<double> diameters_;   ///< [m] of a table, or the ends of the steps
  std::vector<double> cumulative_;  ///< share by number up to that diameter
  bool steps_ = false;              ///< densities between the diameters, not at them
  double mean_volume_ = 0;          ///< [m³]
};

/// π/6 d³.
double sphere_volume(double diameter);

}  // namespace fluxpact
