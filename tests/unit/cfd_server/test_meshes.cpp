#include "tests/unit/cfd_server/test_meshes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "proto/mesh/box.hpp"
#include "proto/mesh/cell_sides.hpp"
#include "proto/mesh/periodic_patches.hpp"
#include "tests/unit/cfd_server/perturbed_box.hpp"

namespace fluxpact {
namespace {

const std::array<std::string, 6> side_names{"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"};

/// The points of the lattice, moved as the box asks.
struct LatticePoints {
  std::array<int, 3> cells{};
  std::vector<Vector3> points;

  explicit LatticePoints(const TestBox& box) : cells(box.cells) {
    MeshSettings settings;
    settings.box.lower = box.lower;
    settings.box.upper = box.upper;
    settings.box.cells = box.cells;
    Vector3 spacing = box.upper - box.lower;
    for (int axis = 0; axis < 3; ++axis) spacing[axis] /= box.cells.at(axis);
    points = perturbed(make_box(settings), spacing, box.share, box.seed).points;
  }

  int at(const std::array<int, 3>& node) const {
    return node[0] + (cells[0] + 1) * (node[1] + (cells[1] + 1) * node[2]);
  }
  std::array<int, 3> node(int point) const {
    const int nx = cells[0] + 1;
    const int ny = cells[1] + 1;
    return {point % nx, point / nx % ny, point / (nx * ny)};
  }
  /// The sides 0 ... 5 on which all of these points lie.
  std::vector<int> sides_of(std::span<const int> ring) const {
    std::vector<int> sides;
    for (int side = 0; side < 6; ++side) {
      const int axis = side / 2;
      const int place = side % 2 == 0 ? 0 : cells.at(axis);
      if (std::ranges::all_of(ring, [&](int point) { return node(point).at(axis) == place; }))
        sides.push_back(side);
    }
    return sides;
  }
  template <class Visit>
  void for_each_cell(const Visit& visit) const {
    for (int k = 0; k < cells[2]; ++k) {
      for (int j = 0; j < cells[1]; ++j) {
        for (int i = 0; i < cells[0]; ++i) visit(std::array<int, 3>{i, j, k});
      }
    }
  }
  /// The corner of a cell; bits 0, 1, 2 of `corner` stand for x, y, z.
  int corner(std::array<int, 3> cell, int corner) const {
    for (int axis = 0; axis < 3; ++axis) cell.at(axis) += corner >> axis & 1;
    return at(cell);
  }
};

/// Mesh of cells whose single sides lie on the six sides of the box, periodic ones joined.
template <class SideOf>
Mesh finish(const TestBox& box, std::vector<Vector3> points, const CellSides& sides,
            const SideOf& side_of) {
  const MatchedSides matched = match_sides(sides, points);
  std::vector<int> patches;
  for (const int side : matched.single) patches.push_back(side_of(side));
  MeshTopology mesh = mesh_of_sides(std::move(points), sides, matched, patches, side_names);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!box.periodic.at(axis)) continue;
    mesh =
        join_periodic(std::move(mesh), side_names.at(2 * axis + 1), side_names.at(2 * axis), 1e-6);
  }
  return with_geometry(std::move(mesh));
}

/// Adds cells by the usual numbering of their points: the base as seen from inside the cell runs
/// right-handed, so that its reverse points out.
struct CellAdder {
  CellSides sides;
  int cells = 0;

  void add_cell(const std::vector<std::vector<int>>& rings) {
    for (const auto& ring : rings) sides.add(cells, ring);
    ++cells;
  }
  void tetrahedron(const std::array<int, 4>& p) {
    add_cell({{p[0], p[2], p[1]}, {p[0], p[1], p[3]}, {p[1], p[2], p[3]}, {p[0], p[3], p[2]}});
  }
  void pyramid(const std::array<int, 5>& p) {
    add_cell({{p[0], p[3], p[2], p[1]},
              {p[0], p[1], p[4]},
              {p[1], p[2], p[4]},
              {p[2], p[3], p[4]},
              {p[3], p[0], p[4]}});
  }
  /// Triangle p0 p1 p2 below p3 p4 p5.
  void prism(const std::array<int, 6>& p) {
    add_cell({{p[0], p[2], p[1]},
              {p[3], p[4], p[5]},
              {p[0], p[1], p[4], p[3]},
              {p[1], p[2], p[5], p[4]},
              {p[2], p[0], p[3], p[5]}});
  }
  void hexahedron(const LatticePoints& lattice, const std::array<int, 3>& cell) {
    std::vector<std::vector<int>> rings;
    for (const auto& ring : hexahedron_rings) {
      rings.emplace_back();
      for (const int c : ring) rings.back().push_back(lattice.corner(cell, c));
    }
    add_cell(rings);
  }

