// The connected parts of the mesh, and whether each can take up what the solids displace.
//
// Used before the pressure solve (a region without a pressure face has no solution unless its sums
// fit) and to fix the level of its pressure.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cfd_server/vans/boundary_conditions.hpp"

namespace fluxpact {

struct FluidRegion {
  double volume = 0;   ///< [m³]
  int first_cell = 0;  ///< lowest cell; its pressure is held where the region is closed
  bool open = false;   ///< has a pressure face
};

struct FluidRegions {
  std::vector<FluidRegion> list;
  std::vector<int> of_cell;
};

FluidRegions find_regions(const Stencil& stencil, const BoundaryConditions& conditions);

/// For regions without a pressure face: the sum of storage [kg/s, one a cell] and boundary flux
/// [m³/s] must vanish. What is left to rounding is spread over the cells by volume (storage is
/// changed), so that a solution exists exactly. Throws NumericsError with the imbalance and its
/// parts if it is more than rounding (1e-12 of ρV/Δt and the flows).
void settle_closed_regions(const Stencil& stencil, const FluidRegions& regions,
                           std::span<const double> boundary_flux, double density, double window,
                           std::int64_t step, std::span<double> storage);

}  // namespace fluxpact
