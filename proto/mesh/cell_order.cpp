#include "proto/mesh/cell_order.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fluxpact {
namespace {

/// Neighbours of each cell across internal faces.
struct Graph {
  std::vector<int> offsets;
  std::vector<int> neighbours;

  int degree(int cell) const { return offsets[cell + 1] - offsets[cell]; }
};

Graph graph_of(const Mesh& mesh) {
  Graph graph;
  graph.offsets.assign(static_cast<std::size_t>(mesh.cells()) + 1, 0);
  for (int face = 0; face < mesh.internal_faces(); ++face) {
    ++graph.offsets[mesh.owner[face] + 1];
    ++graph.offsets[mesh.neighbour[face] + 1];
  }
  std::partial_sum(graph.offsets.begin(), graph.offsets.end(), graph.offsets.begin());
  std::vector<int> next(graph.offsets.begin(), graph.offsets.end() - 1);
  graph.neighbours.resize(static_cast<std::size_t>(graph.offsets.back()));
  for (int face = 0; face < mesh.internal_faces(); ++face) {
    graph.neighbours[next[mesh.owner[face]]++] = mesh.neighbour[face];
    graph.neighbours[next[mesh.neighbour[face]]++] = mesh.owner[face];
  }
  return graph;
}

/// Appends the cells that can be reached from `start`, breadth first, of each cell's neighbours the
/// one with the fewest of its own first.
void visit_from(const Graph& graph, int start, std::vector<char>& seen, std::vector<int>& order) {
  std::size_t done = order.size();
  seen[start] = 1;
  order.push_back(start);
  for (; done < order.size(); ++done) {
    const int cell = order[done];
    const auto first = static_cast<std::ptrdiff_t>(order.size());
    for (int i = graph.offsets[cell]; i < graph.offsets[cell + 1]; ++i) {
      const int other = graph.neighbours[i];
      if (seen[other] != 0) continue;
      seen[other] = 1;
      order.push_back(other);
    }
    std::stable_sort(order.begin() + first, order.end(),
                     [&](int a, int b) { return graph.degree(a) < graph.degree(b); });
  }
}

/// New number of each cell.
std::vector<int> new_numbers(const Graph& graph) {
  const std::size_t cells = graph.offsets.size() - 1;
  std::vector<int> order;
  order.reserve(cells);
  std::vector<char> seen(cells, 0);
  for (std::size_t start = 0; start < cells; ++start) {
    if (seen[start] != 0) continue;
    // The last cell of a first visit lies at an end of its part of the mesh: start there.
    std::vector<int> trial;
    visit_from(graph, static_cast<int>(start), seen, trial);
    for (const int cell : trial) seen[cell] = 0;
    visit_from(graph, trial.back(), seen, order);
  }
  std::vector<int> number(cells);
  for (std::size_t i = 0; i < cells; ++i) number[order[i]] = static_cast<int>(cells - 1 - i);
  return number;
}

/// Mean distance in memory of the two cells of a face.
template <class NumberOf>
double mean_distance(const Mesh& mesh, const NumberOf& number_of) {
  double sum = 0;
  for (int face = 0; face < mesh.internal_faces(); ++face) {
    sum += std::abs(number_of(mesh.owner[face]) - number_of(mesh.neighbour[face]));
  }
  return sum / std::max(1, mesh.internal_faces());
}

/// Internal faces by their lower, then their higher cell; those of a file keep their direction.
std::vector<int> face_order(const Mesh& mesh, const std::vector<int>& number) {
  std::vector<int> order(static_cast<std::size_t>(mesh.internal_faces()));
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int face) {
    const int a = number[mesh.owner[face]];
    const int b = number[mesh.neighbour[face]];
    return std::pair(std::min(a, b), std::max(a, b));
  };
  std::ranges::stable_sort(order, {}, key);
  return order;
}

void add_face(MeshTopology& target, const Mesh& source, int face, const std::vector<int>& number) {
  const auto first = source.face_points.begin() + source.face_offsets[face];
  const auto last = source.face_points.begin() + source.face_offsets[face + 1];
  target.face_points.insert(target.face_points.end(), first, last);
  target.face_offsets.push_back(static_cast<int>(target.face_points.size()));
  target.owner.push_back(number[source.owner[face]]);
}

MeshTopology renumbered(const Mesh& mesh, const std::vector<int>& number) {
  MeshTopology result;
  result.points = mesh.points;
  result.patches = mesh.patches;
  result.face_offsets.push_back(0);
  std::vector<int> pair_of_face(mesh.neighbour.size(), -1);
  for (std::size_t i = 0; i < mesh.periodic_faces.size(); ++i) {
    pair_of_face[mesh.periodic_faces[i]] = static_cast<int>(i);
  }
  for (const int face : face_order(mesh, number)) {
    if (pair_of_face[face] >= 0) {
      result.periodic_faces.push_back(static_cast<int>(result.owner.size()));
      result.translations.push_back(mesh.translations[pair_of_face[face]]);
    }
    add_face(result, mesh, face, number);
    result.neighbour.push_back(number[mesh.neighbour[face]]);
  }
  for (int face = mesh.internal_faces(); face < mesh.faces(); ++face) {
    add_face(result, mesh, face, number);
  }
  return result;
}

}  // namespace

std::optional<MeshTopology> with_cells_in_better_order(const Mesh& mesh) {
  if (mesh.lattice) return std::nullopt;  // its order is what structured methods know
  const std::vector<int> number = new_numbers(graph_of(mesh));
  const double before = mean_distance(mesh, [](int cell) { return cell; });
  const double after = mean_distance(mesh, [&](int cell) { return number[cell]; });
  constexpr double worth_it = 2;
  if (!(before > worth_it * after)) return std::nullopt;
  return renumbered(mesh, number);
}

}  // namespace fluxpact