  static constexpr std::array<std::array<int, 4>, 6> hexahedron_rings{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
};

Mesh finish_on_lattice(const TestBox& box, const LatticePoints& lattice,
                       std::vector<Vector3> points, const CellSides& sides) {
  return finish(box, std::move(points), sides,
                [&](int side) { return lattice.sides_of(sides.ring(side)).front(); });
}

/// The six tetrahedra of a cell: paths along its edges from one end of the diagonal to the other.
CellAdder kuhn_tetrahedra(const LatticePoints& lattice) {
  CellAdder adder;
  lattice.for_each_cell([&](const std::array<int, 3>& cell) {
    std::array<int, 3> axes{0, 1, 2};
    do {
      const int first = 1 << axes[0];
      const int second = first | 1 << axes[1];
      const bool even = (axes[1] - axes[0] + 3) % 3 == 1;
      const int b = lattice.corner(cell, even ? first : second);
      const int c = lattice.corner(cell, even ? second : first);
      adder.tetrahedron({lattice.corner(cell, 0), b, c, lattice.corner(cell, 7)});
    } while (std::ranges::next_permutation(axes).found);
  });
  return adder;
}

/// The two prisms of a cell.
void add_prisms(CellAdder& adder, const LatticePoints& lattice, const std::array<int, 3>& cell) {
  const auto p = [&](int corner) { return lattice.corner(cell, corner); };
  adder.prism({p(0), p(1), p(3), p(4), p(5), p(7)});
  adder.prism({p(0), p(3), p(2), p(4), p(7), p(6)});
}

// ---- the dual of the tetrahedra ----

class Dual {
 public:
  explicit Dual(const TestBox& box)
      : box_(box), lattice_(box), tetrahedra_(tetrahedra(box_open())) {
    for (int cell = 0; cell < tetrahedra_.cells(); ++cell)
      points_.push_back(tetrahedra_.cell_centres[cell]);
    for (int face = 0; face < tetrahedra_.faces(); ++face) collect(face);
    for (auto& [edge, around] : around_edge_) add_inner_face(edge, around);
    for (auto& [place, around] : around_point_) add_outer_face(place.first, place.second, around);
  }

  Mesh mesh() {
    return finish(box_, points_, sides_, [&](int side) { return side_of_ring_.at(side); });
  }

 private:
  using Edge = std::pair<int, int>;

  TestBox box_open() const {
    TestBox open = box_;
    open.periodic = {};
    return open;
  }

  int add_point(const Vector3& point) {
    points_.push_back(point);
    return static_cast<int>(points_.size()) - 1;
  }

  /// Every tetrahedron and boundary triangle round each edge, and round each point of the boundary.
  void collect(int face) {
    const auto first = static_cast<std::size_t>(tetrahedra_.face_offsets[face]);
    const auto ring = std::span(tetrahedra_.face_points).subspan(first, 3);
    const bool internal = face < tetrahedra_.internal_faces();
    const int centre = internal ? -1 : add_point(tetrahedra_.face_centres[face]);
    for (std::size_t i = 0; i < 3; ++i) {
      const int a = std::min(ring[i], ring[(i + 1) % 3]);
      const int b = std::max(ring[i], ring[(i + 1) % 3]);
      std::vector<int>& around = around_edge_[{a, b}];
      around.push_back(tetrahedra_.owner[face]);
      around.push_back(internal ? tetrahedra_.neighbour[face] : centre);
      if (internal) continue;
      const int side = lattice_.sides_of(ring).front();
      around_point_[{ring[i], side}].push_back(centre);
      // On an edge of the box the middle is a corner of all faces around.
      const std::array<int, 2> ends{a, b};
      if (lattice_.sides_of(ends).size() < 2) continue;
      const int middle = middles_.contains({a, b})
                             ? middles_.at({a, b})
                             : add_point(0.5 * (lattice_.points[a] + lattice_.points[b]));
      middles_[{a, b}] = middle;
      around_point_[{a, side}].push_back(middle);
      around_point_[{b, side}].push_back(middle);
    }
  }

  /// Sorts points into a right-handed ring about an axis through `at`.
  void sort_about(std::vector<int>& ring, const Vector3& at, const Vector3& axis) const {
    const Vector3 u = axis.unitOrthogonal();
    const Vector3 v = axis.normalized().cross(u);
    std::ranges::sort(ring);
    ring.erase(std::ranges::unique(ring).begin(), ring.end());
    std::ranges::sort(ring, {}, [&](int point) {
      const Vector3 arm = points_[point] - at;
      return std::atan2(arm.dot(v), arm.dot(u));
    });
  }

  /// The face between the cells of the two ends of an edge.
  void add_inner_face(const Edge& edge, std::vector<int>& ring) {
    const auto& [a, b] = edge;
    const Vector3 axis = lattice_.points[b] - lattice_.points[a];
    const Vector3 middle = 0.5 * (lattice_.points[a] + lattice_.points[b]);
    sort_about(ring, middle, axis);
    if (middles_.contains(edge)) {
      open_at_widest_gap(ring, middle, axis);
      ring.push_back(middles_.at(edge));
    }
    sides_.add(a, ring);
    std::ranges::reverse(ring);
    sides_.add(b, ring);
    side_of_ring_.resize(static_cast<std::size_t>(sides_.size()), -1);
  }

