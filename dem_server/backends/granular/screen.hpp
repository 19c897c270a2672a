// What a library prints, line by line in our log: warnings and errors as such, the rest for
// --log-level debug. LAMMPS and LIGGGHTS end the process after an error, so its line must be out by
// then.
#pragma once

#include <cstdio>
#include <string>

namespace fluxpact {

/// A stream whose lines go to the log as "`name`: ...". The caller closes it.
std::FILE* open_log_stream(std::string name);

}  // namespace fluxpact
