#include "dem_server/backends/granular/screen.hpp"

#include <spdlog/spdlog.h>

#include <memory>
#include <string_view>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

struct Lines {
  std::string name;
  std::string open;  ///< the line that has not ended yet

  void say(std::string_view line) const {
    if (line.find("ERROR") != std::string_view::npos) {
      spdlog::error("{}: {}", name, line);
    } else if (line.find("WARNING") != std::string_view::npos) {
      spdlog::warn("{}: {}", name, line);
    } else if (!line.empty()) {
      spdlog::debug("{}: {}", name, line);
    }
  }
  void add(std::string_view text) {
    for (const char letter : text) {
      if (letter == '\n') {
        say(open);
        open.clear();
      } else {
        open += letter;
      }
    }
  }
};

ssize_t write_lines(void* cookie, const char* text, std::size_t size) {
  static_cast<Lines*>(cookie)->add({text, size});
  return static_cast<ssize_t>(size);
}

int close_lines(void* cookie) {
  const std::unique_ptr<Lines> lines(static_cast<Lines*>(cookie));
  lines->say(lines->open);
  return 0;
}

}  // namespace

std::FILE* open_log_stream(std::string name) {
  auto lines = std::make_unique<Lines>(Lines{std::move(name), {}});
  std::FILE* const stream =
      fopencookie(lines.get(), "w", {nullptr, write_lines, nullptr, close_lines});
  if (stream == nullptr) throw SystemError("no memory for the stream of an engine's messages");
  static_cast<void>(lines.release());  // close_lines takes it back
  setvbuf(stream, nullptr, _IOLBF, BUFSIZ);
  return stream;
}

}  // namespace fluxpact
