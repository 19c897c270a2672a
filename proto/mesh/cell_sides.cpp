#include "proto/mesh/cell_sides.hpp"

#include <algorithm>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

Vector3 middle_of(std::span<const int> ring, std::span<const Vector3> points) {
  Vector3 sum = Vector3::Zero();
  for (const int point : ring) sum += points[point];
  return sum / static_cast<double>(ring.size());
}

/// Sides by their lowest point: only within such a group can two sides be equal.
struct Groups {
  std::vector<int> offsets;
  std::vector<int> sides;
};

Groups group_by_lowest_point(const CellSides& sides, std::size_t points) {
  Groups groups;
  groups.offsets.assign(points + 1, 0);
  std::vector<int> lowest(static_cast<std::size_t>(sides.size()));
  for (int side = 0; side < sides.size(); ++side) {
    lowest[side] = std::ranges::min(sides.ring(side));
    ++groups.offsets[lowest[side] + 1];
  }
  for (std::size_t p = 0; p < points; ++p) groups.offsets[p + 1] += groups.offsets[p];
  std::vector<int> next(groups.offsets.begin(), groups.offsets.end() - 1);
  groups.sides.resize(lowest.size());
  for (int side = 0; side < sides.size(); ++side) groups.sides[next[lowest[side]]++] = side;
  return groups;
}

bool same_points(std::span<const int> a, std::span<const int> b) {
  return a.size() == b.size() && std::ranges::is_permutation(a, b);
}

/// True if b runs round its points against a, as the two sides of one face do.
bool runs_against(std::span<const int> a, std::span<const int> b) {
  const auto start = std::ranges::find(b, a[0]);
  const auto at = static_cast<std::size_t>(start - b.begin());
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] != b[(at + b.size() - i) % b.size()]) return false;
  }
  return true;
}

/// The one side of a group that has the points of `side`, or -1.
int partner_of(const CellSides& sides, std::span<const int> group, int side,
               std::span<const Vector3> points) {
  int partner = -1;
  const auto ring = sides.ring(side);
  for (const int other : group) {
    if (other == side || !same_points(ring, sides.ring(other))) continue;
    const Vector3 at = middle_of(ring, points);
    if (partner >= 0) {
      throw ConfigError(
          "mesh: the cells {}, {} and {} have the same face at ({:.6g}, {:.6g}, {:.6g}); a face "
          "has "
          "at most two cells: remove the cell that overlaps the others",
          sides.cell[side], sides.cell[partner], sides.cell[other], at.x(), at.y(), at.z());
    }
    if (sides.cell[side] == sides.cell[other]) {
      throw ConfigError(
          "mesh: cell {} has the same face twice at ({:.6g}, {:.6g}, {:.6g}): it is flat there, or "
          "names a point twice",
          sides.cell[side], at.x(), at.y(), at.z());
    }
    if (!runs_against(ring, sides.ring(other))) {
      throw ConfigError(
          "mesh: the cells {} and {} lie on the same side of their face at ({:.6g}, {:.6g}, "
          "{:.6g}): they overlap, or the points of one of them are in the wrong order",
          sides.cell[side], sides.cell[other], at.x(), at.y(), at.z());
    }
    partner = other;
  }
  return partner;
}

void add_face(MeshTopology& mesh, const CellSides& sides, int side) {
  const auto ring = sides.ring(side);
  mesh.face_points.insert(mesh.face_points.end(), ring.begin(), ring.end());
  mesh.face_offsets.push_back(static_cast<int>(mesh.face_points.size()));
  mesh.owner.push_back(sides.cell[side]);
}

}  // namespace

void CellSides::add(int of_cell, std::span<const int> ring) {
  points.insert(points.end(), ring.begin(), ring.end());
  offsets.push_back(static_cast<int>(points.size()));
  cell.push_back(of_cell);
}

std::span<const int> CellSides::ring(int side) const {
  const auto first = static_cast<std::size_t>(offsets[side]);
  return std::span(points).subspan(first, static_cast<std::size_t>(offsets[side + 1]) - first);
}

MatchedSides match_sides(const CellSides& sides, std::span<const Vector3> points) {
  const Groups groups = group_by_lowest_point(sides, points.size());
  MatchedSides matched;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const auto first = static_cast<std::size_t>(groups.offsets[p]);
    const auto group = std::span(groups.sides)
                           .subspan(first, static_cast<std::size_t>(groups.offsets[p + 1]) - first);
    for (const int side : group) {
      const int partner = partner_of(sides, group, side, points);
      if (partner < 0) matched.single.push_back(side);
      if (partner >= 0 && sides.cell[side] < sides.cell[partner]) {
        matched.pairs.push_back({side, partner});
      }
    }
  }
  std::ranges::sort(matched.single);
  std::ranges::sort(matched.pairs, {}, [&](const std::array<int, 2>& pair) {
    return std::pair(sides.cell[pair[0]], sides.cell[pair[1]]);
  });
  return matched;
}

MeshTopology mesh_of_sides(std::vector<Vector3> points, const CellSides& sides,
                           const MatchedSides& matched, std::span<const int> patch_of_single,
                           std::span<const std::string> names) {
  MeshTopology mesh;
  mesh.points = std::move(points);
  mesh.face_offsets.push_back(0);
  for (const auto& [side, partner] : matched.pairs) {
    add_face(mesh, sides, side);
    mesh.neighbour.push_back(sides.cell[partner]);
  }
  std::vector<std::vector<int>> patches(names.size());
  for (std::size_t i = 0; i < matched.single.size(); ++i) {
    patches[patch_of_single[i]].push_back(matched.single[i]);
  }
  for (std::size_t p = 0; p < names.size(); ++p) {
    if (patches[p].empty()) continue;
    mesh.patches.push_back(
        {names[p], static_cast<int>(mesh.owner.size()), static_cast<int>(patches[p].size())});
    for (const int side : patches[p]) add_face(mesh, sides, side);
  }
  return mesh;
}

}  // namespace fluxpact
