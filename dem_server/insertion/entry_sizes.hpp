// How many spheres of which diameters an entry of particles.insertion asks for.
#pragma once

#include <string>
#include <vector>

#include "proto/scene/size_law.hpp"

namespace fluxpact {

/// Diameters [m] in the order in which they are placed, for a region of `volume` [m³]. `fraction`
/// is met to half a sphere. Reproducible from the entry's seed. Throws ConfigError that names the
/// `entry` if it asks for none, or more than an int counts.
std::vector<double> entry_diameters(const std::string& entry, const InsertionSettings& settings,
                                    double volume);

/// The same until their volume is `solids` [m³].
std::vector<double> diameters_of_volume(const std::string& entry, const InsertionSettings& settings,
                                        double solids);

}  // namespace fluxpact
