#include "dem_server/walls/facets.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

Vector3 area_normal(const TriangleSurface& surface, const std::array<int, 3>& t) {
  const Vector3& a = surface.points[t[0]];
  return (surface.points[t[1]] - a).cross(surface.points[t[2]] - a);
}

/// Triangles turned so that those of one shell agree, the shell of each, and points of their own
/// for each shell.
struct Oriented {
  TriangleSurface surface;
  std::vector<int> shell;
  int shells = 0;
};

/// The neighbour across an edge of two, or -1.
int across(const SurfaceEdges& edges, int triangle, int side) {
  const SurfaceEdge& edge = edges.edges[edges.of[triangle].at(side)];
  if (edge.count != 2) return -1;
  const int first = edges.sides[edge.first].triangle;
  return first == triangle ? edges.sides[edge.first + 1].triangle : first;
}

bool goes_along(const TriangleSurface& surface, int triangle, const std::array<int, 2>& points) {
  const std::array<int, 3>& t = surface.triangles[triangle];
  for (int s = 0; s < 3; ++s) {
    if (t.at(s) == points[0] && t.at((s + 1) % 3) == points[1]) return true;
  }
  return false;
}

void orient(Oriented& made, const std::string& source) {
  const SurfaceEdges edges = find_edges(made.surface);
  const int count = static_cast<int>(made.surface.triangles.size());
  made.shell.assign(count, -1);
  std::vector<int> front;
  for (int seed = 0; seed < count; ++seed) {
    if (made.shell[seed] >= 0) continue;
    made.shell[seed] = made.shells;
    front.assign(1, seed);
    while (!front.empty()) {
      const int t = front.back();
      front.pop_back();
      for (int s = 0; s < 3; ++s) {
        const int other = across(edges, t, s);
        if (other < 0) continue;
        const std::array<int, 2>& points = edges.edges[edges.of[t].at(s)].points;
        const bool agrees =
            goes_along(made.surface, t, points) != goes_along(made.surface, other, points);
        if (made.shell[other] < 0) {
          if (!agrees)
            std::swap(made.surface.triangles[other][1], made.surface.triangles[other][2]);
          made.shell[other] = made.shells;
          front.push_back(other);
        } else if (!agrees) {
          throw ConfigError(
              "{}: the surface around triangle {} has one side only, like a Moebius strip; cut it "
              "into two",
              source, made.surface.number.empty() ? other + 1 : made.surface.number[other]);
        }
      }
    }
    ++made.shells;
  }
}

/// A point where two shells meet becomes one for each. Triangles and corners keep their order.
void split_points(Oriented& made) {
  std::map<std::pair<int, int>, int> points;  // (shell, point) -> new point
  TriangleSurface split;
  for (std::size_t t = 0; t < made.surface.triangles.size(); ++t) {
    std::array<int, 3> corners = made.surface.triangles[t];
    for (int& corner : corners) {
      const auto [at, added] =
          points.try_emplace({made.shell[t], corner}, static_cast<int>(split.points.size()));
      if (added) split.points.push_back(made.surface.points[corner]);
      corner = at->second;
    }
    split.triangles.push_back(corners);
  }
  split.number = std::move(made.surface.number);
  made.surface = std::move(split);
}

/// Numbers of planes: connected triangles whose normals are those of the first.
std::vector<std::int32_t> find_planes(const TriangleSurface& surface, const SurfaceEdges& edges,
                                      const std::vector<Vector3>& normals, std::int32_t& features) {
  std::vector<std::int32_t> plane(surface.triangles.size(), -1);
  std::vector<int> front;
  for (int seed = 0; seed < static_cast<int>(plane.size()); ++seed) {
    if (plane[seed] >= 0) continue;
    plane[seed] = features;
    front.assign(1, seed);
    while (!front.empty()) {
      const int t = front.back();
      front.pop_back();
      for (int s = 0; s < 3; ++s) {
        const int other = across(edges, t, s);
        if (other < 0 || plane[other] >= 0) continue;
        if (normals[other].cross(normals[seed]).norm() > coplanar ||
            normals[other].dot(normals[seed]) < 0) {
          continue;
        }
        plane[other] = features;
        front.push_back(other);
      }
    }
    ++features;
  }
  return plane;
}

/// The making of the joints of one surface. A joint belongs to one shell, which decides its normal
/// and whether it is a rim; what else stands around it, of other shells, too, decides where it is
/// the nearest point of all.
struct Joints {
  const TriangleSurface& whole;  // shells share points
  const SurfaceEdges& whole_edges;
  const TriangleSurface& surface;  // each shell has its own points
  const SurfaceEdges& edges;
  const std::vector<Vector3>& normals;
  const std::vector<std::int32_t>& plane;
  Facets& facets;
};

