#include "proto/mesh/box.hpp"

#include <algorithm>
#include <cmath>

#include "proto/base/errors.hpp"
#include "proto/mesh/grading.hpp"

namespace fluxpact {
namespace {

/// Numbers of points, cells and faces of an nx × ny × nz box, and where they lie.
struct Grid {
  std::array<int, 3> cells;
  std::array<std::vector<double>, 3> nodes;

  int point(int i, int j, int k) const { return i + (cells[0] + 1) * (j + (cells[1] + 1) * k); }
  int cell(const std::array<int, 3>& at) const {
    return at[0] + cells[0] * (at[1] + cells[1] * at[2]);
  }

  /// The four points of the cell's face on its high (or low) side of an axis, right-handed about
  /// +axis.
  std::array<int, 4> ring(const std::array<int, 3>& at, int axis, bool high) const {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    std::array<int, 4> points{};
    constexpr std::array<std::array<int, 2>, 4> corners{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    for (std::size_t c = 0; c < 4; ++c) {
      std::array<int, 3> node = at;
      node[axis] += high ? 1 : 0;
      node[u] += corners[c][0];
      node[v] += corners[c][1];
      points[c] = point(node[0], node[1], node[2]);
    }
    return points;
  }
};

Grid make_grid(const BoxSettings& box) {
  Grid grid{box.cells, {}};
  for (int axis = 0; axis < 3; ++axis) {
    const int n = box.cells[axis];
    if (n < 1 || !(box.upper[axis] > box.lower[axis])) {
      throw ConfigError(
          "fluid.mesh.box: axis {} has {} cells between {} and {} m; it needs at least one, and "
          "upper above lower",
          "xyz"[axis], n, box.lower[axis], box.upper[axis]);
    }
    const std::array<const std::vector<GradingSettings>*, 3> parts{&box.grading.x, &box.grading.y,
                                                                   &box.grading.z};
    for (const double share :
         node_shares(n, *parts[axis], fmt::format("fluid.mesh.box.grading.{}", "xyz"[axis]))) {
      grid.nodes[axis].push_back(box.lower[axis] * (1 - share) + box.upper[axis] * share);
    }
  }
  return grid;
}

void add_face(MeshTopology& mesh, const std::array<int, 4>& ring, bool reversed, int owner) {
  for (std::size_t c = 0; c < 4; ++c) mesh.face_points.push_back(ring[reversed ? 3 - c : c]);
  mesh.face_offsets.push_back(static_cast<int>(mesh.face_points.size()));
  mesh.owner.push_back(owner);
}

/// Visit the cells of a grid in natural order.
template <class Visit>
void for_each_cell(const Grid& grid, const Visit& visit) {
  for (int k = 0; k < grid.cells[2]; ++k) {
    for (int j = 0; j < grid.cells[1]; ++j) {
      for (int i = 0; i < grid.cells[0]; ++i) visit(std::array<int, 3>{i, j, k});
    }
  }
}

void add_internal_faces(MeshTopology& mesh, const Grid& grid, const std::array<bool, 3>& periodic) {
  for_each_cell(grid, [&](const std::array<int, 3>& at) {
    for (int axis = 0; axis < 3; ++axis) {
      std::array<int, 3> next = at;
      const bool last = at[axis] + 1 == grid.cells[axis];
      if (last && !periodic[axis]) continue;
      next[axis] = last ? 0 : at[axis] + 1;
      if (last) {
        mesh.periodic_faces.push_back(static_cast<int>(mesh.owner.size()));
        Vector3 translation = Vector3::Zero();
        translation[axis] = grid.nodes[axis].back() - grid.nodes[axis].front();
        mesh.translations.push_back(translation);
      }
      add_face(mesh, grid.ring(at, axis, true), false, grid.cell(at));
      mesh.neighbour.push_back(grid.cell(next));
    }
  });
}

bool inside(const std::optional<std::array<double, 2>>& range, double value) {
  return !range || (value >= (*range)[0] && value <= (*range)[1]);
}

struct BoundaryFace {
  std::array<int, 4> ring{};
  bool reversed = false;
  int owner = 0;
};

/// Faces of one side, given to the first patch whose range holds their centre; what no patch takes
/// goes last.
void sort_into_patches(const Grid& grid, int axis, bool high, const MeshSettings& settings,
                       std::vector<std::vector<BoundaryFace>>& groups) {
  const auto side = static_cast<Side>(2 * axis + (high ? 1 : 0));
  for_each_cell(grid, [&](const std::array<int, 3>& at) {
    if (at[axis] != (high ? grid.cells[axis] - 1 : 0)) return;
    Vector3 centre;
    for (int a = 0; a < 3; ++a) centre[a] = 0.5 * (grid.nodes[a][at[a]] + grid.nodes[a][at[a] + 1]);
    centre[axis] = high ? grid.nodes[axis].back() : grid.nodes[axis].front();
    std::size_t group = settings.patches.size();
    for (std::size_t p = 0; p < settings.patches.size() && group == settings.patches.size(); ++p) {
      const PatchSettings& patch = settings.patches[p].second;
      const Region& range = patch.within;
      if (patch.side == side && inside(range.x, centre.x()) && inside(range.y, centre.y()) &&
          inside(range.z, centre.z())) {
        group = p;
      }
    }
    groups[group].push_back({grid.ring(at, axis, high), !high, grid.cell(at)});
  });
}

void add_boundary_faces(MeshTopology& mesh, const Grid& grid, const MeshSettings& settings,
                        const std::array<bool, 3>& periodic) {
  std::vector<std::vector<BoundaryFace>> groups(settings.patches.size() + 1);
  for (int axis = 0; axis < 3; ++axis) {
    if (periodic[axis]) continue;
    for (const bool high : {false, true}) sort_into_patches(grid, axis, high, settings, groups);
  }
  for (std::size_t p = 0; p < groups.size(); ++p) {
    const bool rest = p == settings.patches.size();
    if (groups[p].empty() && !rest) {
      throw ConfigError(
          "fluid.mesh.patches.{}: no face of the mesh lies on this side within this range; "
          "a face belongs to the first patch that holds its centre",
          settings.patches[p].first);
    }
    if (groups[p].empty()) continue;
    mesh.patches.push_back({rest ? "walls" : settings.patches[p].first,
                            static_cast<int>(mesh.owner.size()),
                            static_cast<int>(groups[p].size())});
    for (const BoundaryFace& face : groups[p]) add_face(mesh, face.ring, face.reversed, face.owner);
  }
}

}  // namespace

Mesh make_box(const MeshSettings& settings) {
  const Grid grid = make_grid(settings.box);
  std::array<bool, 3> periodic{};
  for (const Axis axis : settings.periodic) periodic[static_cast<std::size_t>(axis)] = true;
  MeshTopology mesh;
  for (const double z : grid.nodes[2]) {
    for (const double y : grid.nodes[1]) {
      for (const double x : grid.nodes[0]) mesh.points.emplace_back(x, y, z);
    }
  }
  mesh.face_offsets.push_back(0);
  add_internal_faces(mesh, grid, periodic);
  add_boundary_faces(mesh, grid, settings, periodic);
  return with_geometry(std::move(mesh));
}

}  // namespace fluxpact
