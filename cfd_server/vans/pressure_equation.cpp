#include "cfd_server/vans/pressure_equation.hpp"

namespace fluxpact {
namespace {

double scale_of(std::span<const double> face_scale, int face) {
  return face_scale.empty() ? 1.0 : face_scale[face];
}

}  // namespace

void assemble_pressure_matrix(const Stencil& s, const BoundaryConditions& conditions,
                              const FluidRegions& regions, const FaceCoefficients& c,
                              std::span<const double> face_scale, PressureMatrix& matrix) {
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int f = 0; f < s.internal_faces; ++f)
    matrix.coupling[f] = scale_of(face_scale, f) * c.mobility[f] * s.conductance[f];
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int cell = 0; cell < s.cells; ++cell) {
    double sum = 0;
    for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
      const int f = s.side_face[side];
      const bool fixed =
          f >= s.internal_faces && conditions.kind[f - s.internal_faces] != FaceKind::pressure;
      if (!fixed && s.side_other[side] != cell)
        sum += scale_of(face_scale, f) * c.mobility[f] * s.conductance[f];
    }
    matrix.diagonal[cell] = sum;
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
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int cell = 0; cell < s.cells; ++cell) {
    double sum = source[cell];
    for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
      const int f = s.side_face[side];
      double part = flux[f];
      if (f >= s.internal_faces)
        part -= c.mobility[f] * s.conductance[f] * values.pressure[f - s.internal_faces];
      sum -= s.side_sign[side] * scale_of(face_scale, f) * part;
    }
    rhs[cell] = sum;
  }
}

}  // namespace fluxpact
