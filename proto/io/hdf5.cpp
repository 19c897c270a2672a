#include "proto/io/hdf5.hpp"

#include <utility>

#include "proto/io/hdf5_calls.hpp"

namespace fluxpact {

using namespace hdf5;

namespace {

Hdf5Handle make_space(const Hdf5Shape& shape, const std::string& where) {
  const std::vector<hsize_t> extent(shape.begin(), shape.end());
  return owned(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), H5Sclose,
               "describe the shape of", where);
}

// HDF5 could make the groups on the way by itself, but stamps those with the time.
void make_parents(hid_t file, const std::string& name, const std::string& where) {
  const Hdf5Handle creation = owned(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, "prepare", where);
  check(H5Pset_obj_track_times(creation.id(), false), "prepare", where);
  for (std::size_t end = name.find('/', 1); end != std::string::npos;
       end = name.find('/', end + 1)) {
    const std::string group = name.substr(0, end);
    const htri_t there = H5Lexists(file, group.c_str(), H5P_DEFAULT);
    check(there, "look for", where);
    if (there > 0) continue;
    owned(H5Gcreate2(file, group.c_str(), H5P_DEFAULT, creation.id(), H5P_DEFAULT), H5Gclose,
          "make group", where);
  }
}

// Space is filled when it is allocated, or the unused rest of a piece would hold whatever the
// memory held.
Hdf5Handle dataset_creation(const std::string& where) {
  Hdf5Handle list = owned(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "prepare", where);
  check(H5Pset_obj_track_times(list.id(), false), "prepare", where);
  check(H5Pset_fill_time(list.id(), H5D_FILL_TIME_ALLOC), "prepare", where);
  return list;
}

void write_attribute(hid_t object, const std::string& attribute, const void* value,
                     hid_t memory_type, hid_t file_type, const std::string& where) {
  const Hdf5Handle space = owned(H5Screate(H5S_SCALAR), H5Sclose, "write attribute", where);
  const Hdf5Handle id =
      owned(H5Acreate2(object, attribute.c_str(), file_type, space.id(), H5P_DEFAULT, H5P_DEFAULT),
            H5Aclose, "make attribute", where);
  check(H5Awrite(id.id(), memory_type, value), "write attribute", where);
}

void write_text_attribute(hid_t object, const std::string& attribute, std::string_view text,
                          const std::string& where) {
  const std::string terminated(text);
  const char* pointer = terminated.c_str();
  const Hdf5Handle type = text_type(where);
  write_attribute(object, attribute, &pointer, type.id(), type.id(), where);
}

Hdf5Handle open_object(hid_t file, const std::string& name, const std::string& where) {
  return owned(H5Oopen(file, name.c_str(), H5P_DEFAULT), H5Oclose, "find", where);
}

// At the end of the program, HDF5 1.10 visits files that it could not close, and crashes on them: a
// full disk would end as a segmentation fault. Our handles close everything before.
void forgo_exit_handler() { H5dont_atexit(); }

}  // namespace

// ---- handles
// ------------------------------------------------------------------------------------------

Hdf5Handle::Hdf5Handle(Hdf5Handle&& other) noexcept
    : id_(std::exchange(other.id_, -1)), close_(other.close_) {}

Hdf5Handle& Hdf5Handle::operator=(Hdf5Handle&& other) noexcept {
  if (this != &other) {
    reset();
    id_ = std::exchange(other.id_, -1);
    close_ = other.close_;
  }
  return *this;
}

bool Hdf5Handle::reset() {
  if (id_ < 0) return true;
  silence();
  return close_(std::exchange(id_, -1)) >= 0;
}

// ---- columns
// ------------------------------------------------------------------------------------------

void Hdf5Column::append(std::span<const double> rows) {
  append_raw(rows.data(), rows.size(), H5T_NATIVE_DOUBLE);
}

void Hdf5Column::append(std::span<const std::int64_t> rows) {
  append_raw(rows.data(), rows.size(), H5T_NATIVE_INT64);
}

void Hdf5Column::append_raw(const void* rows, std::size_t count, std::int64_t memory_type) {
  if (count == 0) return;
  silence();
  const hsize_t first = rows_;
  const hsize_t added = count;
  const hsize_t extent = first + added;
  check(H5Dset_extent(dataset_.id(), &extent), "grow", where_);
  const Hdf5Handle target = owned(H5Dget_space(dataset_.id()), H5Sclose, "append to", where_);
  check(H5Sselect_hyperslab(target.id(), H5S_SELECT_SET, &first, nullptr, &added, nullptr),
        "append to", where_);
  const Hdf5Handle source =
      owned(H5Screate_simple(1, &added, nullptr), H5Sclose, "append to", where_);
  check(H5Dwrite(dataset_.id(), memory_type, source.id(), target.id(), H5P_DEFAULT, rows),
        "append to", where_);
  rows_ += count;
}

// ---- files
// --------------------------------------------------------------------------------------------

Hdf5File Hdf5File::create(const std::filesystem::path& path) {
  forgo_exit_handler();
  silence();
  const std::string where = path.string();
  const Hdf5Handle access = owned(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "prepare", where);
  check(H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_V18), "prepare", where);
  const Hdf5Handle creation = owned(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "prepare", where);
  check(H5Pset_obj_track_times(creation.id(), false), "prepare", where);
  Hdf5Handle file = owned(H5Fcreate(where.c_str(), H5F_ACC_TRUNC, creation.id(), access.id()),
                          H5Fclose, "create", where);
  return {std::move(file), where};
}

