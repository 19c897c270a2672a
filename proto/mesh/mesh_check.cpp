#include "proto/mesh/mesh_check.hpp"

#include <algorithm>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

void check_lengths(const MeshTopology& mesh) {
  const std::size_t faces = mesh.owner.size();
  if (mesh.face_offsets.size() != faces + 1 || mesh.face_offsets.front() != 0 ||
      mesh.face_offsets.back() != static_cast<int>(mesh.face_points.size()) ||
      mesh.neighbour.size() > faces || mesh.periodic_faces.size() != mesh.translations.size()) {
    throw ConfigError(
        "mesh: the lengths of face offsets ({}), face points ({}), owners ({}) and neighbours ({}) "
        "do not fit",
        mesh.face_offsets.size(), mesh.face_points.size(), faces, mesh.neighbour.size());
  }
}

void check_faces(const MeshTopology& mesh) {
  for (std::size_t face = 0; face < mesh.owner.size(); ++face) {
    const int size = mesh.face_offsets[face + 1] - mesh.face_offsets[face];
    if (size < 3) throw ConfigError("mesh: face {} has {} points; it needs at least 3", face, size);
  }
  const int points = static_cast<int>(mesh.points.size());
  for (const int point : mesh.face_points) {
    if (point < 0 || point >= points)
      throw ConfigError("mesh: a face names point {} of {}", point, points);
  }
  std::vector<char> periodic(mesh.neighbour.size(), 0);
  for (const int face : mesh.periodic_faces) {
    if (face < 0 || face >= static_cast<int>(mesh.neighbour.size())) {
      throw ConfigError("mesh: periodic face {} is not an internal face", face);
    }
    periodic[face] = 1;
  }
  for (std::size_t face = 0; face < mesh.neighbour.size(); ++face) {
    if (mesh.owner[face] == mesh.neighbour[face] && periodic[face] == 0) {
      throw ConfigError("mesh: face {} joins cell {} to itself", face, mesh.owner[face]);
    }
  }
}

void check_patches(const MeshTopology& mesh) {
  const int faces = static_cast<int>(mesh.owner.size());
  int next = static_cast<int>(mesh.neighbour.size());
  for (const Patch& patch : mesh.patches) {
    if (patch.first != next || patch.size < 0 || patch.size > faces - next) {
      throw ConfigError(
          "mesh: patch '{}' has {} faces from face {} on; expected: it starts at {}, and there are "
          "{} faces in all",
          patch.name, patch.size, patch.first, next, faces);
    }
    next += patch.size;
  }
  if (next != faces) {
    throw ConfigError("mesh: the patches end at face {}, the mesh has {}", next, faces);
  }
}

/// What a fault is called, in the singular and the plural, and what to do.
struct FaultText {
  const char* one;
  const char* many;
  const char* advice;
};

FaultText text_of(MeshFault fault) {
  switch (fault) {
    case MeshFault::unused_point:
      return {"point is on no face", "points are on no face", "remove them"};
    case MeshFault::face_without_area:
      return {"face has no area", "faces have no area", "merge their points"};
    case MeshFault::open_cell:
      return {"cell is open (its face areas should add up to nothing)",
              "cells are open (their face areas should add up to nothing)",
              "a face is missing, or its points run the wrong way round"};
    case MeshFault::cell_without_volume:
      return {"cell has no positive volume", "cells have no positive volume",
              "check the order of their points, and whether cells fold over"};
  }
  throw ConfigError("mesh: unknown fault {}", static_cast<int>(fault));
}

std::string describe(MeshFault fault, int index, const Vector3& at, double measure) {
  const std::string place = fmt::format("({:.6g}, {:.6g}, {:.6g}) m", at.x(), at.y(), at.z());
  switch (fault) {
    case MeshFault::open_cell:
      return fmt::format("cell {} at {}, {:.3g} of its surface", index, place, measure);
    case MeshFault::cell_without_volume:
      return fmt::format("cell {} at {}, {:.3g} m³", index, place, measure);
    case MeshFault::face_without_area:
      return fmt::format("face {} at {}", index, place);
    case MeshFault::unused_point:
      break;
  }
  return fmt::format("point {} at {}", index, place);
}

}  // namespace

void check_topology(const MeshTopology& mesh) {
  check_lengths(mesh);
  if (!std::ranges::is_sorted(mesh.face_offsets))
    throw ConfigError("mesh: face offsets must ascend");
  check_faces(mesh);
  check_patches(mesh);
}

int count_cells(const MeshTopology& mesh) {
  if (mesh.owner.empty()) throw ConfigError("mesh: no faces");
  int highest = 0;
  for (const auto* side : {&mesh.owner, &mesh.neighbour}) {
    for (const int cell : *side) {
      if (cell < 0) throw ConfigError("mesh: a face names cell {}", cell);
      highest = std::max(highest, cell);
    }
  }
  if (static_cast<std::size_t>(highest) >= 2 * mesh.owner.size()) {
    throw ConfigError("mesh: a face names cell {}, more than {} faces can bound", highest,
                      mesh.owner.size());
  }
  std::vector<char> seen(static_cast<std::size_t>(highest) + 1, 0);
  for (const auto* side : {&mesh.owner, &mesh.neighbour}) {
    for (const int cell : *side) seen[cell] = 1;
  }
  const auto missing = std::ranges::find(seen, 0);
  if (missing != seen.end()) throw ConfigError("mesh: cell {} has no face", missing - seen.begin());
  return highest + 1;
}

void MeshFaults::add(MeshFault fault, int index, const Vector3& place, double measure) {
  constexpr std::size_t shown = 4;
  Entry& entry = entries_.at(static_cast<std::size_t>(fault));
  ++entry.total;
  if (entry.first.size() < shown) entry.first.push_back(describe(fault, index, place, measure));
}

void MeshFaults::refuse() const {
  std::string text;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& entry = entries_.at(i);
    if (entry.total == 0) continue;
    const FaultText words = text_of(static_cast<MeshFault>(i));
    const std::size_t more = static_cast<std::size_t>(entry.total) - entry.first.size();
    text += fmt::format("{}{} {}: {}{}; {}", text.empty() ? "" : "\n", entry.total,
                        entry.total == 1 ? words.one : words.many, fmt::join(entry.first, "; "),
                        more == 0 ? "" : fmt::format("; and {} more", more), words.advice);
  }
  if (!text.empty()) throw ConfigError("mesh: {}", text);
}

void find_unused_points(const MeshTopology& mesh, MeshFaults& faults) {
  if (!mesh.periodic_faces.empty()) return;
  std::vector<char> used(mesh.points.size(), 0);
  for (const int point : mesh.face_points) used[point] = 1;
  for (std::size_t point = 0; point < used.size(); ++point) {
    if (used[point] == 0) {
      faults.add(MeshFault::unused_point, static_cast<int>(point), mesh.points[point], 0);
    }
  }
}

}  // namespace fluxpact
