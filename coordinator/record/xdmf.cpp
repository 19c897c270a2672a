#include "coordinator/record/xdmf.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

namespace fluxpact {

namespace {

enum class Number { real, whole, index };

std::string data_item(const std::string& file, const std::string& dataset, const std::string& shape,
                      Number number) {
  const char* type = number == Number::real ? "Float" : "Int";
  const int precision = number == Number::index ? 4 : 8;
  return fmt::format(
      R"(<DataItem Format="HDF" NumberType="{}" Precision="{}" Dimensions="{}">{}:{}</DataItem>)",
      type, precision, shape, file, dataset);
}

std::string attribute(const std::string& file, const XdmfField& field, const char* centre,
                      const std::string& rows) {
  const bool vector = field.components == 3;
  return fmt::format(
      "        <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"{}\">{}</Attribute>\n",
      field.name, vector ? "Vector" : "Scalar", centre,
      data_item(file, field.dataset, vector ? rows + " 3" : rows,
                field.whole ? Number::whole : Number::real));
}

std::string collection(const char* name, const std::string& grids) {
  // A collection without a grid makes readers fail, so there is none before the first record.
  if (grids.empty()) return {};
  return fmt::format(
      "    <Grid Name=\"{}\" GridType=\"Collection\" CollectionType=\"Temporal\">\n{}    </Grid>\n",
      name, grids);
}

std::string grid(const char* name, double time, const std::string& content) {
  return fmt::format(
      "      <Grid Name=\"{}\" GridType=\"Uniform\">\n        <Time Value=\"{}\"/>\n{}      "
      "</Grid>\n",
      name, time, content);
}

// The faces of each cell as lists of points, in the frame of the cell.
class PolyhedronWriter {
 public:
  PolyhedronWriter(const Mesh& mesh, XdmfPolyhedra& drawing) : mesh_(mesh), drawing_(drawing) {
    pair_of_face_.assign(mesh.neighbour.size(), -1);
    for (std::size_t i = 0; i < mesh.periodic_faces.size(); ++i) {
      pair_of_face_[static_cast<std::size_t>(mesh.periodic_faces[i])] = static_cast<int>(i);
    }
  }

  void write_cell(int cell) {
    const auto c = static_cast<std::size_t>(cell);
    constexpr std::int32_t polyhedron = 16;
    drawing_.connectivity.push_back(polyhedron);
    drawing_.connectivity.push_back(mesh_.cell_face_offsets[c + 1] - mesh_.cell_face_offsets[c]);
    for (int k = mesh_.cell_face_offsets[c]; k < mesh_.cell_face_offsets[c + 1]; ++k) {
      write_face(cell, mesh_.cell_faces[static_cast<std::size_t>(k)]);
    }
  }

 private:
  void write_face(int cell, int face) {
    const auto f = static_cast<std::size_t>(face);
    const auto first = mesh_.face_points.begin() + mesh_.face_offsets[f];
    const auto last = mesh_.face_points.begin() + mesh_.face_offsets[f + 1];
    drawing_.connectivity.push_back(static_cast<std::int32_t>(last - first));
    const int periodic = f < pair_of_face_.size() ? pair_of_face_[f] : -1;
    if (periodic < 0 || mesh_.owner[f] == cell) {
      drawing_.connectivity.insert(drawing_.connectivity.end(), first, last);
      return;
    }
    // The face's points stand at the owner; at the neighbour, a translation back, there are none.
    const auto& translation = mesh_.translations[static_cast<std::size_t>(periodic)];
    for (auto point = first; point != last; ++point) {
      drawing_.connectivity.push_back(static_cast<std::int32_t>(drawing_.points.size()));
      drawing_.points.emplace_back(mesh_.points[static_cast<std::size_t>(*point)] - translation);
    }
  }

  const Mesh& mesh_;
  XdmfPolyhedra& drawing_;
  std::vector<int> pair_of_face_;  ///< index into periodic_faces, -1 for other internal faces
};

}  // namespace

XdmfPolyhedra draw_polyhedra(const Mesh& mesh) {
  XdmfPolyhedra drawing;
  drawing.points = mesh.points;
  PolyhedronWriter writer(mesh, drawing);
  for (int cell = 0; cell < mesh.cells(); ++cell) writer.write_cell(cell);
  return drawing;
}

XdmfIndex::XdmfIndex(std::string file, const Lattice& lattice) : file_(std::move(file)) {
  const auto count = [&](std::size_t axis) { return lattice.nodes[axis].size(); };
  cell_shape_ = fmt::format("{} {} {}", count(2) - 1, count(1) - 1, count(0) - 1);
  mesh_ = fmt::format(
      "        <Topology TopologyType=\"3DRectMesh\" Dimensions=\"{} {} {}\"/>\n"
      "        <Geometry GeometryType=\"VXVYVZ\">\n",
      count(2), count(1), count(0));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    mesh_ +=
        "          " +
        data_item(file_, drawn::node_lists[axis], fmt::format("{}", count(axis)), Number::real) +
        "\n";
  }
  mesh_ += "        </Geometry>\n";
}

XdmfIndex::XdmfIndex(std::string file, int cells, const XdmfPolyhedra& polyhedra)
    : file_(std::move(file)), cell_shape_(fmt::format("{}", cells)) {
  mesh_ = fmt::format(
      "        <Topology TopologyType=\"Mixed\" NumberOfElements=\"{}\">{}</Topology>\n"
      "        <Geometry GeometryType=\"XYZ\">{}</Geometry>\n",
      cells,
      data_item(file_, drawn::connectivity, fmt::format("{}", polyhedra.connectivity.size()),
                Number::index),
      data_item(file_, drawn::points, fmt::format("{} 3", polyhedra.points.size()), Number::real));
}

void XdmfIndex::add_fields(double time, const std::vector<XdmfField>& fields) {
  std::string content = mesh_;
  for (const XdmfField& field : fields) content += attribute(file_, field, "Cell", cell_shape_);
  mesh_times_ += grid("fluid", time, content);
}

void XdmfIndex::add_particles(double time, std::size_t count, const std::string& positions,
                              const std::vector<XdmfField>& fields) {
  const std::string rows = fmt::format("{}", count);
  std::string content = fmt::format(
      "        <Topology TopologyType=\"Polyvertex\" NodesPerElement=\"1\" "
      "NumberOfElements=\"{}\"/>\n"
      "        <Geometry GeometryType=\"XYZ\">{}</Geometry>\n",
      count, data_item(file_, positions, rows + " 3", Number::real));
  for (const XdmfField& field : fields) content += attribute(file_, field, "Node", rows);
  particle_times_ += grid("particles", time, content);
}

std::string XdmfIndex::text() const {
  return "<?xml version=\"1.0\" ?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n" +
         collection("fluid", mesh_times_) + collection("particles", particle_times_) +
         "  </Domain>\n</Xdmf>\n";
}

}  // namespace fluxpact
