// HDF5 files with RAII and checked returns: what the record of a run is written to and read from.
//
// The same data written in the same order give the same bytes: no time stamps, a fixed library
// version of the format (1.8: readable by every HDF5 in use, and without the "open for writing"
// flag that makes a file unreadable after a crash), fixed little-endian types. Nothing is
// compressed. What was flushed is readable after the writer was killed; what came later may not be.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fluxpact {

/// What HDF5 calls hid_t, closed by the function that fits it.
class Hdf5Handle {
 public:
  using Close = int (*)(std::int64_t);
  Hdf5Handle() = default;
  Hdf5Handle(std::int64_t id, Close close) : id_(id), close_(close) {}
  ~Hdf5Handle() { reset(); }
  Hdf5Handle(Hdf5Handle&& other) noexcept;
  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept;

  std::int64_t id() const { return id_; }
  /// Closes now; false if HDF5 could not (e.g. a full disk).
  bool reset();

 private:
  std::int64_t id_ = -1;
  Close close_ = nullptr;
};

/// Rows, columns, ... of a dataset.
using Hdf5Shape = std::vector<std::size_t>;

/// An open one-dimensional dataset that grows at its end. Belongs to a Hdf5File that must outlive
/// it.
class Hdf5Column {
 public:
  /// Errors: SystemError with the file, the dataset and what HDF5 said.
  void append(std::span<const double> rows);
  void append(std::span<const std::int64_t> rows);
  std::size_t rows() const { return rows_; }

 private:
  friend class Hdf5File;
  Hdf5Column(Hdf5Handle dataset, std::string where)
      : dataset_(std::move(dataset)), where_(std::move(where)) {}
  void append_raw(const void* rows, std::size_t count, std::int64_t memory_type);

  Hdf5Handle dataset_;
  std::string where_;  ///< file and dataset, for messages
  std::size_t rows_ = 0;
};

/// An HDF5 file. Paths inside it are absolute ("/mesh/points"); groups on the way are made when
/// needed. Every function throws SystemError with the file, the object and what HDF5 said.
class Hdf5File {
 public:
  /// A new file; one that stood there is lost.
  static Hdf5File create(const std::filesystem::path& path);
  /// An existing file, to read.
  static Hdf5File open(const std::filesystem::path& path);

  // ---- write ----

  /// With the groups on the way; one that is there already is left as it is.
  void make_group(const std::string& name);

  /// A whole dataset with the attribute `units`. `values` holds the product of `shape`, last index
  /// fastest.
  void write(const std::string& name, std::span<const double> values, const Hdf5Shape& shape,
             std::string_view units);
  void write(const std::string& name, std::span<const std::int64_t> values, const Hdf5Shape& shape,
             std::string_view units);
  void write(const std::string& name, std::span<const std::int32_t> values, const Hdf5Shape& shape,
             std::string_view units);
  /// A list of texts (UTF-8, variable length).
  void write(const std::string& name, const std::vector<std::string>& texts);

  /// Empty columns with the attribute `units`, stored in pieces of `chunk` rows.
  Hdf5Column make_real_column(const std::string& name, std::string_view units, std::size_t chunk);
  Hdf5Column make_whole_column(const std::string& name, std::string_view units, std::size_t chunk);

  /// An attribute of the object `name` ("/" is the file itself).
  void set_attribute(const std::string& name, const std::string& attribute, std::string_view text);
  void set_attribute(const std::string& name, const std::string& attribute, double value);
  void set_attribute(const std::string& name, const std::string& attribute, std::int64_t value);

  /// Hands everything to the operating system: from here on it survives the death of this process.
  void flush();
  /// Flushes and closes; the destructor does so too, but cannot report that it failed.
  void close();

  // ---- read ----

  bool exists(const std::string& name) const;
  /// Names of the members of a group, sorted.
  std::vector<std::string> members(const std::string& group) const;
  Hdf5Shape shape(const std::string& name) const;
  std::vector<double> read_doubles(const std::string& name) const;
  /// Whole numbers of either width; a dataset of reals is an error, not a rounding.
  std::vector<std::int64_t> read_whole(const std::string& name) const;
  std::vector<std::string> read_texts(const std::string& name) const;
  std::string text_attribute(const std::string& name, const std::string& attribute) const;
  double real_attribute(const std::string& name, const std::string& attribute) const;
  std::int64_t whole_attribute(const std::string& name, const std::string& attribute) const;

 private:
  Hdf5File(Hdf5Handle file, std::string path) : file_(std::move(file)), path_(std::move(path)) {}
  std::string at(const std::string& name) const { return path_ + ":" + name; }
  void write_raw(const std::string& name, const void* values, std::size_t count,
                 const Hdf5Shape& shape, std::string_view units, std::int64_t memory_type,
                 std::int64_t file_type);
  Hdf5Column make_column(const std::string& name, std::string_view units, std::size_t chunk,
                         std::int64_t file_type);
  void set_attribute_raw(const std::string& name, const std::string& attribute, const void* value,
                         std::int64_t memory_type, std::int64_t file_type);

  Hdf5Handle file_;
  std::string path_;
};

}  // namespace fluxpact
