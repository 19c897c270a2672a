// What this build is.
#pragma once

#include <string>

namespace fluxpact {

/// Version and git revision in one line, e.g. "fluxpact 0.1.0 (1a2b3c4)".
std::string version_line();

/// The same with compiler and libraries, a line each: what `--version` prints.
std::string version_text();

}  // namespace fluxpact
