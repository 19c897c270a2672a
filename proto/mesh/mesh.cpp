#include "proto/mesh/mesh.hpp"

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "proto/mesh/mesh_check.hpp"

namespace fluxpact {
namespace {

std::span<const int> points_of_face(const MeshTopology& mesh, int face) {
  const auto first = static_cast<std::size_t>(mesh.face_offsets[face]);
  const auto last = static_cast<std::size_t>(mesh.face_offsets[face + 1]);
  return std::span(mesh.face_points).subspan(first, last - first);
}

/// Area vectors and centroids: triangles about the mean of the face's points. The centroid is taken
/// in the plane through that mean across the area vector: so the pyramids from any apex over the
/// centroids have exactly the volume of those over the triangles, also where the face is warped.
void add_face_geometry(Mesh& mesh, MeshFaults& faults) {
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
    if (!(size > 0)) faults.add(MeshFault::face_without_area, face, mean, size);
    Vector3 moment = Vector3::Zero();
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vector3& a = mesh.points[ring[i]];
      const Vector3& b = mesh.points[ring[(i + 1) % ring.size()]];
      moment += 0.5 * (a - mean).cross(b - mean).dot(area) / size * ((a + b + mean) / 3.0 - mean);
    }
    moment -= moment.dot(area) / area.squaredNorm() * area;
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
void add_cell_geometry(Mesh& mesh, int cells, const std::vector<Vector3>& shifts,
                       MeshFaults& faults) {
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
    if (!(closure.norm() <= 1e-9 * surface)) {
      faults.add(MeshFault::open_cell, cell, mean, closure.norm() / surface);
    } else if (!(volume > 0)) {
      faults.add(MeshFault::cell_without_volume, cell, mean, volume);
    }
    mesh.cell_volumes[cell] = volume;
    mesh.cell_centres[cell] = mean + moment / volume;
  }
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
  MeshFaults faults;
  find_unused_points(topology, faults);
  Mesh mesh;
  static_cast<MeshTopology&>(mesh) = std::move(topology);
  add_face_geometry(mesh, faults);
  faults.refuse();  // centres of such faces are no numbers
  add_cell_faces(mesh, cells);
  const auto shifts = neighbour_shifts(mesh);
  add_cell_geometry(mesh, cells, shifts, faults);
  faults.refuse();
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
