// Text files whose every write is checked: a full disk or a missing folder is an error that says
// so.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace fluxpact {

/// A text file that grows at its end. Each `append` is handed to the operating system at once, so
/// what was appended survives the death of this process. Throws SystemError with the path and the
/// system's reason.
class TextFile {
 public:
  /// A new, empty file; one that stood there is lost.
  static TextFile create(const std::filesystem::path& path);
  ~TextFile();
  TextFile(TextFile&& other) noexcept;
  TextFile& operator=(TextFile&&) = delete;

  /// All of `text` or, after an error, none of it.
  void append(std::string_view text);
  /// Closes; network file systems report a full disk only here.
  void close();

 private:
  TextFile(int descriptor, std::string path) : descriptor_(descriptor), path_(std::move(path)) {}

  int descriptor_ = -1;
  std::string path_;
  std::int64_t size_ = 0;  ///< [bytes] of whole appends
};

/// Puts `text` in the place of the file `path` in one step: a reader sees the old file or the new
/// one, whole, even after a power failure. Uses the name `path`.partial on the way. Throws
/// SystemError.
void replace_file(const std::filesystem::path& path, std::string_view text);

/// The whole of a text file. Throws SystemError.
std::string read_file(const std::filesystem::path& path);

}  // namespace fluxpact
