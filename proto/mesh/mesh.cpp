#include "proto/mesh/mesh.hpp"

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

std::span<const int> points_of_face(const MeshTopology& mesh, int face) {
  const auto first = static_cast<std::size_t>(mesh.face_offsets[face]);
  const auto last = static_cast<std::size_t>(mesh.face_offsets[face + 1]);
  return std::span(mesh.face_points).subspan(first, last - first);
}

/// Area vectors and centroids: triangles about the mean of the face's points.
void add_face_geometry(Mesh& mesh) {
  mesh.face_areas.reserve(mesh.owner.size());
  mesh.face_centres.reserve(mesh.owner.size());
  for (int face = 0; face < mesh.faces(); ++face) {
    const auto ring = points_of_face(mesh, face);
    Vector3 mean = Vector3::Zero();
    for (const int point : ring) mean += mesh.points[point];
    mean /= static_cast<double>(ring.size());
    Vector3 area = Vector3::Zero();
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vector3& a = mesh.points[ring[i]];
      const Vector3& b = mesh.points[ring[(i + 1) % ring.size()]];
      area += 0.5 * (a - mean).cross(b - mean);
    }
    const double size = area.norm();
    if (!(size > 0)) {
      throw ConfigError("mesh: face {} at ({}, {}, {}) has no area", face, mean.x(), mean.y(),
                        mean.z());
    }
    Vector3 moment = Vector3::Zero();
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vector3& a = mesh.points[ring[i]];
      const Vector3& b = mesh.points[ring[(i + 1) % ring.size()]];
      moment += 0.5 * (a - mean).cross(b - mean).dot(area) / size * ((a + b + mean) / 3.0 - mean);
    }
    mesh.face_areas.push_back(area);
    mesh.face_centres.push_back(mean + moment / size);
  }
}

/// Place of a face as its cell sees it: the neighbour behind a periodic face sees it a translation
/// away.
std::vector<Vector3> neighbour_shifts(const Mesh& mesh) {
  std::vector<Vector3> shifts(mesh.neighbour.size(), Vector3::Zero());
  for (std::size_t i = 0; i < mesh.periodic_faces.size(); ++i) {
    shifts[mesh.periodic_faces[i]] = mesh.translations[i];
  }
  return shifts;
}

void add_cell_faces(Mesh& mesh, int cells) {
  mesh.cell_face_offsets.assign(static_cast<std::size_t>(cells) + 1, 0);
  for (const int cell : mesh.owner) ++mesh.cell_face_offsets[cell + 1];
  for (const int cell : mesh.neighbour) ++mesh.cell_face_offsets[cell + 1];
  for (int cell = 0; cell < cells; ++cell) {
    mesh.cell_face_offsets[cell + 1] += mesh.cell_face_offsets[cell];
  }
  std::vector<int> next(mesh.cell_face_offsets.begin(), mesh.cell_face_offsets.end() - 1);
  mesh.cell_faces.resize(static_cast<std::size_t>(mesh.cell_face_offsets.back()));
  for (int face = 0; face < mesh.faces(); ++face) {
    mesh.cell_faces[next[mesh.owner[face]]++] = face;
    if (face < mesh.internal_faces()) mesh.cell_faces[next[mesh.neighbour[face]]++] = face;
  }
}

