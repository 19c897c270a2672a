// Two patches a translation apart -> one layer of internal faces, as mesh.hpp says of periodic
// pairs.
#pragma once

#include <string>

#include "proto/mesh/mesh.hpp"

namespace fluxpact {

/// Join the faces of two patches that are copies of each other but for one translation. The faces
/// of `first` stay, as internal faces; those of `second` go, and their points are moved onto the
/// exact images of their partners (files carry few digits). `tolerance`: largest distance of a
/// point from the image of its partner, in units of the face's size (square root of its area).
/// Throws ConfigError that names the patches if one is missing, their numbers of faces differ, or a
/// face has no partner.
MeshTopology join_periodic(MeshTopology mesh, const std::string& first, const std::string& second,
                           double tolerance);

}  // namespace fluxpact
