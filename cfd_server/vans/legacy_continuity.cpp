#include "cfd_server/vans/legacy_continuity.hpp"

#include <algorithm>

namespace fluxpact {

void legacy_face_voidage(const Stencil& s, std::span<const double> voidage,
                         std::span<double> face_voidage) {
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int f = 0; f < s.faces; ++f) {
    const double own = voidage[s.owner[f]];
    face_voidage[f] = f < s.internal_faces ? 0.5 * (own + voidage[s.neighbour[f]]) : own;
  }
}

void legacy_voidage_gradient(const Stencil& s, std::span<const double> face_voidage,
                             std::span<Vector3> gradient) {
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int cell = 0; cell < s.cells; ++cell) {
    Vector3 sum = Vector3::Zero();
    for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
      const int f = s.side_face[side];
      sum += s.side_sign[side] * face_voidage[f] * s.area[f];
    }
    gradient[cell] = sum / s.volume[cell];
  }
}

void legacy_source(const Stencil& s, std::span<const double> old_voidage,
                   std::span<const double> voidage, std::span<const Vector3> voidage_gradient,
                   std::span<const Vector3> velocity, double window, std::span<double> source) {
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int cell = 0; cell < s.cells; ++cell) {
    const double rate = (voidage[cell] - old_voidage[cell]) / window;
    source[cell] =
        -s.volume[cell] / voidage[cell] * (rate + velocity[cell].dot(voidage_gradient[cell]));
  }
}

}  // namespace fluxpact
