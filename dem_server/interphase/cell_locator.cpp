#include "dem_server/interphase/cell_locator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fluxpact {
namespace {

bool touch(const Bounds& a, const Bounds& b) {
  return (a.lower.array() <= b.upper.array()).all() && (b.lower.array() <= a.upper.array()).all();
}

Bounds bounds_of(const Ball& ball) {
  return {ball.centre.array() - ball.radius, ball.centre.array() + ball.radius};
}

}  // namespace

CellLocator::CellLocator(const Mesh& mesh, const CellShapes& shapes) : shapes_(shapes) {
  shortest_period_ = std::numeric_limits<double>::infinity();
  for (const Vector3& translation : mesh.translations) {
    shortest_period_ = std::min(shortest_period_, translation.norm());
  }
  if (shapes_.lattice()) return;
  collect_images(mesh);
  fill_bins();
}

int CellLocator::cell_of(const Vector3& point) const {
  if (!point.allFinite()) return -1;
  return shapes_.lattice() ? cell_of_lattice(point) : cell_of_bins(point);
}

void CellLocator::touching(const Ball& ball, std::vector<CellImage>& out) const {
  if (shapes_.lattice()) {
    touching_lattice(ball, out);
  } else {
    touching_bins(ball, out);
  }
}

// ---- lattice ------------------------------------------------------------------------------------

// The interval of the nodes that holds the value, the first or last one if none does. The guess is
// right for equal cells; from there it is a short walk.
int CellLocator::lattice_position(int axis, double value) const {
  const auto& nodes = shapes_.lattice()->nodes[axis];
  const int last = static_cast<int>(nodes.size()) - 2;
  const double share = (value - nodes.front()) / (nodes.back() - nodes.front());
  int i = static_cast<int>(std::clamp(share, 0.0, 1.0) * (last + 1));
  i = std::min(i, last);
  while (i < last && value >= nodes[i + 1]) ++i;
  while (i > 0 && value < nodes[i]) --i;
  return i;
}

double CellLocator::wrap(int axis, double value) const {
  if (!shapes_.lattice()->periodic[axis]) return value;
  const auto& nodes = shapes_.lattice()->nodes[axis];
  const double period = nodes.back() - nodes.front();
  const double wrapped = value - period * std::floor((value - nodes.front()) / period);
  return std::min(wrapped, nodes.back());
}

int CellLocator::cell_of_lattice(const Vector3& point) const {
  Index index{};
  Index size{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto& nodes = shapes_.lattice()->nodes[axis];
    const double value = wrap(axis, point[axis]);
    if (value < nodes.front() || value > nodes.back()) return -1;
    index[axis] = lattice_position(axis, value);
    size[axis] = static_cast<int>(nodes.size()) - 1;
  }
  return index[0] + size[0] * (index[1] + size[1] * index[2]);
}

// Along each axis the ball reaches the intervals first..last, counted on beyond the ends of a
// periodic axis: interval n of the first image is interval 0 of the next.
void CellLocator::touching_lattice(const Ball& ball, std::vector<CellImage>& out) const {
  Index first{};
  Index last{};
  Index size{};
  Vector3 centre = ball.centre;
  Vector3 period = Vector3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const auto& nodes = shapes_.lattice()->nodes[axis];
    size[axis] = static_cast<int>(nodes.size()) - 1;
    period[axis] = nodes.back() - nodes.front();
    centre[axis] = wrap(axis, ball.centre[axis]);
    const bool periodic = shapes_.lattice()->periodic[axis];
    const double low = centre[axis] - ball.radius;
    const double high = centre[axis] + ball.radius;
    const bool before = periodic && low < nodes.front();
    const bool after = periodic && high > nodes.back();
    first[axis] = before ? lattice_position(axis, low + period[axis]) - size[axis]
                         : lattice_position(axis, low);
    last[axis] = after ? lattice_position(axis, high - period[axis]) + size[axis]
                       : lattice_position(axis, high);
  }
  const auto place = [&](int axis, int counted, Vector3& seen) {
    const int image = counted < 0 ? -1 : counted / size[axis];
    seen[axis] = centre[axis] - image * period[axis];
    return counted - image * size[axis];
  };
  CellImage hit;
  for (int k = first[2]; k <= last[2]; ++k) {
    const int ck = place(2, k, hit.point);
    for (int j = first[1]; j <= last[1]; ++j) {
      const int cj = place(1, j, hit.point);
      for (int i = first[0]; i <= last[0]; ++i) {
        hit.cell = place(0, i, hit.point) + size[0] * (cj + size[1] * ck);
        out.push_back(hit);
      }
    }
  }
}

// ---- any mesh -----------------------------------------------------------------------------------