  /// Turns the ring so that it starts behind the gap that the outside of the box leaves.
  void open_at_widest_gap(std::vector<int>& ring, const Vector3& at, const Vector3& axis) const {
    const auto angle = [&](int from, int to) {
      const Vector3 x = points_[from] - at;
      const Vector3 y = points_[to] - at;
      const double turn = std::atan2(x.cross(y).dot(axis.normalized()),
                                     x.dot(y) - x.dot(axis) * y.dot(axis) / axis.squaredNorm());
      return turn < 0 ? turn + 2 * std::numbers::pi : turn;
    };
    std::size_t start = 0;
    double widest = 0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const double gap = angle(ring[i], ring[(i + 1) % ring.size()]);
      if (gap > widest) {
        widest = gap;
        start = (i + 1) % ring.size();
      }
    }
    std::ranges::rotate(ring, ring.begin() + static_cast<std::ptrdiff_t>(start));
  }

  /// The part of a side that belongs to the cell of a point on it.
  void add_outer_face(int point, int side, std::vector<int>& ring) {
    const std::array<int, 1> alone{point};
    if (lattice_.sides_of(alone).size() == 3) {
      if (!corners_.contains(point)) corners_[point] = add_point(lattice_.points[point]);
      ring.push_back(corners_.at(point));
    }
    std::ranges::sort(ring);
    ring.erase(std::ranges::unique(ring).begin(), ring.end());
    Vector3 mean = Vector3::Zero();
    for (const int corner : ring) mean += points_[corner] / static_cast<double>(ring.size());
    Vector3 outward = Vector3::Zero();
    outward[side / 2] = side % 2 == 0 ? -1 : 1;
    sort_about(ring, mean, outward);
    sides_.add(point, ring);
    side_of_ring_.push_back(side);
  }

  TestBox box_;
  LatticePoints lattice_;
  Mesh tetrahedra_;
  std::vector<Vector3> points_;
  std::map<Edge, std::vector<int>> around_edge_;
  std::map<Edge, int> middles_;  ///< of the edges of the box
  std::map<int, int> corners_;
  std::map<std::pair<int, int>, std::vector<int>> around_point_;  ///< point and side
  CellSides sides_;
  std::vector<int> side_of_ring_;
};

}  // namespace

Mesh hexahedra(const TestBox& box) {
  const LatticePoints lattice(box);
  CellAdder adder;
  lattice.for_each_cell([&](const std::array<int, 3>& cell) { adder.hexahedron(lattice, cell); });
  return finish_on_lattice(box, lattice, lattice.points, adder.sides);
}

Mesh tetrahedra(const TestBox& box) {
  const LatticePoints lattice(box);
  return finish_on_lattice(box, lattice, lattice.points, kuhn_tetrahedra(lattice).sides);
}

Mesh prisms(const TestBox& box) {
  const LatticePoints lattice(box);
  CellAdder adder;
  lattice.for_each_cell([&](const std::array<int, 3>& cell) { add_prisms(adder, lattice, cell); });
  return finish_on_lattice(box, lattice, lattice.points, adder.sides);
}

Mesh polyhedra(const TestBox& box) { return Dual(box).mesh(); }

Mesh mixed_cells(const TestBox& box) {
  const LatticePoints lattice(box);
  std::vector<Vector3> points = lattice.points;
  CellAdder adder;
  const int middle = box.cells[2] / 2;
  lattice.for_each_cell([&](const std::array<int, 3>& cell) {
    if (cell[2] < middle) return adder.hexahedron(lattice, cell);
    if (cell[2] > middle) return add_prisms(adder, lattice, cell);
    Vector3 centre = Vector3::Zero();
    for (int c = 0; c < 8; ++c) centre += points[lattice.corner(cell, c)] / 8;
    points.push_back(centre);
    const int apex = static_cast<int>(points.size()) - 1;
    for (std::size_t side = 0; side < 6; ++side) {
      std::array<int, 4> base{};  // seen from inside
      for (std::size_t i = 0; i < 4; ++i)
        base.at(i) = lattice.corner(cell, CellAdder::hexahedron_rings.at(side).at(3 - i));
      if (side < 5) {
        adder.pyramid({base[0], base[1], base[2], base[3], apex});
      } else {  // the side that prisms cut from corner 4 to corner 7
        const auto p = [&](int corner) { return lattice.corner(cell, corner); };
        adder.tetrahedron({p(4), p(7), p(5), apex});
        adder.tetrahedron({p(4), p(6), p(7), apex});
      }
    }
  });
  return finish_on_lattice(box, lattice, std::move(points), adder.sides);
}

}  // namespace fluxpact
