#include "cfd_server/discretisation/stencil.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

void add_faces(const Mesh& mesh, Stencil& s) {
  double largest_cross = 0;
  std::vector<Vector3> areas, from_owners, from_neighbours;
  for (auto* vectors : {&areas, &s.cross, &from_owners, &from_neighbours})
    vectors->reserve(static_cast<std::size_t>(s.faces));
  for (auto* values : {&s.weight, &s.conductance})
    values->reserve(static_cast<std::size_t>(s.faces));
  for (int f = 0; f < s.faces; ++f) {
    const bool internal = f < s.internal_faces;
    const Vector3& area = mesh.face_areas[f];
    const Vector3 from_owner = mesh.face_centres[f] - mesh.cell_centres[mesh.owner[f]];
    const Vector3 delta = internal ? mesh.delta[f] : from_owner;
    if (internal && !(delta.dot(area) > 0)) {
      throw ConfigError(
          "mesh: face {} at ({}, {}, {}) has the centres of its two cells on one side (cell {} is "
          "its owner): the cells overlap or are turned inside out; move the points of the mesh",
          f, mesh.face_centres[f].x(), mesh.face_centres[f].y(), mesh.face_centres[f].z(),
          mesh.owner[f]);
    }
    // The bound holds the two-point part where a concave cell sees a face nearly from its edge;
    // what it leaves out is in `cross`.
    const double projected = std::max(delta.dot(area), 0.05 * delta.norm() * area.norm());
    const double conductance = area.squaredNorm() / projected;
    areas.push_back(area);
    const double within_owner = std::abs(from_owner.dot(area));
    const double within_neighbour = std::abs((from_owner - delta).dot(area));
    s.weight.push_back(internal ? within_owner / (within_owner + within_neighbour) : 1.0);
    s.conductance.push_back(conductance);
    s.cross.emplace_back(area - conductance * delta);
    from_owners.push_back(from_owner);
    if (internal) from_neighbours.emplace_back(from_owner - delta);
    largest_cross = std::max(largest_cross, s.cross.back().norm() / area.norm());
  }
  // A lattice is recognised up to a relative 1e-6 of its spacing; what remains of k is rounding.
  s.orthogonal = mesh.lattice.has_value() || largest_cross < 1e-12;
  if (s.orthogonal) s.cross = {};
  const bool lattice = mesh.lattice.has_value();
  s.area = AxisVectors(std::move(areas), lattice);
  s.from_owner = AxisVectors(std::move(from_owners), lattice);
  s.from_neighbour = AxisVectors(std::move(from_neighbours), lattice);
}

void add_sides(const Mesh& mesh, Stencil& s) {
  s.side_offsets.assign(static_cast<std::size_t>(s.cells) + 1, 0);
  for (const int cell : mesh.owner) ++s.side_offsets[cell + 1];
  for (const int cell : mesh.neighbour) ++s.side_offsets[cell + 1];
  for (int cell = 0; cell < s.cells; ++cell) s.side_offsets[cell + 1] += s.side_offsets[cell];
  const auto sides = static_cast<std::size_t>(s.side_offsets.back());
  s.side_face.resize(sides);
  s.side_other.resize(sides);
  s.side_sign.resize(sides);
  std::vector<int> next(s.side_offsets.begin(), s.side_offsets.end() - 1);
  const auto add = [&](int cell, int face, int other, std::int8_t sign) {
    const int side = next[cell]++;
    s.side_face[side] = face;
    s.side_other[side] = other;
    s.side_sign[side] = sign;
  };
  for (int f = 0; f < s.faces; ++f) {
    const bool internal = f < s.internal_faces;
    add(s.owner[f], f, internal ? s.neighbour[f] : -1, 1);
    if (internal) add(s.neighbour[f], f, s.owner[f], -1);
  }
}

std::vector<std::uint8_t> find_few_faces(const Stencil& s) {
  std::vector<std::uint8_t> few(static_cast<std::size_t>(s.cells), 0);
  bool any = false;
  for (int cell = 0; cell < s.cells; ++cell) {
    few[cell] = s.side_offsets[cell + 1] - s.side_offsets[cell] < 6 ? 1 : 0;
    any = any || few[cell] != 0;
  }
  if (!any) few.clear();
  return few;
}

bool has_equal_cells(const Lattice& lattice) {
  return std::ranges::all_of(lattice.nodes, [](const std::vector<double>& nodes) {
    const double mean = (nodes.back() - nodes.front()) / static_cast<double>(nodes.size() - 1);
    for (std::size_t i = 1; i < nodes.size(); ++i) {
      if (std::abs(nodes[i] - nodes[i - 1] - mean) > 1e-6 * mean) return false;
    }
    return true;
  });
}

}  // namespace

Stencil make_stencil(const Mesh& mesh, int threads) {
  Stencil s;
  s.cells = mesh.cells();
  s.faces = mesh.faces();
  s.internal_faces = mesh.internal_faces();
  s.owner = mesh.owner;
  s.neighbour = mesh.neighbour;
  s.volume = mesh.cell_volumes;
  s.centre = mesh.cell_centres;
  add_faces(mesh, s);
  add_sides(mesh, s);
  s.few_faces = find_few_faces(s);
  s.centred = mesh.lattice.has_value();
  s.uniform = mesh.lattice && has_equal_cells(*mesh.lattice);
  s.threads = threads;
  s.shares = share_cells(s.cells, threads, s.owner, s.neighbour);
  return s;
}

int threads_for(int wanted, int cells) {
  constexpr int fewest_cells = 10000;
  const int most = wanted > 0 ? wanted : omp_get_max_threads();
  return std::clamp(cells / fewest_cells, 1, most);
}

}  // namespace fluxpact
