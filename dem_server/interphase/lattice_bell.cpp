#include "dem_server/interphase/lattice_bell.hpp"

#include <algorithm>
#include <cmath>

namespace fluxpact {
namespace {

/// Pieces of one interval of a reach.
struct Pieces {
  int first = 0;
  int last = 0;
};

Pieces pieces_of(const BellRoom::Reach& reach, std::size_t interval) {
  return {interval == 0 ? 0 : reach.ends[interval - 1], reach.ends[interval]};
}

/// Adds to each piece along x what it has of the bell in all rows of a cell along y and z.
void add_rows(const BellRoom& room, const Pieces& y, const Pieces& z, std::vector<double>& sums) {
  const std::vector<double>& squares = room.reach[0].squares;
  std::fill(sums.begin(), sums.end(), 0.0);
  for (int k = z.first; k < z.last; ++k) {
    for (int j = y.first; j < y.last; ++j) {
      const double top = 1 - (room.reach[2].squares[k] + room.reach[1].squares[j]);
      if (top <= 0) continue;
      for (std::size_t i = 0; i < squares.size(); ++i) {
        const double height = std::max(0.0, top - squares[i]);
        sums[i] += height * height * height;
      }
    }
  }
}

}  // namespace

// Intervals are counted on beyond the ends of a periodic axis: interval n of the first image is
// interval 0 of the next.
bool LatticeBell::cut(const LatticeAxis& axis, double centre, double radius,
                      BellRoom::Reach& reach) {
  if (axis.interval(centre) < 0) return false;  // brings the centre into the period
  const int count = axis.last + 1;
  const auto interval_at = [&](double x) {
    if (x < axis.front && !axis.periodic) return 0;
    if (x >= axis.back && !axis.periodic) return axis.last;
    const int image = x < axis.front ? -count : x >= axis.back ? count : 0;
    const int i = axis.interval(x);
    return i < 0 ? 2 * count : i + image;
  };
  const int first = interval_at(centre - radius);
  const int last = interval_at(centre + radius);
  if (first >= count || last >= 2 * count) return false;
  reach.cells.clear();
  reach.ends.clear();
  reach.lengths.clear();
  reach.squares.clear();
  const double per_radius = 1 / radius;
  for (int i = first; i <= last; ++i) {
    const int image = i < 0 ? -1 : i / count;
    const int interval = i - image * count;
    const double start = axis.nodes[interval] + image * axis.period() - centre;
    const double length = axis.nodes[interval + 1] - axis.nodes[interval];
    const double parts = std::max(1.0, std::ceil(length / (0.5 * radius)));
    const double step = length / parts;
    for (double part = 0; part < parts; ++part) {
      const double offset = (start + (part + 0.5) * step) * per_radius;
      const double square = offset * offset;
      if (square < 1) reach.squares.push_back(square);
    }
    reach.cells.push_back(interval * axis.stride);
    reach.ends.push_back(static_cast<int>(reach.squares.size()));
    reach.lengths.push_back(step);
  }
  return true;
}

bool LatticeBell::append(const Ball& bell, BellRoom& room, std::vector<int>& cells,
                         std::vector<double>& integrals) const {
  for (int k = 0; k < 3; ++k) {
    if (!cut(axes_[k], bell.centre[k], bell.radius, room.reach[k])) return false;
  }
  const auto& [x, y, z] = room.reach;
  room.sums.resize(x.squares.size());
  for (std::size_t k = 0; k < z.cells.size(); ++k) {
    for (std::size_t j = 0; j < y.cells.size(); ++j) {
      add_rows(room, pieces_of(y, j), pieces_of(z, k), room.sums);
      for (std::size_t i = 0; i < x.cells.size(); ++i) {
        double sum = 0;
        const Pieces pieces = pieces_of(x, i);
        for (int p = pieces.first; p < pieces.last; ++p) sum += room.sums[p];
        if (!(sum > 0)) continue;
        cells.push_back(x.cells[i] + y.cells[j] + z.cells[k]);
        integrals.push_back(sum * x.lengths[i] * y.lengths[j] * z.lengths[k]);
      }
    }
  }
  return true;
}

}  // namespace fluxpact