/// Volumes and centroids: pyramids from the mean of the face centres to the faces' triangles.
void add_cell_geometry(Mesh& mesh, int cells, const std::vector<Vector3>& shifts) {
  mesh.cell_volumes.assign(static_cast<std::size_t>(cells), 0.0);
  mesh.cell_centres.assign(static_cast<std::size_t>(cells), Vector3::Zero());
  for (int cell = 0; cell < cells; ++cell) {
    const int first = mesh.cell_face_offsets[cell];
    const int last = mesh.cell_face_offsets[cell + 1];
    const auto shift_of = [&](int face) -> Vector3 {
      const bool as_neighbour = face < mesh.internal_faces() && mesh.owner[face] != cell;
      return as_neighbour ? Vector3(-shifts[face]) : Vector3(Vector3::Zero());
    };
    Vector3 mean = Vector3::Zero();
    for (int i = first; i < last; ++i) {
      mean += mesh.face_centres[mesh.cell_faces[i]] + shift_of(mesh.cell_faces[i]);
    }
    mean /= static_cast<double>(last - first);
    double volume = 0;
    Vector3 moment = Vector3::Zero();
    Vector3 closure = Vector3::Zero();
    double surface = 0;
    int previous = -1;
    for (int i = first; i < last; ++i) {
      const int face = mesh.cell_faces[i];
      // A cell that is its own periodic neighbour meets the face twice: once from each side.
      const bool second_side = face == previous;
      previous = face;
      const bool as_owner = mesh.owner[face] == cell && !second_side;
      const double sign = as_owner ? 1.0 : -1.0;
      const Vector3 shift = as_owner ? Vector3(Vector3::Zero()) : Vector3(-shifts[face]);
      const Vector3 apex_to_face = mesh.face_centres[face] + shift - mean;
      const double pyramid = sign * mesh.face_areas[face].dot(apex_to_face) / 3.0;
      volume += pyramid;
      moment += pyramid * 0.75 * apex_to_face;
      closure += sign * mesh.face_areas[face];
      surface += mesh.face_areas[face].norm();
    }
    if (closure.norm() > 1e-9 * surface) {
      throw ConfigError(
          "mesh: cell {} at ({}, {}, {}) is open: its face areas add up to {} of its surface", cell,
          mean.x(), mean.y(), mean.z(), closure.norm() / surface);
    }
    if (!(volume > 0)) {
      throw ConfigError(
          "mesh: cell {} at ({}, {}, {}) has the volume {} m³; check the order of its points", cell,
          mean.x(), mean.y(), mean.z(), volume);
    }
    mesh.cell_volumes[cell] = volume;
    mesh.cell_centres[cell] = mean + moment / volume;
  }
}

void check_topology(const MeshTopology& mesh) {
  const std::size_t faces = mesh.owner.size();
  if (mesh.face_offsets.size() != faces + 1 || mesh.face_offsets.front() != 0 ||
      mesh.face_offsets.back() != static_cast<int>(mesh.face_points.size()) ||
      mesh.neighbour.size() > faces || mesh.periodic_faces.size() != mesh.translations.size()) {
    throw ConfigError(
        "mesh: the lengths of face offsets ({}), face points ({}), owners ({}) and neighbours ({}) "
        "do not fit",
        mesh.face_offsets.size(), mesh.face_points.size(), faces, mesh.neighbour.size());
  }
  if (!std::ranges::is_sorted(mesh.face_offsets))
    throw ConfigError("mesh: face offsets must ascend");
  const int points = static_cast<int>(mesh.points.size());
  for (const int point : mesh.face_points) {
    if (point < 0 || point >= points)
      throw ConfigError("mesh: a face names point {} of {}", point, points);
  }
  for (const int face : mesh.periodic_faces) {
    if (face < 0 || face >= static_cast<int>(mesh.neighbour.size())) {
      throw ConfigError("mesh: periodic face {} is not an internal face", face);
    }
  }
  int next = static_cast<int>(mesh.neighbour.size());
  for (const Patch& patch : mesh.patches) {
    if (patch.first != next || patch.size < 0) {
      throw ConfigError("mesh: patch '{}' starts at face {}, expected {}", patch.name, patch.first,
                        next);
    }
    next += patch.size;
  }
  if (next != static_cast<int>(faces)) {
    throw ConfigError("mesh: the patches end at face {}, the mesh has {}", next, faces);
  }
}

/// Cells that the faces name; every number from 0 up must occur, every point be used.
int count_cells(const MeshTopology& mesh) {
  if (mesh.owner.empty()) throw ConfigError("mesh: no faces");
  int highest = 0;
  for (const auto* side : {&mesh.owner, &mesh.neighbour}) {
    for (const int cell : *side) {
      if (cell < 0) throw ConfigError("mesh: a face names cell {}", cell);
      highest = std::max(highest, cell);
    }
  }
  if (highest >= static_cast<int>(2 * mesh.owner.size())) {
    throw ConfigError("mesh: a face names cell {}, more than {} faces can bound", highest,
                      mesh.owner.size());
  }
  std::vector<char> seen(static_cast<std::size_t>(highest) + 1, 0);
  for (const auto* side : {&mesh.owner, &mesh.neighbour}) {
    for (const int cell : *side) seen[cell] = 1;
  }
  const auto missing = std::ranges::find(seen, 0);
  if (missing != seen.end()) throw ConfigError("mesh: cell {} has no face", missing - seen.begin());
  if (mesh.periodic_faces
          .empty()) {  // else points of the far side belong to faces that are not stored
    std::vector<char> used(mesh.points.size(), 0);
    for (const int point : mesh.face_points) used[point] = 1;
    const auto unused = std::ranges::find(used, 0);
    if (unused != used.end())
      throw ConfigError("mesh: point {} is on no face", unused - used.begin());
  }
  return highest + 1;
}

