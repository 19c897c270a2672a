// Where the nodes of an axis lie whose cells grow or shrink. Used by boxes.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "proto/scene/scene.hpp"

namespace fluxpact {

/// The nodes of an axis with `cells` cells as shares of its length: cells + 1 entries from 0 to 1
/// [-]. In each part the cells form a geometric series, as in blockMesh of OpenFOAM
/// (multi-grading). No parts: equal cells. Throws ConfigError that names `key` if a part is left
/// without a cell, or has a ratio other than 1 but one cell only.
std::vector<double> node_shares(int cells, std::span<const GradingSettings> parts,
                                std::string_view key);

}  // namespace fluxpact
