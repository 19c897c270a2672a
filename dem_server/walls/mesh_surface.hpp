// The boundary of a mesh as triangles.
#pragma once

#include <span>

#include "dem_server/backends/domain.hpp"
#include "proto/mesh/triangle_surface.hpp"

namespace fluxpact {

/// Triangles of boundary faces, pointing out of the mesh. A face is a fan about the first of its
/// points for which no part points inwards, or about the mean of them if there is none.
TriangleSurface triangles_of(const Mesh& mesh, std::span<const int> faces);

/// The surface continued through the periodic sides of the domain by half a period, so that a
/// sphere at such a side meets what lies beyond it.
TriangleSurface with_periodic_images(TriangleSurface surface, const Domain& domain);

}  // namespace fluxpact
