#include "dem_server/interphase/diffusion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fluxpact {
namespace {

// Time of diffusion at unit diffusivity over the squared width of half height of a Gaussian:
// variance 2 T = w²/(8 ln 2).
constexpr double time_per_width_squared = 1 / (16 * std::numbers::ln2);

// Largest mean rate of exchange of a cell, times the length of one step.
constexpr double step_limit = 2;

// Exchanges of one colour, on average: below it threads wait for each other longer than they work.
constexpr std::size_t enough_for_threads = 20000;

// The lowest colour that no other face of the two cells has.
std::vector<int> face_colours(const Mesh& mesh) {
  std::vector<int> colour(static_cast<std::size_t>(mesh.internal_faces()), -1);
  std::vector<char> taken;
  for (int face = 0; face < mesh.internal_faces(); ++face) {
    taken.clear();
    for (const int cell : {mesh.owner[face], mesh.neighbour[face]}) {
      for (int k = mesh.cell_face_offsets[cell]; k < mesh.cell_face_offsets[cell + 1]; ++k) {
        const int other = mesh.cell_faces[k];
        if (other >= mesh.internal_faces() || colour[other] < 0) continue;
        if (taken.size() <= static_cast<std::size_t>(colour[other])) {
          taken.resize(static_cast<std::size_t>(colour[other]) + 1, 0);
        }
        taken[colour[other]] = 1;
      }
    }
    colour[face] = static_cast<int>(std::ranges::find(taken, 0) - taken.begin());
  }
  return colour;
}

}  // namespace

CellDiffusion::CellDiffusion(const Mesh& mesh, double width, int threads) : threads_(threads) {
  const double time = time_per_width_squared * width * width;
  const auto conductance = [&](int face) {
    const double area = mesh.face_areas[face].squaredNorm();
    return area / mesh.face_areas[face].dot(mesh.delta[face]);
  };
  double rate = 0;  // of all cells, by volume [m³/s]
  double volume = 0;
  for (const double cell : mesh.cell_volumes) volume += cell;
  for (int face = 0; face < mesh.internal_faces(); ++face) rate += 2 * conductance(face);
  steps_ = std::max(1, static_cast<int>(std::ceil(time * rate / volume / step_limit)));

  const std::vector<int> colour = face_colours(mesh);
  const int colours = colour.empty() ? 0 : std::ranges::max(colour) + 1;
  colours_.assign(static_cast<std::size_t>(colours) + 1, 0);
  for (const int c : colour) ++colours_[static_cast<std::size_t>(c) + 1];
  for (int c = 0; c < colours; ++c) colours_[c + 1] += colours_[c];
  exchanges_.resize(colour.size());
  std::vector<std::size_t> next(colours_.begin(), colours_.end());
  for (int face = 0; face < mesh.internal_faces(); ++face) {
    const int a = mesh.owner[face];
    const int b = mesh.neighbour[face];
    const double va = mesh.cell_volumes[a];
    const double vb = mesh.cell_volumes[b];
    // Half a step forwards, half a step backwards.
    const double decay = 0.5 * time / steps_ * conductance(face) * (1 / va + 1 / vb);
    const double done = a == b ? 0.0 : -std::expm1(-decay);  // a cell may be its own neighbour
    exchanges_[next[colour[face]]++] = {a, b, done * (vb / (va + vb)), done * (va / (va + vb))};
  }
}

template <class Apply>
void CellDiffusion::each_step(const Apply& apply) const {
  const int colours = static_cast<int>(colours_.size()) - 1;
  const bool worthwhile = exchanges_.size() > enough_for_threads * colours_.size();
#pragma omp parallel num_threads(threads_) if (worthwhile)
  for (int sweep = 0; sweep < 2 * steps_; ++sweep) {
    for (int turn = 0; turn < colours; ++turn) {
      const int colour = sweep % 2 == 0 ? turn : colours - 1 - turn;
      const std::size_t last = colours_[colour + 1];
#pragma omp for schedule(static)
      for (std::size_t k = colours_[colour]; k < last; ++k) apply(exchanges_[k]);
    }
  }
}

void CellDiffusion::spread(std::span<double> amounts) const {
  each_step([&](const Exchange& x) {
    const double moved = x.share_a * amounts[x.a] - x.share_b * amounts[x.b];
    amounts[x.a] -= moved;
    amounts[x.b] += moved;
  });
}

void CellDiffusion::spread(std::span<Vector3> amounts) const {
  each_step([&](const Exchange& x) {
    const Vector3 moved = x.share_a * amounts[x.a] - x.share_b * amounts[x.b];
    amounts[x.a] -= moved;
    amounts[x.b] += moved;
  });
}

void CellDiffusion::average(std::span<double> field) const {
  each_step([&](const Exchange& x) {
    const double difference = field[x.a] - field[x.b];
    field[x.a] -= x.share_a * difference;
    field[x.b] += x.share_b * difference;
  });
}

void CellDiffusion::average(std::span<Vector3> field) const {
  each_step([&](const Exchange& x) {
    const Vector3 difference = field[x.a] - field[x.b];
    field[x.a] -= x.share_a * difference;
    field[x.b] += x.share_b * difference;
  });
}

}  // namespace fluxpact