/// Sorted distinct values, those closer than `tolerance` taken as one.
std::vector<double> distinct(std::vector<double> values, double tolerance) {
  std::ranges::sort(values);
  std::vector<double> kept;
  for (const double value : values) {
    if (kept.empty() || value - kept.back() > tolerance) kept.push_back(value);
  }
  return kept;
}

}  // namespace

const Patch* Mesh::find_patch(const std::string& name) const {
  const auto found = std::ranges::find(patches, name, &Patch::name);
  return found == patches.end() ? nullptr : &*found;
}

Mesh with_geometry(MeshTopology topology) {
  check_topology(topology);
  const int cells = count_cells(topology);
  Mesh mesh;
  static_cast<MeshTopology&>(mesh) = std::move(topology);
  add_face_geometry(mesh);
  add_cell_faces(mesh, cells);
  const auto shifts = neighbour_shifts(mesh);
  add_cell_geometry(mesh, cells, shifts);
  mesh.delta.reserve(mesh.neighbour.size());
  for (int face = 0; face < mesh.internal_faces(); ++face) {
    mesh.delta.push_back(mesh.cell_centres[mesh.neighbour[face]] + shifts[face] -
                         mesh.cell_centres[mesh.owner[face]]);
  }
  mesh.lattice = find_lattice(mesh);
  return mesh;
}

std::optional<Lattice> find_lattice(const Mesh& mesh) {
  Lattice lattice;
  std::array<std::size_t, 3> nodes{};
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    values.reserve(mesh.points.size());
    for (const Vector3& point : mesh.points) values.push_back(point[axis]);
    const auto [low, high] = std::ranges::minmax_element(values);
    lattice.nodes[axis] = distinct(values, 1e-9 * (*high - *low));
    nodes[axis] = lattice.nodes[axis].size();
    if (nodes[axis] < 2) return std::nullopt;
  }
  const std::size_t nx = nodes[0] - 1;
  const std::size_t ny = nodes[1] - 1;
  const std::size_t nz = nodes[2] - 1;
  if (nodes[0] * nodes[1] * nodes[2] != mesh.points.size() ||
      nx * ny * nz != mesh.cell_volumes.size()) {
    return std::nullopt;
  }
  for (std::size_t cell = 0; cell < mesh.cell_volumes.size(); ++cell) {
    const std::array<std::size_t, 3> at{cell % nx, cell / nx % ny, cell / (nx * ny)};
    double volume = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const auto& line = lattice.nodes[axis];
      const double width = line[at[axis] + 1] - line[at[axis]];
      const double middle = 0.5 * (line[at[axis]] + line[at[axis] + 1]);
      if (std::abs(mesh.cell_centres[cell][axis] - middle) > 1e-6 * width) return std::nullopt;
      volume *= width;
    }
    const int faces = mesh.cell_face_offsets[cell + 1] - mesh.cell_face_offsets[cell];
    if (faces != 6 || std::abs(mesh.cell_volumes[cell] - volume) > 1e-6 * volume)
      return std::nullopt;
  }
  for (const Vector3& translation : mesh.translations) {
    int axis = -1;
    translation.cwiseAbs().maxCoeff(&axis);
    lattice.periodic[axis] = true;
  }
  return lattice;
}

std::uint64_t fingerprint(const MeshTopology& mesh) {
  const std::unique_ptr<XXH64_state_t, decltype(&XXH64_freeState)> state(XXH64_createState(),
                                                                         &XXH64_freeState);
  XXH64_reset(state.get(), 0);
  const auto add = [&](const auto& values) {
    const std::uint64_t size = values.size();
    XXH64_update(state.get(), &size, sizeof size);
    XXH64_update(state.get(), values.data(), values.size() * sizeof(values[0]));
  };
  add(mesh.points);
  add(mesh.face_offsets);
  add(mesh.face_points);
  add(mesh.owner);
  add(mesh.neighbour);
  add(mesh.periodic_faces);
  add(mesh.translations);
  for (const Patch& patch : mesh.patches) {
    add(patch.name);
    add(std::array{patch.first, patch.size});
  }
  return XXH64_digest(state.get());
}

}  // namespace fluxpact
