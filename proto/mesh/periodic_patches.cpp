#include "proto/mesh/periodic_patches.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

std::span<const int> ring_of(const MeshTopology& mesh, int face) {
  const auto first = static_cast<std::size_t>(mesh.face_offsets[face]);
  return std::span(mesh.face_points)
      .subspan(first, static_cast<std::size_t>(mesh.face_offsets[face + 1]) - first);
}

struct FacePlace {
  int face = 0;
  Vector3 middle = Vector3::Zero();  ///< mean of the points
  double size = 0;                   ///< square root of the area
};

std::vector<FacePlace> places_of(const MeshTopology& mesh, const Patch& patch) {
  std::vector<FacePlace> places;
  for (int face = patch.first; face < patch.first + patch.size; ++face) {
    FacePlace place{face};
    const auto ring = ring_of(mesh, face);
    for (const int point : ring) place.middle += mesh.points[point];
    place.middle /= static_cast<double>(ring.size());
    Vector3 area = Vector3::Zero();
    for (std::size_t i = 0; i < ring.size(); ++i) {
      area += 0.5 * (mesh.points[ring[i]] - place.middle)
                        .cross(mesh.points[ring[(i + 1) % ring.size()]] - place.middle);
    }
    place.size = std::sqrt(area.norm());
    places.push_back(place);
  }
  return places;
}

/// Places along a direction that no plane of a usual mesh is perpendicular to: a face that lies
/// near another is near it in this order too, and few others are.
constexpr std::array<double, 3> oblique{0.5377, 0.6151, 0.5767};
double height(const Vector3& at) {
  return oblique[0] * at.x() + oblique[1] * at.y() + oblique[2] * at.z();
}

/// The index in `sorted` of the place nearest to `target` within `reach`, or -1.
int nearest(const std::vector<FacePlace>& sorted, const Vector3& target, double reach) {
  const auto low =
      std::ranges::lower_bound(sorted, height(target) - reach, {},
                               [](const FacePlace& place) { return height(place.middle); });
  int best = -1;
  double distance = reach;
  for (auto it = low; it != sorted.end() && height(it->middle) <= height(target) + reach; ++it) {
    if ((it->middle - target).norm() <= distance) {
      distance = (it->middle - target).norm();
      best = static_cast<int>(it - sorted.begin());
    }
  }
  return best;
}

Vector3 mean_of(const std::vector<FacePlace>& places) {
  Vector3 sum = Vector3::Zero();
  for (const FacePlace& place : places) sum += place.middle;
  return sum / static_cast<double>(places.size());
}

/// The pair of patches, and for each face of the first its partner in the second.
struct Joint {
  Patch first;
  Patch second;
  Vector3 translation;        ///< [m] from the second to the first
  std::vector<int> partners;  ///< faces of the second, one for each face of the first
  double tolerance = 0;
};

[[noreturn]] void refuse_face(const Joint& joint, const FacePlace& place) {
  throw ConfigError(
      "mesh: periodic patches {} and {}: the face at ({:.6g}, {:.6g}, {:.6g}) has no partner at "
      "the "
      "distance ({:.6g}, {:.6g}, {:.6g}) within {} of its size; the two must be the same but for a "
      "translation (rotations are not supported)",
      joint.first.name, joint.second.name, place.middle.x(), place.middle.y(), place.middle.z(),
      -joint.translation.x(), -joint.translation.y(), -joint.translation.z(), joint.tolerance);
}

const Patch& patch_named(const MeshTopology& mesh, const std::string& name) {
  const auto found = std::ranges::find(mesh.patches, name, &Patch::name);
  if (found == mesh.patches.end()) {
    throw ConfigError("mesh: the periodic patch {} is not in the mesh", name);
  }
  return *found;
}

Joint find_partners(const MeshTopology& mesh, const std::string& first, const std::string& second,
                    double tolerance) {
  Joint joint{patch_named(mesh, first), patch_named(mesh, second), Vector3::Zero(), {}, tolerance};
  if (first == second || joint.first.size != joint.second.size || joint.first.size == 0) {
    throw ConfigError(
        "mesh: periodic patches {} ({} faces) and {} ({} faces) must be two, with equal numbers of "
        "faces",
        first, joint.first.size, second, joint.second.size);
  }
  const auto here = places_of(mesh, joint.first);
  auto there = places_of(mesh, joint.second);
  joint.translation = mean_of(here) - mean_of(there);
  std::ranges::sort(there, {}, [](const FacePlace& place) { return height(place.middle); });
  std::vector<char> taken(there.size(), 0);
  for (const FacePlace& place : here) {
    const int found = nearest(there, place.middle - joint.translation, tolerance * place.size);
    if (found < 0 || taken[found] != 0) refuse_face(joint, place);
    taken[found] = 1;
    joint.partners.push_back(there[found].face);
  }
  return joint;
}

/// Points of the second patch go to the images of those of the first.
void move_points(MeshTopology& mesh, const Joint& joint) {
  const auto here = places_of(mesh, joint.first);
  std::vector<std::pair<int, Vector3>> moves;
  for (std::size_t i = 0; i < here.size(); ++i) {
    const auto ring = ring_of(mesh, here[i].face);
    const auto partner = ring_of(mesh, joint.partners[i]);
    if (ring.size() != partner.size()) refuse_face(joint, here[i]);
    for (const int point : ring) {
      const Vector3 image = mesh.points[point] - joint.translation;
      const auto distance = [&](int other) { return (mesh.points[other] - image).norm(); };
      const int twin = *std::ranges::min_element(partner, {}, distance);
      if (distance(twin) > joint.tolerance * here[i].size) refuse_face(joint, here[i]);
      moves.emplace_back(twin, image);
    }
  }
  for (const auto& [point, image] : moves) mesh.points[point] = image;
}

/// Copies faces in a new order: what lies between is renumbered by the caller.
void add_face(MeshTopology& target, const MeshTopology& source, int face) {
  const auto ring = ring_of(source, face);
  target.face_points.insert(target.face_points.end(), ring.begin(), ring.end());
  target.face_offsets.push_back(static_cast<int>(target.face_points.size()));
  target.owner.push_back(source.owner[face]);
}

}  // namespace

MeshTopology join_periodic(MeshTopology mesh, const std::string& first, const std::string& second,
                           double tolerance) {
  const Joint joint = find_partners(mesh, first, second, tolerance);
  move_points(mesh, joint);
  MeshTopology joined;
  joined.points = std::move(mesh.points);
  joined.neighbour = mesh.neighbour;
  joined.periodic_faces = mesh.periodic_faces;
  joined.translations = mesh.translations;
  joined.face_offsets.push_back(0);
  const int internal = static_cast<int>(mesh.neighbour.size());
  for (int face = 0; face < internal; ++face) add_face(joined, mesh, face);
  for (int i = 0; i < joint.first.size; ++i) {
    joined.periodic_faces.push_back(internal + i);
    joined.translations.push_back(joint.translation);
    joined.neighbour.push_back(mesh.owner[joint.partners[i]]);
    add_face(joined, mesh, joint.first.first + i);
  }
  for (const Patch& patch : mesh.patches) {
    if (patch.name == first || patch.name == second) continue;
    joined.patches.push_back({patch.name, static_cast<int>(joined.owner.size()), patch.size});
    for (int i = 0; i < patch.size; ++i) add_face(joined, mesh, patch.first + i);
  }
  return joined;
}

}  // namespace fluxpact
