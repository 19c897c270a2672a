#include "dem_server/interphase/own_disturbance.hpp"

#include <algorithm>
#include <cstdint>

namespace fluxpact {

OwnDisturbance::OwnDisturbance(const Mesh& mesh)
    : offsets_(mesh.cell_face_offsets), volumes_(mesh.cell_volumes) {
  faces_.reserve(mesh.cell_faces.size());
  for (int cell = 0; cell < mesh.cells(); ++cell) {
    for (int k = offsets_[cell]; k < offsets_[cell + 1]; ++k) {
      const int face = mesh.cell_faces[k];
      const bool owns = mesh.owner[face] == cell;
      const Vector3 area = owns ? mesh.face_areas[face] : Vector3(-mesh.face_areas[face]);
      const bool inside = face < mesh.internal_faces();
      const Vector3 way = inside ? (owns ? mesh.delta[face] : Vector3(-mesh.delta[face]))
                                 : Vector3(2 * (mesh.face_centres[face] - mesh.cell_centres[cell]));
      const int other = !inside ? -1 : owns ? mesh.neighbour[face] : mesh.owner[face];
      faces_.push_back({other, area, area.squaredNorm() / area.dot(way)});
    }
  }
}

double OwnDisturbance::response(const ParticleCellWeights& weights, int particle,
                                const FluidProperties& fluid, std::span<const double> voidage,
                                const Vector3& slip) const {
  const auto first = weights.row_offsets[particle];
  const auto last = weights.row_offsets[particle + 1];
  const auto weight_at = [&](std::int64_t k) {
    return weights.whole ? 1.0 : weights.row_weights[k];
  };
  const auto given = [&](int cell) {  // d; a cell may stand twice in a row
    double sum = 0;
    for (auto k = first; k < last; ++k) {
      if (weights.row_cells[k] == cell) sum += weight_at(k);
    }
    return sum > 0 ? sum / (fluid.density * voidage[cell] * volumes_[cell]) : 0.0;
  };
  const double spreading = fluid.viscosity / fluid.density;
  double seen = 0;
  double lost = 0;
  for (auto k = first; k < last; ++k) {
    const int cell = weights.row_cells[k];
    const double here = given(cell);
    double rate = 0;
    for (int f = offsets_[cell]; f < offsets_[cell + 1]; ++f) {
      const CellFace& face = faces_[f];
      const double there = face.beyond < 0 ? 0 : given(face.beyond);
      const double swept = slip.dot(face.area);
      rate += std::max(swept, 0.0) * here - std::max(-swept, 0.0) * there +
              spreading * face.conductance * (here - there);
    }
    seen += weight_at(k) * here;
    lost += weight_at(k) / volumes_[cell] * rate;
  }
  constexpr double without_divergence = 2.0 / 3;
  return lost > 0 ? without_divergence * seen * seen / lost : 0;
}

bool OwnDisturbance::has_room(const ParticleCellWeights& weights, int particle,
                              double radius) const {
  const double edge = 2 * radius * narrowest * (1 - 1e-9);  // cells of just that size, rounded
  for (auto k = weights.row_offsets[particle]; k < weights.row_offsets[particle + 1]; ++k) {
    if (volumes_[weights.row_cells[k]] < edge * edge * edge) return false;
  }
  return true;
}

}  // namespace fluxpact
