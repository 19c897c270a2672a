#include "proto/mesh/gmsh.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <map>
#include <unordered_map>

#include "proto/io/text_file.hpp"
#include "proto/mesh/cell_sides.hpp"
#include "proto/mesh/gmsh_elements.hpp"
#include "proto/mesh/mesh_text.hpp"

namespace fluxpact {
namespace {

constexpr const char* how_to_save =
    "save it anew with gmsh: `gmsh FILE -save -format msh41 -o NEW.msh` (ascii is the default, "
    "Mesh.Binary = 0)";

/// An element on a physical surface.
struct LabelledFace {
  std::vector<int> points;
  int surface = 0;
};

/// The sections of a file, in its numbering of nodes from 0 in their order.
struct GmshFile {
  std::map<std::pair<int, int>, std::string> group_names;  ///< by dimension and tag
  std::map<int, int> group_of_surface;                     ///< surfaces in a physical group
  std::unordered_map<long long, int> node_index;           ///< by tag
  std::vector<Vector3> nodes;
  std::vector<char> node_in_volume;  ///< the node was made inside a volume, not on its boundary
  CellSides sides;
  int cells = 0;
  std::vector<LabelledFace> labelled;
};

void read_format(MeshText& text) {
  const std::string version = text.word();
  const int binary = text.whole();
  if (binary != 0) text.fail("the file is binary; only ascii is read: {}", how_to_save);
  if (version != "4.1") text.fail("the format is {}; 4.1 is read: {}", version, how_to_save);
  text.skip_line();
}

void read_group_names(MeshText& text, GmshFile& file) {
  const int groups = text.count("physical groups", 4);
  for (int i = 0; i < groups; ++i) {
    const int dimension = text.whole();
    const int tag = text.whole();
    file.group_names[{dimension, tag}] = text.word();
  }
}

void read_entities(MeshText& text, GmshFile& file) {
  std::array<int, 4> counts{};
  for (int& count : counts) count = text.count("entities", 4);
  for (int dimension = 0; dimension < 4; ++dimension) {
    for (int i = 0; i < counts.at(dimension); ++i) {
      const int tag = text.whole();
      for (int bound = 0; bound < (dimension == 0 ? 3 : 6); ++bound) text.number();
      const int groups = text.count("physical groups", 2);
      for (int g = 0; g < groups; ++g) {
        const int group = std::abs(text.whole());  // negative: the surface is turned over
        if (dimension == 2 && !file.group_of_surface.emplace(tag, group).second) {
          text.fail(
              "surface {} is in the physical groups {} and {}; a face has one patch: take the "
              "surface out of one of them",
              tag, file.group_of_surface.at(tag), group);
        }
      }
      const int boundaries = dimension == 0 ? 0 : text.count("boundaries", 2);
      for (int b = 0; b < boundaries; ++b) text.whole();
    }
  }
}

void read_nodes(MeshText& text, GmshFile& file, double scale) {
  const int blocks = text.count("blocks of nodes", 2);
  const int nodes = text.count("nodes", 2);
  file.node_index.reserve(static_cast<std::size_t>(nodes));
  text.tag();  // lowest tag
  text.tag();  // highest tag
  std::vector<long long> tags;
  for (int block = 0; block < blocks; ++block) {
    const int dimension = text.whole();
    text.whole();  // entity
    const int parameters = text.whole() != 0 ? dimension : 0;
    tags.resize(static_cast<std::size_t>(text.count("nodes", 2)));
    for (long long& tag : tags) tag = text.tag();
    for (const long long tag : tags) {
      const double x = text.number();
      const double y = text.number();
      const double z = text.number();
      for (int p = 0; p < parameters; ++p) text.number();
      if (!file.node_index.emplace(tag, static_cast<int>(file.nodes.size())).second) {
        text.fail("node {} stands here a second time", tag);
      }
      file.nodes.emplace_back(scale * x, scale * y, scale * z);
      file.node_in_volume.push_back(dimension == 3 ? 1 : 0);
    }
  }
}

int read_node(MeshText& text, const GmshFile& file) {
  const long long tag = text.tag();
  const auto found = file.node_index.find(tag);
  if (found == file.node_index.end())
    text.fail("an element names node {}, which is not there", tag);
  return found->second;
}

void read_cells(MeshText& text, GmshFile& file, int type, int elements) {
  const GmshCell* const cell = find_gmsh_cell(type);
  if (cell == nullptr) {
    text.fail(
        "elements of type {} ({}) are not supported; cells are tetrahedra, hexahedra, prisms or "
        "pyramids of the first order (Mesh.ElementOrder = 1)",
        type, gmsh_type_name(type));
  }
  std::vector<int> nodes(static_cast<std::size_t>(cell->nodes));
  std::vector<int> ring;
  for (int i = 0; i < elements; ++i) {
    text.tag();
    for (int& node : nodes) node = read_node(text, file);
    for (const auto& side : cell->sides) {
      ring.clear();
      for (const int corner : side) {
        if (corner >= 0) ring.push_back(nodes[corner]);
      }
      file.sides.add(file.cells, ring);
    }
    ++file.cells;
  }
}

void read_labelled(MeshText& text, GmshFile& file, int surface, int type, int elements) {
  constexpr int triangle = 2;
  constexpr int quadrangle = 3;
  if (type != triangle && type != quadrangle) {
    text.fail(
        "surface {} has elements of type {} ({}); faces are triangles or quadrangles of the "
        "first order (Mesh.ElementOrder = 1)",
        surface, type, gmsh_type_name(type));
  }
  for (int i = 0; i < elements; ++i) {
    text.tag();
    LabelledFace face{{}, surface};
    for (int p = 0; p < (type == triangle ? 3 : 4); ++p) {
      face.points.push_back(read_node(text, file));
    }
    file.labelled.push_back(std::move(face));
  }
}

void read_elements(MeshText& text, GmshFile& file) {
  const int blocks = text.count("blocks of elements", 2);
  text.count("elements", 2);
  text.tag();  // lowest tag
  text.tag();  // highest tag
  for (int block = 0; block < blocks; ++block) {
    const int dimension = text.whole();
    const int entity = text.whole();
    const int type = text.whole();
    const int elements = text.count("elements", 2);
    if (dimension == 3) {
      read_cells(text, file, type, elements);
    } else if (dimension == 2 && file.group_of_surface.contains(entity)) {
      read_labelled(text, file, entity, type, elements);
    } else {
      text.skip_line();
      for (int i = 0; i < elements; ++i) text.skip_line();
    }
  }
}

void skip_section(MeshText& text, const std::string& name) {
  const std::string end = "$End" + name.substr(1);
  while (!text.at_end()) {
    if (text.rest_of_line() == end) return;
  }
  text.fail("the section {} does not end", name);
}

GmshFile read_sections(const std::filesystem::path& path, double scale) {
  MeshText text(read_file(path), path.string(), Comments::none);
  GmshFile file;
  const std::string head = text.at_end() ? std::string() : text.word();
  if (head != "$MeshFormat") text.fail("the file does not start as a mesh of Gmsh, $MeshFormat");
  read_format(text);
  skip_section(text, "$MeshFormat");
  while (!text.at_end()) {
    const std::string section = text.word();
    if (section == "$PartitionedEntities") {
      text.fail("the mesh is cut into partitions; save it without (Mesh.SavePartitions...)");
    } else if (section == "$PhysicalNames") {
      read_group_names(text, file);
    } else if (section == "$Entities") {
      read_entities(text, file);
    } else if (section == "$Nodes") {
      read_nodes(text, file, scale);
    } else if (section == "$Elements") {
      read_elements(text, file);
    } else {
      skip_section(text, section);
      continue;
    }
    if (text.word() != "$End" + section.substr(1))
      text.fail("$End{} is expected", section.substr(1));
  }
  if (file.cells == 0) {
    text.fail(
        "there are no volume elements; mesh in three dimensions (gmsh -3), and if there are "
        "physical groups let one hold the volumes, else Gmsh does not save them");
  }
  return file;
}

/// Leaves out the nodes of the geometry that no cell uses.
void drop_construction_nodes(GmshFile& file) {
  std::vector<int> place(file.nodes.size(), -1);
  for (const int node : file.sides.points) place[node] = 0;
  std::vector<Vector3> kept;
  for (std::size_t node = 0; node < file.nodes.size(); ++node) {
    if (place[node] < 0 && file.node_in_volume[node] == 0) continue;
    place[node] = static_cast<int>(kept.size());
    kept.push_back(file.nodes[node]);
  }
  file.nodes = std::move(kept);
  for (int& node : file.sides.points) node = place[node];
  for (LabelledFace& face : file.labelled) {
    for (int& node : face.points) node = place[node];
  }
}

using FaceKey = std::array<int, 4>;

FaceKey key_of(std::span<const int> ring) {
  // Triangles are filled up with a number that no node has.
  constexpr int none = std::numeric_limits<int>::max();
  FaceKey key{none, none, none, none};
  std::ranges::copy(ring, key.begin());
  std::ranges::sort(key);
  return key;
}

std::string name_of_group(const GmshFile& file, int group) {
  const auto named = file.group_names.find({2, group});
  return named == file.group_names.end() ? fmt::format("physical_{}", group) : named->second;
}

[[noreturn]] void refuse_labelled(const GmshFile& file, const LabelledFace& face, int refused,
                                  const std::filesystem::path& path) {
  const bool node_missing = std::ranges::find(face.points, -1) != face.points.end();
  bool between = false;
  for (int side = 0; side < file.sides.size() && !node_missing && !between; ++side) {
    between = key_of(file.sides.ring(side)) == key_of(face.points);
  }
  Vector3 middle = Vector3::Zero();
  double points = 0;
  for (const int point : face.points) {
    if (point < 0) continue;
    middle += file.nodes[point];
    ++points;
  }
  if (points > 0) middle /= points;
  throw ConfigError(
      "{}: {} faces of physical surfaces are no boundary of the cells; the first, of {} (surface "
      "{}) near ({:.6g}, {:.6g}, {:.6g}) m, {}",
      path.string(), refused, name_of_group(file, file.group_of_surface.at(face.surface)),
      face.surface, middle.x(), middle.y(), middle.z(),
      between ? "lies between two cells: a patch is on the boundary, take the surface out of its "
                "physical group"
              : "belongs to no cell: put the volume behind it into a physical volume, or mesh the "
                "two so that they match (Coherence)");
}

/// The patch of each boundary face: an index into `names`.
std::vector<int> patches_of(const GmshFile& file, const MatchedSides& matched,
                            const std::filesystem::path& path, std::vector<std::string>& names) {
  std::vector<std::pair<FaceKey, int>> keys;
  for (std::size_t i = 0; i < matched.single.size(); ++i) {
    keys.emplace_back(key_of(file.sides.ring(matched.single[i])), static_cast<int>(i));
  }
  std::ranges::sort(keys);
  std::map<int, int> index;  // of a group in names
  for (const auto& [surface, group] : file.group_of_surface) index[group] = 0;
  const auto index_of = [&](const std::string& name) {
    const auto found = std::ranges::find(names, name);
    if (found != names.end()) return static_cast<int>(found - names.begin());
    names.push_back(name);
    return static_cast<int>(names.size()) - 1;
  };
  for (auto& [group, place] : index) place = index_of(name_of_group(file, group));
  std::vector<int> patch(matched.single.size(), index_of("walls"));
  const LabelledFace* first_refused = nullptr;
  int refused = 0;
  for (const LabelledFace& face : file.labelled) {
    const FaceKey key = key_of(face.points);
    const auto found = std::ranges::lower_bound(keys, key, {}, &std::pair<FaceKey, int>::first);
    if (found == keys.end() || found->first != key) {
      if (refused++ == 0) first_refused = &face;
    } else {
      patch[found->second] = index.at(file.group_of_surface.at(face.surface));
    }
  }
  if (first_refused != nullptr) refuse_labelled(file, *first_refused, refused, path);
  return patch;
}

}  // namespace

MeshTopology read_gmsh(const std::filesystem::path& path, double scale) {
  GmshFile file = read_sections(path, scale);
  drop_construction_nodes(file);
  const MatchedSides matched = match_sides(file.sides, file.nodes);
  std::vector<std::string> names;
  const std::vector<int> patches = patches_of(file, matched, path, names);
  return mesh_of_sides(std::move(file.nodes), file.sides, matched, patches, names);
}

}  // namespace fluxpact