// All sums of -1, 0 or 1 times each independent translation.
void CellLocator::collect_images(const Mesh& mesh) {
  std::vector<Vector3> periods;
  for (const Vector3& translation : mesh.translations) {
    const double tolerance = 1e-9 * translation.norm();
    const bool known = std::ranges::any_of(periods, [&](const Vector3& period) {
      return (period - translation).norm() <= tolerance ||
             (period + translation).norm() <= tolerance;
    });
    if (!known) periods.push_back(translation);
  }
  images_.assign(1, Vector3::Zero());
  for (const Vector3& period : periods) {
    const std::size_t before = images_.size();
    for (std::size_t k = 0; k < before; ++k) {
      images_.emplace_back(images_[k] - period);
      images_.emplace_back(images_[k] + period);
    }
  }
}

void CellLocator::fill_bins() {
  const int cells = shapes_.cells();
  domain_ = shapes_.bounds(0);
  for (int cell = 1; cell < cells; ++cell) {
    const Bounds box = shapes_.bounds(cell);
    domain_.lower = domain_.lower.cwiseMin(box.lower);
    domain_.upper = domain_.upper.cwiseMax(box.upper);
  }
  const Vector3 extent = domain_.upper - domain_.lower;
  const double edge = std::cbrt(extent.prod() / cells);  // about one cell a bin
  for (int axis = 0; axis < 3; ++axis) {
    bins_[axis] = std::clamp(static_cast<int>(extent[axis] / edge), 1, cells);
  }
  first_bin_.resize(static_cast<std::size_t>(cells));
  bin_offsets_.assign(static_cast<std::size_t>(bins_[0]) * bins_[1] * bins_[2] + 1, 0);
  const auto each_bin = [&](int cell, auto&& use) {
    const Index first = bin_of(shapes_.bounds(cell).lower);
    const Index last = bin_of(shapes_.bounds(cell).upper);
    for (int k = first[2]; k <= last[2]; ++k) {
      for (int j = first[1]; j <= last[1]; ++j) {
        for (int i = first[0]; i <= last[0]; ++i) use(bin_number({i, j, k}));
      }
    }
    first_bin_[cell] = first;
  };
  for (int cell = 0; cell < cells; ++cell) {
    each_bin(cell, [&](int bin) { ++bin_offsets_[bin + 1]; });
  }
  for (std::size_t bin = 1; bin < bin_offsets_.size(); ++bin) {
    bin_offsets_[bin] += bin_offsets_[bin - 1];
  }
  bin_cells_.resize(static_cast<std::size_t>(bin_offsets_.back()));
  std::vector<int> next(bin_offsets_.begin(), bin_offsets_.end() - 1);
  for (int cell = 0; cell < cells; ++cell) {
    each_bin(cell, [&](int bin) { bin_cells_[next[bin]++] = cell; });
  }
}

CellLocator::Index CellLocator::bin_of(const Vector3& point) const {
  Index bin{};
  for (int axis = 0; axis < 3; ++axis) {
    const double share =
        (point[axis] - domain_.lower[axis]) / (domain_.upper[axis] - domain_.lower[axis]);
    bin[axis] =
        std::min(static_cast<int>(std::clamp(share, 0.0, 1.0) * bins_[axis]), bins_[axis] - 1);
  }
  return bin;
}

int CellLocator::cell_of_bins(const Vector3& point) const {
  for (const Vector3& image : images_) {
    const Vector3 seen = point + image;
    const int bin = bin_number(bin_of(seen));
    for (int k = bin_offsets_[bin]; k < bin_offsets_[bin + 1]; ++k) {
      if (shapes_.contains(bin_cells_[k], seen)) return bin_cells_[k];
    }
  }
  return -1;
}

// A cell stands in every bin that it touches; it is taken in the first one that the ball touches
// too.
void CellLocator::touching_bins(const Ball& ball, std::vector<CellImage>& out) const {
  for (const Vector3& image : images_) {
    const Ball seen{ball.centre + image, ball.radius};
    const Bounds box = bounds_of(seen);
    if (!touch(box, domain_)) continue;
    const Index first = bin_of(box.lower);
    const Index last = bin_of(box.upper);
    for (int k = first[2]; k <= last[2]; ++k) {
      for (int j = first[1]; j <= last[1]; ++j) {
        for (int i = first[0]; i <= last[0]; ++i) {
          const int bin = bin_number({i, j, k});
          for (int entry = bin_offsets_[bin]; entry < bin_offsets_[bin + 1]; ++entry) {
            const int cell = bin_cells_[entry];
            const Index& start = first_bin_[cell];
            const bool here = i == std::max(first[0], start[0]) &&
                              j == std::max(first[1], start[1]) &&
                              k == std::max(first[2], start[2]);
            if (here && touch(box, shapes_.bounds(cell))) out.push_back({cell, seen.centre});
          }
        }
      }
    }
  }
}

}  // namespace fluxpact
