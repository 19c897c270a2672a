#include <algorithm>

#include "proto/io/hdf5.hpp"
#include "proto/io/hdf5_calls.hpp"

namespace fluxpact {

using namespace hdf5;

namespace {

Hdf5Handle open_dataset(hid_t file, const std::string& name, const std::string& where) {
  return owned(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose, "find dataset", where);
}

Hdf5Shape shape_of(hid_t dataset, const std::string& where) {
  const Hdf5Handle space = owned(H5Dget_space(dataset), H5Sclose, "read the shape of", where);
  const int rank = H5Sget_simple_extent_ndims(space.id());
  if (rank < 0) fail("read the shape of", where);
  std::vector<hsize_t> extent(static_cast<std::size_t>(rank));
  check(H5Sget_simple_extent_dims(space.id(), extent.data(), nullptr), "read the shape of", where);
  return {extent.begin(), extent.end()};
}

// A conversion between kinds (reals to whole numbers) would be silent in HDF5.
void require_class(hid_t type, H5T_class_t expected, const char* kind, const std::string& where) {
  if (H5Tget_class(type) != expected) {
    throw SystemError("'{}' does not hold {}: it was not written by this version of the program",
                      where, kind);
  }
}

// Contiguous values of a dataset, converted to the width asked for.
template <class T>
std::vector<T> read_values(hid_t file, const std::string& name, H5T_class_t expected,
                           const char* kind, hid_t memory_type, const std::string& where) {
  const Hdf5Handle dataset = open_dataset(file, name, where);
  const Hdf5Handle type = owned(H5Dget_type(dataset.id()), H5Tclose, "read the type of", where);
  require_class(type.id(), expected, kind, where);
  std::vector<T> values(count_of(shape_of(dataset.id(), where)));
  if (values.empty()) return values;
  check(H5Dread(dataset.id(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "read",
        where);
  return values;
}

Hdf5Handle open_attribute(hid_t file, const std::string& name, const std::string& attribute,
                          H5T_class_t expected, const char* kind, const std::string& where) {
  Hdf5Handle id =
      owned(H5Aopen_by_name(file, name.c_str(), attribute.c_str(), H5P_DEFAULT, H5P_DEFAULT),
            H5Aclose, "find attribute", where);
  const Hdf5Handle type = owned(H5Aget_type(id.id()), H5Tclose, "read attribute", where);
  require_class(type.id(), expected, kind, where);
  return id;
}

}  // namespace

bool Hdf5File::exists(const std::string& name) const {
  silence();
  // HDF5 asks that every link on the way is there before it tells about the last one.
  for (std::size_t end = name.find('/', 1); true; end = name.find('/', end + 1)) {
    const std::string link = name.substr(0, end);
    if (link != "/" && H5Lexists(file_.id(), link.c_str(), H5P_DEFAULT) <= 0) return false;
    if (end == std::string::npos) return true;
  }
}

std::vector<std::string> Hdf5File::members(const std::string& group) const {
  silence();
  const std::string where = at(group);
  const Hdf5Handle id =
      owned(H5Gopen2(file_.id(), group.c_str(), H5P_DEFAULT), H5Gclose, "find group", where);
  std::vector<std::string> names;
  const auto collect = [](hid_t, const char* name, const H5L_info_t*, void* data) -> herr_t {
    static_cast<std::vector<std::string>*>(data)->emplace_back(name);
    return 0;
  };
  check(H5Literate(id.id(), H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, collect, &names), "list",
        where);
  std::ranges::sort(names);
  return names;
}

Hdf5Shape Hdf5File::shape(const std::string& name) const {
  silence();
  const std::string where = at(name);
  return shape_of(open_dataset(file_.id(), name, where).id(), where);
}

std::vector<double> Hdf5File::read_doubles(const std::string& name) const {
  silence();
  return read_values<double>(file_.id(), name, H5T_FLOAT, "real numbers", H5T_NATIVE_DOUBLE,
                             at(name));
}

std::vector<std::int64_t> Hdf5File::read_whole(const std::string& name) const {
  silence();
  return read_values<std::int64_t>(file_.id(), name, H5T_INTEGER, "whole numbers", H5T_NATIVE_INT64,
                                   at(name));
}

std::vector<std::string> Hdf5File::read_texts(const std::string& name) const {
  silence();
  const std::string where = at(name);
  const Hdf5Handle type = text_type(where);
  const std::vector<char*> pointers =
      read_values<char*>(file_.id(), name, H5T_STRING, "texts", type.id(), where);
  std::vector<std::string> texts;
  for (char* text : pointers) {
    texts.emplace_back(text != nullptr ? text : "");
    H5free_memory(text);
  }
  return texts;
}

std::string Hdf5File::text_attribute(const std::string& name, const std::string& attribute) const {
  silence();
  const std::string where = at(name) + "@" + attribute;
  const Hdf5Handle id = open_attribute(file_.id(), name, attribute, H5T_STRING, "a text", where);
  const Hdf5Handle type = text_type(where);
  char* pointer = nullptr;
  check(H5Aread(id.id(), type.id(), static_cast<void*>(&pointer)), "read attribute", where);
  std::string text = pointer != nullptr ? pointer : "";
  H5free_memory(pointer);
  return text;
}

double Hdf5File::real_attribute(const std::string& name, const std::string& attribute) const {
  silence();
  const std::string where = at(name) + "@" + attribute;
  double value = 0;
  check(H5Aread(open_attribute(file_.id(), name, attribute, H5T_FLOAT, "a real number", where).id(),
                H5T_NATIVE_DOUBLE, &value),
        "read attribute", where);
  return value;
}

std::int64_t Hdf5File::whole_attribute(const std::string& name,
                                       const std::string& attribute) const {
  silence();
  const std::string where = at(name) + "@" + attribute;
  std::int64_t value = 0;
  check(H5Aread(
            open_attribute(file_.id(), name, attribute, H5T_INTEGER, "a whole number", where).id(),
            H5T_NATIVE_INT64, &value),
        "read attribute", where);
  return value;
}

}  // namespace fluxpact
