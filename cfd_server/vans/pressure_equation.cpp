#include "cfd_server/vans/pressure_equation.hpp"

#include <algorithm>

namespace fluxpact {

void assemble_pressure_matrix(const Stencil& s, const BoundaryConditions& conditions,
                              const FluidRegions& regions, const FaceCoefficients& c,
                              std::span<const double> face_scale, PressureMatrix& matrix) {
  std::ranges::fill(matrix.diagonal, 0.0);
  for (int f = 0; f < s.internal_faces; ++f) {
    const double coupling = face_scale[f] * c.mobility[f] * s.conductance[f];
    matrix.coupling[f] = coupling;
    if (s.owner[f] == s.neighbour[f]) continue;
    matrix.diagonal[s.owner[f]] += coupling;
    matrix.diagonal[s.neighbour[f]] += coupling;
  }
  for (int f = s.internal_faces; f < s.faces; ++f) {
    if (conditions.kind[f - s.internal_faces] != FaceKind::pressure) continue;
    matrix.diagonal[s.owner[f]] += face_scale[f] * c.mobility[f] * s.conductance[f];
  }
  for (const FluidRegion& region : regions.list) {
    if (region.open) continue;
    // Only differences of pressure matter in a closed region: its first cell is tied to zero. The
    // sums have been made to fit, so the tie carries no flux.
    double& diagonal = matrix.diagonal[region.first_cell];
    diagonal = diagonal > 0 ? 2 * diagonal : 1.0;
  }
}

void assemble_pressure_rhs(const Stencil& s, const BoundaryValues& values,
                           const FaceCoefficients& c, std::span<const double> face_scale,
                           std::span<const double> source, std::span<const double> flux,
                           std::span<double> rhs) {
  std::ranges::copy(source, rhs.begin());
  for (int f = 0; f < s.internal_faces; ++f) {
    const double part = face_scale[f] * flux[f];
    rhs[s.owner[f]] -= part;
    rhs[s.neighbour[f]] += part;
  }
  for (int f = s.internal_faces; f < s.faces; ++f) {
    const double through_pressure =
        c.mobility[f] * s.conductance[f] * values.pressure[f - s.internal_faces];
    rhs[s.owner[f]] -= face_scale[f] * (flux[f] - through_pressure);
  }
}

}  // namespace fluxpact
