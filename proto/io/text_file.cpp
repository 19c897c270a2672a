#include "proto/io/text_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <utility>

#include "proto/base/errors.hpp"

namespace fluxpact {

namespace {

[[noreturn]] void fail(const char* doing, const std::string& path, int reason) {
  throw SystemError(
      "cannot {} '{}': {}. Check that the folder exists, may be written, and has room", doing, path,
      std::strerror(reason));
}

// Returns 0 or the reason why not all of it was written.
int write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

int open_or_fail(const std::string& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC, 0666);
  if (descriptor < 0) fail("open", path, errno);
  return descriptor;
}

// A rename is on the disk only once its folder is.
void synchronise_folder(const std::filesystem::path& file) {
  const std::filesystem::path parent = file.parent_path();
  const std::string folder = parent.empty() ? "." : parent.string();
  const int descriptor = open_or_fail(folder, O_RDONLY | O_DIRECTORY);
  const int reason = ::fsync(descriptor) == 0 ? 0 : errno;
  ::close(descriptor);
  // Some file systems cannot synchronise folders and say so with EINVAL; the rename stands all the
  // same.
  if (reason != 0 && reason != EINVAL) fail("synchronise", folder, reason);
}

}  // namespace

TextFile TextFile::create(const std::filesystem::path& path) {
  return {open_or_fail(path.string(), O_WRONLY | O_CREAT | O_TRUNC), path.string()};
}

TextFile::TextFile(TextFile&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      path_(std::move(other.path_)),
      size_(other.size_) {}

TextFile::~TextFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void TextFile::append(std::string_view text) {
  const int reason = write_all(descriptor_, text);
  if (reason != 0) {
    // Take a torn line back, so that a reader finds whole lines only. Devices cannot, and need not.
    if (::ftruncate(descriptor_, size_) == 0) ::lseek(descriptor_, size_, SEEK_SET);
    fail("write to", path_, reason);
  }
  size_ += static_cast<std::int64_t>(text.size());
}

void TextFile::close() {
  if (descriptor_ < 0) return;
  if (::close(std::exchange(descriptor_, -1)) != 0) fail("close", path_, errno);
}

void replace_file(const std::filesystem::path& path, std::string_view text) {
  const std::string partial = path.string() + ".partial";
  const int descriptor = open_or_fail(partial, O_WRONLY | O_CREAT | O_TRUNC);
  int reason = write_all(descriptor, text);
  if (reason == 0 && ::fsync(descriptor) != 0) reason = errno;
  if (::close(descriptor) != 0 && reason == 0) reason = errno;
  if (reason == 0 && ::rename(partial.c_str(), path.c_str()) != 0) reason = errno;
  if (reason != 0) {
    ::unlink(partial.c_str());
    fail("write", path.string(), reason);
  }
  synchronise_folder(path);
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) fail("open", path.string(), errno);
  std::ostringstream text;
  text << file.rdbuf();
  if (file.bad() || text.bad()) fail("read", path.string(), errno);
  return std::move(text).str();
}

}  // namespace fluxpact