FacetJoint start_joint(const Facets& facets) {
  FacetJoint joint;
  joint.first = static_cast<int>(facets.away.size());
  joint.first_face = static_cast<int>(facets.faces.size());
  return joint;
}

void end_joint(Facets& facets, FacetJoint& joint) {
  joint.count = static_cast<int>(facets.away.size()) - joint.first;
  joint.face_count = static_cast<int>(facets.faces.size()) - joint.first_face;
}

/// Edges within a plane carry its number; those between two planes one for each straight line of
/// connected edges.
void number_edges(const Joints& in, int first, std::int32_t& features) {
  std::map<std::array<std::int32_t, 3>, std::vector<int>> lines;  // (planes, point) -> edges
  for (int e = 0; e < static_cast<int>(in.edges.edges.size()); ++e) {
    FacetJoint& joint = in.facets.edges[first + e];
    std::vector<std::int32_t> around(in.facets.faces.begin() + joint.first_face,
                                     in.facets.faces.begin() + joint.first_face + joint.face_count);
    std::sort(around.begin(), around.end());
    if (around.size() == 2 && around[0] == around[1]) {
      joint.feature = around[0];
      continue;
    }
    joint.feature = -1;
    if (around.size() > 2) continue;
    for (const int point : in.edges.edges[e].points) {
      lines[{around.front(), around.size() == 2 ? around[1] : -1, point}].push_back(e);
    }
  }
  std::vector<int> front;
  for (int seed = 0; seed < static_cast<int>(in.edges.edges.size()); ++seed) {
    if (in.facets.edges[first + seed].feature >= 0) continue;
    const Vector3 line = in.surface.points[in.edges.edges[seed].points[1]] -
                         in.surface.points[in.edges.edges[seed].points[0]];
    in.facets.edges[first + seed].feature = features;
    front.assign(1, seed);
    while (!front.empty()) {
      const int e = front.back();
      front.pop_back();
      const FacetJoint& joint = in.facets.edges[first + e];
      if (joint.face_count > 2) continue;
      const std::int32_t one = in.facets.faces[joint.first_face];
      const std::int32_t two = joint.face_count == 2 ? in.facets.faces[joint.first_face + 1] : one;
      const std::int32_t high = joint.face_count == 2 ? std::max(one, two) : -1;
      for (const int point : in.edges.edges[e].points) {
        for (const int other : lines[{std::min(one, two), high, point}]) {
          FacetJoint& next = in.facets.edges[first + other];
          const Vector3 along = in.surface.points[in.edges.edges[other].points[1]] -
                                in.surface.points[in.edges.edges[other].points[0]];
          if (next.feature >= 0 || along.cross(line).norm() > coplanar * along.norm() * line.norm())
            continue;
          next.feature = features;
          front.push_back(other);
        }
      }
    }
    ++features;
  }
}

void add_edges(const Joints& in, std::int32_t& features) {
  const int first = static_cast<int>(in.facets.edges.size());
  for (const SurfaceEdge& edge : in.edges.edges) {
    FacetJoint joint = start_joint(in.facets);
    joint.rim = edge.count == 1;
    const Vector3& start = in.surface.points[edge.points[0]];
    const Vector3 along = (in.surface.points[edge.points[1]] - start).normalized();
    for (int s = edge.first; s < edge.first + edge.count && edge.count <= 2; ++s) {
      joint.normal += in.normals[in.edges.sides[s].triangle];
    }
    const SurfaceEdges::Side& own = in.edges.sides[edge.first];
    const SurfaceEdge& all = in.whole_edges.edges[in.whole_edges.of[own.triangle].at(own.side)];
    for (int s = all.first; s < all.first + all.count; ++s) {
      const SurfaceEdges::Side& side = in.whole_edges.sides[s];
      const int tip = in.whole.triangles[side.triangle].at((side.side + 2) % 3);
      const Vector3 to_tip = in.whole.points[tip] - start;
      in.facets.away.push_back((to_tip - to_tip.dot(along) * along).normalized());
      in.facets.faces.push_back(in.plane[side.triangle]);
    }
    end_joint(in.facets, joint);
    in.facets.edges.push_back(joint);
  }
  number_edges(in, first, features);
}

/// Edges and corners of triangles at each point of a surface.
struct Around {
  explicit Around(const TriangleSurface& surface, const SurfaceEdges& found)
      : edges(surface.points.size()), corners(surface.points.size()) {
    for (int e = 0; e < static_cast<int>(found.edges.size()); ++e) {
      for (const int point : found.edges[e].points) edges[point].push_back(e);
    }
    for (int t = 0; t < static_cast<int>(surface.triangles.size()); ++t) {
      for (int c = 0; c < 3; ++c) corners[surface.triangles[t].at(c)].emplace_back(t, c);
    }
  }
  std::vector<std::vector<int>> edges;
  std::vector<std::vector<std::pair<int, int>>> corners;  // (triangle, corner)
};

