#include "cfd_server/vans/regions.hpp"

#include <cmath>

#include "proto/base/compensated_sum.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {

FluidRegions find_regions(const Stencil& s, const BoundaryConditions& conditions) {
  FluidRegions regions;
  regions.of_cell.assign(static_cast<std::size_t>(s.cells), -1);
  std::vector<int> queue;
  for (int seed = 0; seed < s.cells; ++seed) {
    if (regions.of_cell[seed] >= 0) continue;
    const int number = static_cast<int>(regions.list.size());
    FluidRegion region;
    region.first_cell = seed;
    queue.assign(1, seed);
    regions.of_cell[seed] = number;
    for (std::size_t next = 0; next < queue.size(); ++next) {
      const int cell = queue[next];
      region.volume += s.volume[cell];
      for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
        const int other = s.side_other[side];
        if (other < 0) {
          const int b = s.side_face[side] - s.internal_faces;
          region.open = region.open || conditions.kind[b] == FaceKind::pressure;
        } else if (regions.of_cell[other] < 0) {
          regions.of_cell[other] = number;
          queue.push_back(other);
        }
      }
    }
    regions.list.push_back(region);
  }
  return regions;
}

namespace {

void settle(const Stencil& s, const FluidRegions& regions, int number,
            std::span<const double> boundary_flux, double density, double window, std::int64_t step,
            std::span<double> storage) {
  const FluidRegion& region = regions.list[number];
  CompensatedSum stored;
  CompensatedSum outflow;
  double largest_flow = density * region.volume / window;
  for (int cell = 0; cell < s.cells; ++cell) {
    if (regions.of_cell[cell] == number) stored.add(storage[cell]);
  }
  for (int b = 0; b < s.boundary_faces(); ++b) {
    if (regions.of_cell[s.owner[b + s.internal_faces]] != number) continue;
    outflow.add(density * boundary_flux[b]);
    largest_flow += std::abs(density * boundary_flux[b]);
  }
  const double imbalance = stored.value() + outflow.value();
  if (std::abs(imbalance) > 1e-12 * largest_flow) {
    const Vector3& at = s.centre[region.first_cell];
    throw NumericsError(
        "fluid, step {}: the region of {:.6g} m³ at ({:.6g}, {:.6g}, {:.6g}) has no pressure "
        "outlet, so what flows out must equal what "
        "the solids displace; but the fluid in it changes by {:.6g} kg/s and {:.6g} kg/s are "
        "prescribed to leave: {:.6g} kg/s have "
        "nowhere to go. Give it a patch of type pressure, balance its inlets, or keep the sum of "
        "the voidage constant",
        step, region.volume, at.x(), at.y(), at.z(), stored.value(), outflow.value(), imbalance);
  }
  for (int cell = 0; cell < s.cells; ++cell) {
    if (regions.of_cell[cell] == number)
      storage[cell] -= imbalance * (s.volume[cell] / region.volume);
  }
}

}  // namespace

void settle_closed_regions(const Stencil& s, const FluidRegions& regions,
                           std::span<const double> boundary_flux, double density, double window,
                           std::int64_t step, std::span<double> storage) {
  for (int number = 0; number < static_cast<int>(regions.list.size()); ++number) {
    if (!regions.list[number].open)
      settle(s, regions, number, boundary_flux, density, window, step, storage);
  }
}

}  // namespace fluxpact
