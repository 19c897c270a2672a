#include "proto/mesh/polymesh.hpp"

#include <algorithm>
#include <map>

#include "proto/io/text_file.hpp"
#include "proto/mesh/mesh_check.hpp"
#include "proto/mesh/mesh_text.hpp"
#include "proto/mesh/periodic_patches.hpp"

namespace fluxpact {
namespace {

using Entries = std::map<std::string, std::string>;

/// The value of an entry as its words: up to a `;`, or to the end of a section.
std::string read_value(MeshText& text, const std::string& key) {
  std::string value;
  int depth = 0;
  const bool section = text.peek() == '{';
  while (true) {
    if (text.at_end()) text.fail("the value of `{}` does not end", key);
    if (text.take('(') || text.take('{')) {
      ++depth;
    } else if (text.take(')') || text.take('}')) {
      if (--depth < 0) text.fail("the value of `{}` does not end with a `;`", key);
      if (section && depth == 0) return value;
    } else if (text.take(';')) {
      if (depth == 0) return value;
    } else {
      if (!value.empty()) value += ' ';
      value += text.word();
    }
  }
}

/// The entries of a dictionary, its brackets included.
Entries read_dictionary(MeshText& text) {
  Entries entries;
  text.expect('{');
  while (!text.take('}')) {
    const std::string key = text.word();
    entries[key] = read_value(text, key);
  }
  return entries;
}

/// A file of the folder, read up to its data, and its class.
struct FoamFile {
  MeshText text;
  std::string type;
};

FoamFile open_file(const std::filesystem::path& folder, const std::string& name) {
  const std::filesystem::path path = folder / name;
  if (!std::filesystem::exists(path)) {
    if (std::filesystem::exists(path.string() + ".gz")) {
      throw ConfigError("{}.gz: compressed files are not read; unpack it: gunzip {}.gz",
                        path.string(), path.string());
    }
    const std::filesystem::path inner = folder / "constant" / "polyMesh";
    throw ConfigError(
        "{}: no such file; a polyMesh folder holds points, faces, owner, neighbour and "
        "boundary{}",
        path.string(),
        std::filesystem::exists(inner / name) ? "; give " + inner.string() : std::string());
  }
  FoamFile file{MeshText(read_file(path), path.string(), Comments::cpp), {}};
  const std::string head = file.text.peek() == 0 ? std::string() : file.text.word();
  if (head != "FoamFile") {
    file.text.fail("`{}` where the header `FoamFile` of an OpenFOAM file is expected", head);
  }
  Entries header = read_dictionary(file.text);
  if (header["format"] != "ascii") {
    file.text.fail(
        "the format is `{}`; only ascii is read: set `writeFormat ascii;` in system/controlDict "
        "and run foamFormatConvert",
        header["format"]);
  }
  file.type = header["class"];
  return file;
}

/// A list of OpenFOAM, `n ( ... )` or `( ... )`: calls `read` for each item.
template <class Read>
void read_items(MeshText& text, std::string_view of_what, int announced, const Read& read) {
  text.expect('(');
  int found = 0;
  while (!text.take(')')) {
    read();
    ++found;
  }
  if (announced >= 0 && found != announced) {
    text.fail("{} {} are announced, {} are there", announced, of_what, found);
  }
}

/// The number before a list, or -1 if there is none.
int announced(MeshText& text) { return text.peek() == '(' ? -1 : text.whole(); }

/// A list of labels. Equal ones may be written `n{value}`; `most` bounds what that may ask for.
std::vector<int> read_labels(MeshText& text, std::string_view of_what, std::size_t most) {
  std::vector<int> labels;
  const int number = announced(text);
  if (number >= 0 && text.take('{')) {
    if (static_cast<std::size_t>(number) > most) {
      text.fail("{} {} where at most {} are possible", number, of_what, most);
    }
    labels.assign(static_cast<std::size_t>(number), text.whole());
    text.expect('}');
    return labels;
  }
  read_items(text, of_what, number, [&] { labels.push_back(text.whole()); });
  return labels;
}

void read_points(const std::filesystem::path& folder, double scale, MeshTopology& mesh) {
  MeshText text = open_file(folder, "points").text;
  const int number = announced(text);
  read_items(text, "points", number, [&] {
    text.expect('(');
    const double x = text.number();
    const double y = text.number();
    const double z = text.number();
    text.expect(')');
    mesh.points.emplace_back(scale * x, scale * y, scale * z);
  });
}

void read_faces(const std::filesystem::path& folder, MeshTopology& mesh) {
  FoamFile file = open_file(folder, "faces");
  MeshText& text = file.text;
  if (file.type == "faceCompactList") {
    constexpr std::size_t most = 1 << 30;
    mesh.face_offsets = read_labels(text, "offsets of faces", most);
    mesh.face_points = read_labels(text, "points of faces", most);
    if (mesh.face_offsets.empty()) text.fail("a compact list of faces has at least one offset");
    return;
  }
  mesh.face_offsets.push_back(0);
  const int number = announced(text);
  read_items(text, "faces", number, [&] {
    const int points = text.whole();
    if (points < 3) text.fail("a face with {} points; it needs at least 3", points);
    text.expect('(');
    for (int i = 0; i < points; ++i) mesh.face_points.push_back(text.whole());
    text.expect(')');
    mesh.face_offsets.push_back(static_cast<int>(mesh.face_points.size()));
  });
}

void read_cells(const std::filesystem::path& folder, MeshTopology& mesh) {
  const std::size_t faces = mesh.face_offsets.size() - 1;
  MeshText owner = open_file(folder, "owner").text;
  mesh.owner = read_labels(owner, "owners", faces);
  if (mesh.owner.size() != faces) {
    owner.fail("{} owners for {} faces", mesh.owner.size(), faces);
  }
  MeshText neighbour = open_file(folder, "neighbour").text;
  mesh.neighbour = read_labels(neighbour, "neighbours", faces);
  // Old versions list all faces, -1 for those of the boundary.
  while (!mesh.neighbour.empty() && mesh.neighbour.back() == -1) mesh.neighbour.pop_back();
}

/// What couples two patches.
struct Cyclic {
  std::string patch;
  std::string other;
  double tolerance = 1e-4;  ///< the default of OpenFOAM: share of the face's size
};

bool contains(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

void check_type(const MeshText& text, const std::string& name, const std::string& type) {
  if (type.starts_with("processor")) {
    text.fail(
        "patch {} has the type {}: this is one part of a decomposed case; run reconstructParMesh "
        "and give the whole mesh",
        name, type);
  }
  if (type != "cyclic" && (contains(type, "cyclic") || contains(type, "Cyclic"))) {
    text.fail(
        "patch {} has the type {}; of the coupled types only `cyclic` is supported, whose faces "
        "match one by one",
        name, type);
  }
}

Cyclic read_cyclic(MeshText& text, const std::string& name, Entries& entries) {
  Cyclic cyclic{name, entries["neighbourPatch"]};
  if (cyclic.other.empty()) text.fail("the cyclic patch {} names no neighbourPatch", name);
  if (contains(entries["transform"], "rotational")) {
    text.fail("the cyclic patch {} is rotational; only translations are supported", name);
  }
  if (!entries["matchTolerance"].empty()) {
    cyclic.tolerance = MeshText(entries["matchTolerance"], text.path(), Comments::none).number();
  }
  return cyclic;
}

std::vector<Cyclic> read_patches(const std::filesystem::path& folder, MeshTopology& mesh) {
  MeshText text = open_file(folder, "boundary").text;
  std::vector<Cyclic> cyclics;
  const int number = announced(text);
  read_items(text, "patches", number, [&] {
    const std::string name = text.word();
    Entries entries = read_dictionary(text);
    const auto label = [&](const char* key) {
      if (entries[key].empty()) text.fail("patch {} has no {}", name, key);
      return MeshText(entries[key], text.path(), Comments::none).whole();
    };
    const Patch patch{name, label("startFace"), label("nFaces")};
    check_type(text, name, entries["type"]);
    if (patch.size == 0) return;
    if (entries["type"] == "cyclic") cyclics.push_back(read_cyclic(text, name, entries));
    mesh.patches.push_back(patch);
  });
  return cyclics;
}

}  // namespace

MeshTopology read_polymesh(const std::filesystem::path& folder, double scale) {
  MeshTopology mesh;
  read_points(folder, scale, mesh);
  read_faces(folder, mesh);
  read_cells(folder, mesh);
  const std::vector<Cyclic> cyclics = read_patches(folder, mesh);
  check_topology(mesh);
  MeshFaults faults;
  find_unused_points(mesh, faults);
  faults.refuse();
  for (const Cyclic& cyclic : cyclics) {
    const auto partner = std::ranges::find(cyclics, cyclic.other, &Cyclic::patch);
    if (partner == cyclics.end() || partner->other != cyclic.patch) {
      throw ConfigError(
          "{}: the cyclic patch {} has the neighbourPatch {}, which is no cyclic patch with the "
          "neighbourPatch {}",
          (folder / "boundary").string(), cyclic.patch, cyclic.other, cyclic.patch);
    }
    const bool joined = std::ranges::find(mesh.patches, cyclic.patch, &Patch::name) ==
                        mesh.patches.end();  // as the partner of an earlier one
    if (!joined) {
      mesh = join_periodic(std::move(mesh), cyclic.patch, cyclic.other,
                           std::max(cyclic.tolerance, partner->tolerance));
    }
  }
  return mesh;
}

}  // namespace fluxpact