/// Sum of the normals at a point of a shell, by angle (Baerentzen and Aanaes, IEEE Trans. Vis.
/// Comput. Graph. 11, 2005, 243-253).
Vector3 normal_at(const Joints& in, const Around& around, std::size_t point) {
  Vector3 normal = Vector3::Zero();
  for (const auto& [t, c] : around.corners[point]) {
    const std::array<int, 3>& corners = in.surface.triangles[t];
    const Vector3 a = in.surface.points[corners.at((c + 1) % 3)] - in.surface.points[point];
    const Vector3 b = in.surface.points[corners.at((c + 2) % 3)] - in.surface.points[point];
    normal += std::atan2(a.cross(b).norm(), a.dot(b)) * in.normals[t];
  }
  return normal;
}

/// A corner within a plane or a straight line of edges carries its number.
std::int32_t number_of_vertex(const Joints& in, const Around& around, std::size_t point,
                              const FacetJoint& joint, std::int32_t& features) {
  const int first_edge = static_cast<int>(in.facets.edges.size() - in.edges.edges.size());
  std::vector<std::int32_t> lines;  // of the edges that are not within a plane
  for (const int e : around.edges[point]) {
    const FacetJoint& edge = in.facets.edges[first_edge + e];
    const std::int32_t* const faces = &in.facets.faces[edge.first_face];
    if (edge.face_count != 2 || faces[0] != faces[1]) lines.push_back(edge.feature);
  }
  if (lines.empty()) return in.facets.faces[joint.first_face];
  return lines.size() == 2 && lines[0] == lines[1] ? lines[0] : features++;
}

void add_vertices(const Joints& in, std::int32_t& features) {
  const Around around(in.surface, in.edges);
  const Around all(in.whole, in.whole_edges);
  for (std::size_t p = 0; p < in.surface.points.size(); ++p) {
    FacetJoint joint = start_joint(in.facets);
    bool crowded = false;
    for (const int e : around.edges[p]) {
      joint.rim = joint.rim || in.edges.edges[e].count == 1;
      crowded = crowded || in.edges.edges[e].count > 2;
    }
    if (!crowded) joint.normal = normal_at(in, around, p);
    const auto [own, corner] = around.corners[p].front();
    const int point = in.whole.triangles[own].at(corner);
    for (const int e : all.edges[point]) {
      const std::array<int, 2>& ends = in.whole_edges.edges[e].points;
      const int other = ends[0] == point ? ends[1] : ends[0];
      in.facets.away.push_back((in.whole.points[other] - in.whole.points[point]).normalized());
    }
    for (const auto& [t, c] : all.corners[point]) in.facets.faces.push_back(in.plane[t]);
    end_joint(in.facets, joint);
    joint.feature = number_of_vertex(in, around, p, joint, features);
    in.facets.vertices.push_back(joint);
  }
}

}  // namespace

void add_facets(const TriangleSurface& surface, int index, const std::string& source,
                Facets& facets, std::int32_t& features) {
  Oriented made{surface, {}, 0};
  orient(made, source);
  const TriangleSurface whole = made.surface;
  const SurfaceEdges whole_edges = find_edges(whole);
  split_points(made);
  const SurfaceEdges edges = find_edges(made.surface);
  std::vector<Vector3> normals;
  for (const auto& t : made.surface.triangles) {
    normals.push_back(area_normal(made.surface, t).normalized());
  }
  const std::vector<std::int32_t> plane = find_planes(made.surface, edges, normals, features);
  const int first_shell = static_cast<int>(facets.shells.size());
  const int first_edge = static_cast<int>(facets.edges.size());
  const int first_vertex = static_cast<int>(facets.vertices.size());
  for (std::size_t t = 0; t < made.surface.triangles.size(); ++t) {
    const std::array<int, 3>& corners = made.surface.triangles[t];
    const Vector3& a = made.surface.points[corners[0]];
    WallFacet facet{
        a,          {made.surface.points[corners[1]] - a, made.surface.points[corners[2]] - a},
        normals[t], edges.of[t],
        corners,    first_shell + made.shell[t],
        plane[t]};
    for (int& edge : facet.edges) edge += first_edge;
    for (int& vertex : facet.vertices) vertex += first_vertex;
    facets.facets.push_back(facet);
  }
  facets.shells.resize(facets.shells.size() + static_cast<std::size_t>(made.shells), {index});
  const Joints joints{whole, whole_edges, made.surface, edges, normals, plane, facets};
  add_edges(joints, features);
  add_vertices(joints, features);
}

}  // namespace fluxpact
