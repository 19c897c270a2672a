#include "proto/message/mesh_message.hpp"

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

template <class T>
std::vector<T> copy_of(std::span<const T> values) {
  return {values.begin(), values.end()};
}

}  // namespace

Message mesh_message(const Mesh& mesh) {
  Message message;
  message.header.type = MessageType::mesh;
  Fields fields;
  fields.add("points", mesh.points);
  fields.add("translations", mesh.translations);
  add_fields(message, fields);
  add_ints(message, "face_offsets", mesh.face_offsets);
  add_ints(message, "face_points", mesh.face_points);
  add_ints(message, "owner", mesh.owner);
  add_ints(message, "neighbour", mesh.neighbour);
  add_ints(message, "periodic_faces", mesh.periodic_faces);
  std::vector<std::string> names;
  for (const Patch& patch : mesh.patches) {
    names.push_back(patch.name);
    message.header.body["patch_size:" + patch.name] = std::int64_t{patch.size};
  }
  message.header.body["patches"] = std::move(names);
  return message;
}

Mesh mesh_of(const Message& message) {
  const Fields fields = fields_of(message);
  MeshTopology mesh;
  const auto vectors = [&](std::string_view name) {
    for (const FieldView& view : fields.views()) {
      if (view.name == name && view.components == 3) return copy_of(as_vectors(view.values));
    }
    throw ProtocolError("message 'mesh': array '{}' is missing or not in rows of 3", name);
  };
  mesh.points = vectors("points");
  mesh.translations = vectors("translations");
  mesh.face_offsets = copy_of(ints(message, "face_offsets"));
  mesh.face_points = copy_of(ints(message, "face_points"));
  mesh.owner = copy_of(ints(message, "owner"));
  mesh.neighbour = copy_of(ints(message, "neighbour"));
  mesh.periodic_faces = copy_of(ints(message, "periodic_faces"));
  int first = static_cast<int>(mesh.neighbour.size());
  for (const std::string& name : texts(message.header, "patches")) {
    const auto size = static_cast<int>(integer(message.header, "patch_size:" + name));
    mesh.patches.push_back({name, first, size});
    first += size;
  }
  return with_geometry(std::move(mesh));
}

std::string fingerprint_text(const MeshTopology& mesh) {
  return fmt::format("{:016x}", fingerprint(mesh));
}

}  // namespace fluxpact
