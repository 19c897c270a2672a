// The columns that a table of particles may have, in a CSV file or a dump.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "dem_server/insertion/read_particles.hpp"

namespace fluxpact {

/// A word of a line and where it begins.
struct TextCell {
  std::string_view text;
  int column = 1;  ///< from 1
};

/// Where a line stands, for messages.
struct TextLine {
  const std::string& path;
  int number = 1;
};

/// Which cell of a row holds each quantity.
class ParticleColumns {
 public:
  /// From the names over the columns. With `skip_others` unknown names are left out, else they are
  /// an error. Throws ConfigError if one stands twice, x, y or z is missing, or two of three
  /// components of a vector.
  ParticleColumns(const TextLine& line, const std::vector<TextCell>& names, bool skip_others);

  /// The particle of a row. Throws ConfigError if a cell is no finite number, a size not positive,
  /// or the row has more or fewer cells than there are names.
  ListedParticle read(const TextLine& line, const std::vector<TextCell>& cells) const;

  /// The cell of `id`, or -1.
  int id() const { return at_[id_column]; }

 private:
  static constexpr int columns = 12;
  static constexpr int id_column = 11;
  std::array<int, columns> at_{};
  std::size_t width_ = 0;
};

/// A whole or decimal number. Throws ConfigError `path:line:column` for anything else.
double read_number(const TextLine& line, const TextCell& cell);

/// The frames of a text dump of LAMMPS or LIGGGHTS: particles of the last one.
std::vector<ListedParticle> read_dump(const std::string& path);

/// Particles of an HDF5 file.
std::vector<ListedParticle> read_hdf5_particles(const std::string& path, const std::string& group);

}  // namespace fluxpact
