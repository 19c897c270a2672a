#include "coordinator/record/results_file.hpp"

#include <fmt/format.h>

#include <span>
#include <vector>

#include "coordinator/record/xdmf.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {

namespace {

void write_vectors(Hdf5File& file, const std::string& name, std::span<const Vector3> vectors,
                   const char* units) {
  file.write(name, as_doubles(vectors), {vectors.size(), 3}, units);
}

void write_reals(Hdf5File& file, const std::string& name, std::span<const double> values,
                 const char* units) {
  file.write(name, values, {values.size()}, units);
}

void write_indices(Hdf5File& file, const std::string& name, std::span<const std::int32_t> values) {
  file.write(name, values, {values.size()}, "1");
}

void write_patches(Hdf5File& file, const std::vector<Patch>& patches) {
  std::vector<std::string> names;
  std::vector<std::int32_t> first;
  std::vector<std::int32_t> size;
  for (const Patch& patch : patches) {
    names.push_back(patch.name);
    first.push_back(patch.first);
    size.push_back(patch.size);
  }
  file.write("/mesh/patches/name", names);
  write_indices(file, "/mesh/patches/first", first);
  write_indices(file, "/mesh/patches/size", size);
}

}  // namespace

Hdf5File create_results(const std::filesystem::path& path, const std::string& program_version,
                        Continuity continuity) {
  Hdf5File file = Hdf5File::create(path);
  file.set_attribute("/", "format_version", results_format_version);
  file.set_attribute("/", "program", std::string_view("fluxpact"));
  file.set_attribute("/", "program_version", std::string_view(program_version));
  file.set_attribute(
      "/", "continuity",
      std::string_view(continuity == Continuity::legacy ? "legacy" : "conservative"));
  return file;
}

Hdf5File open_results(const std::filesystem::path& path) {
  Hdf5File file = Hdf5File::open(path);
  const std::int64_t version = file.whole_attribute("/", "format_version");
  if (version > results_format_version) {
    throw SystemError(
        "'{}' has format version {}, this program reads up to {}: use the program that wrote it "
        "({})",
        path.string(), version, results_format_version,
        file.text_attribute("/", "program_version"));
  }
  return file;
}

void write_mesh(Hdf5File& file, const Mesh& mesh) {
  write_vectors(file, "/mesh/points", mesh.points, "m");
  write_indices(file, "/mesh/face_offsets", mesh.face_offsets);
  write_indices(file, "/mesh/face_points", mesh.face_points);
  write_indices(file, "/mesh/owner", mesh.owner);
  write_indices(file, "/mesh/neighbour", mesh.neighbour);
  write_indices(file, "/mesh/periodic_faces", mesh.periodic_faces);
  write_vectors(file, "/mesh/translations", mesh.translations, "m");
  write_vectors(file, "/mesh/face_areas", mesh.face_areas, "m2");
  write_vectors(file, "/mesh/face_centres", mesh.face_centres, "m");
  write_vectors(file, "/mesh/cell_centres", mesh.cell_centres, "m");
  write_reals(file, "/mesh/cell_volumes", mesh.cell_volumes, "m3");
  write_patches(file, mesh.patches);
  if (!mesh.lattice) return;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    write_reals(file, drawn::node_lists[axis], mesh.lattice->nodes[axis], "m");
  }
}

std::string record_name(std::size_t index) { return fmt::format("{:06}", index); }

}  // namespace fluxpact
