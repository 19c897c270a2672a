// How this folder calls the HDF5 library: every return is checked, every error says what the
// library said. Internal to proto/io: nothing else includes it.
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <functional>
#include <numeric>
#include <string>
#include <string_view>
#include <type_traits>

#include "proto/base/errors.hpp"
#include "proto/io/hdf5.hpp"

namespace fluxpact::hdf5 {

static_assert(std::is_same_v<hid_t, std::int64_t>, "Hdf5Handle holds a hid_t");

// HDF5 keeps its errors on a stack for each thread; the bottom entry is the cause, the top one what
// was asked.
struct ErrorSummary {
  std::string asked;
  std::string cause;
};

// What the system said stands quoted in the middle of a text about buffers and offsets.
inline std::string system_reason(const std::string& text) {
  constexpr std::string_view mark = "error message = '";
  const std::size_t first = text.find(mark);
  if (first == std::string::npos) return text;
  const std::size_t start = first + mark.size();
  return text.substr(start, text.find('\'', start) - start);
}

inline herr_t summarise(unsigned depth, const H5E_error2_t* entry, void* data) {
  auto& summary = *static_cast<ErrorSummary*>(data);
  const std::string text = entry->desc != nullptr ? entry->desc : "";
  if (depth == 0) summary.cause = system_reason(text);
  summary.asked = text;
  return 0;
}

inline std::string what_hdf5_said() {
  ErrorSummary summary;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, summarise, &summary);
  H5Eclear2(H5E_DEFAULT);
  if (summary.cause.empty()) return "nothing";
  return summary.asked == summary.cause ? summary.cause : summary.asked + ": " + summary.cause;
}

[[noreturn]] inline void fail(const char* doing, const std::string& where) {
  throw SystemError(
      "cannot {} '{}'. HDF5 says: {}. Check that the disk has room, that the path may be used, "
      "and that no other program holds the file open",
      doing, where, what_hdf5_said());
}

// Every entry point switches HDF5's own printing off first: the setting belongs to the calling
// thread.
inline void silence() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

inline Hdf5Handle owned(hid_t id, Hdf5Handle::Close close, const char* doing,
                        const std::string& where) {
  if (id < 0) fail(doing, where);
  return {id, close};
}

inline void check(herr_t status, const char* doing, const std::string& where) {
  if (status < 0) fail(doing, where);
}

inline Hdf5Handle text_type(const std::string& where) {
  Hdf5Handle type = owned(H5Tcopy(H5T_C_S1), H5Tclose, "prepare", where);
  check(H5Tset_size(type.id(), H5T_VARIABLE), "prepare", where);
  check(H5Tset_cset(type.id(), H5T_CSET_UTF8), "prepare", where);
  return type;
}

inline std::size_t count_of(const Hdf5Shape& shape) {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

}  // namespace fluxpact::hdf5