Hdf5File Hdf5File::open(const std::filesystem::path& path) {
  silence();
  const std::string where = path.string();
  return {owned(H5Fopen(where.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "open", where),
          where};
}

void Hdf5File::make_group(const std::string& name) {
  silence();
  make_parents(file_.id(), name + "/", at(name));
}

void Hdf5File::write_raw(const std::string& name, const void* values, std::size_t count,
                         const Hdf5Shape& shape, std::string_view units, std::int64_t memory_type,
                         std::int64_t file_type) {
  silence();
  const std::string where = at(name);
  if (count_of(shape) != count) {
    throw SystemError(
        "'{}' was given {} values for a shape that holds {}: an error of this program", where,
        count, count_of(shape));
  }
  make_parents(file_.id(), name, where);
  const Hdf5Handle space = make_space(shape, where);
  const Hdf5Handle creation = dataset_creation(where);
  Hdf5Handle dataset = owned(H5Dcreate2(file_.id(), name.c_str(), file_type, space.id(),
                                        H5P_DEFAULT, creation.id(), H5P_DEFAULT),
                             H5Dclose, "make dataset", where);
  write_text_attribute(dataset.id(), "units", units, where);
  if (count > 0) {
    check(H5Dwrite(dataset.id(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), "write",
          where);
  }
  if (!dataset.reset()) fail("finish", where);
}

void Hdf5File::write(const std::string& name, std::span<const double> values,
                     const Hdf5Shape& shape, std::string_view units) {
  write_raw(name, values.data(), values.size(), shape, units, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
}

void Hdf5File::write(const std::string& name, std::span<const std::int64_t> values,
                     const Hdf5Shape& shape, std::string_view units) {
  write_raw(name, values.data(), values.size(), shape, units, H5T_NATIVE_INT64, H5T_STD_I64LE);
}

void Hdf5File::write(const std::string& name, std::span<const std::int32_t> values,
                     const Hdf5Shape& shape, std::string_view units) {
  write_raw(name, values.data(), values.size(), shape, units, H5T_NATIVE_INT32, H5T_STD_I32LE);
}

void Hdf5File::write(const std::string& name, const std::vector<std::string>& texts) {
  silence();
  const Hdf5Handle type = text_type(at(name));
  std::vector<const char*> pointers;
  pointers.reserve(texts.size());
  for (const std::string& text : texts) pointers.push_back(text.c_str());
  write_raw(name, pointers.data(), pointers.size(), {texts.size()}, "1", type.id(), type.id());
}

Hdf5Column Hdf5File::make_column(const std::string& name, std::string_view units, std::size_t chunk,
                                 std::int64_t file_type) {
  silence();
  const std::string where = at(name);
  make_parents(file_.id(), name, where);
  const hsize_t none = 0;
  const hsize_t unlimited = H5S_UNLIMITED;
  const hsize_t piece = chunk;
  const Hdf5Handle space =
      owned(H5Screate_simple(1, &none, &unlimited), H5Sclose, "prepare", where);
  const Hdf5Handle creation = dataset_creation(where);
  check(H5Pset_chunk(creation.id(), 1, &piece), "prepare", where);
  Hdf5Handle dataset = owned(H5Dcreate2(file_.id(), name.c_str(), file_type, space.id(),
                                        H5P_DEFAULT, creation.id(), H5P_DEFAULT),
                             H5Dclose, "make dataset", where);
  write_text_attribute(dataset.id(), "units", units, where);
  return {std::move(dataset), where};
}

Hdf5Column Hdf5File::make_real_column(const std::string& name, std::string_view units,
                                      std::size_t chunk) {
  silence();
  return make_column(name, units, chunk, H5T_IEEE_F64LE);
}

Hdf5Column Hdf5File::make_whole_column(const std::string& name, std::string_view units,
                                       std::size_t chunk) {
  silence();
  return make_column(name, units, chunk, H5T_STD_I64LE);
}

void Hdf5File::set_attribute(const std::string& name, const std::string& attribute,
                             std::string_view text) {
  silence();
  const std::string where = at(name) + "@" + attribute;
  const Hdf5Handle object = open_object(file_.id(), name, where);
  write_text_attribute(object.id(), attribute, text, where);
}

void Hdf5File::set_attribute_raw(const std::string& name, const std::string& attribute,
                                 const void* value, std::int64_t memory_type,
                                 std::int64_t file_type) {
  silence();
  const std::string where = at(name) + "@" + attribute;
  const Hdf5Handle object = open_object(file_.id(), name, where);
  write_attribute(object.id(), attribute, value, memory_type, file_type, where);
}

void Hdf5File::set_attribute(const std::string& name, const std::string& attribute, double value) {
  set_attribute_raw(name, attribute, &value, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
}

void Hdf5File::set_attribute(const std::string& name, const std::string& attribute,
                             std::int64_t value) {
  set_attribute_raw(name, attribute, &value, H5T_NATIVE_INT64, H5T_STD_I64LE);
}

void Hdf5File::flush() {
  silence();
  check(H5Fflush(file_.id(), H5F_SCOPE_GLOBAL), "flush", path_);
}

void Hdf5File::close() {
  if (file_.id() < 0) return;
  flush();
  if (!file_.reset()) fail("close", path_);
}

}  // namespace fluxpact
