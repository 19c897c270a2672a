#include "dem_server/insertion/read_particles.hpp"

#include <fstream>

#include "dem_server/insertion/particle_columns.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

TextCell trimmed(std::string_view line, std::size_t begin, std::size_t end) {
  constexpr std::string_view blanks = " \t\r";
  const std::string_view cell = line.substr(begin, end - begin);
  const std::size_t first = cell.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {{}, static_cast<int>(begin) + 1};
  return {cell.substr(first, cell.find_last_not_of(blanks) - first + 1),
          static_cast<int>(begin + first) + 1};
}

std::vector<TextCell> split(std::string_view line) {
  std::vector<TextCell> cells;
  std::size_t begin = 0;
  for (std::size_t comma = line.find(','); comma != std::string_view::npos;
       comma = line.find(',', begin)) {
    cells.push_back(trimmed(line, begin, comma));
    begin = comma + 1;
  }
  cells.push_back(trimmed(line, begin, line.size()));
  return cells;
}

std::vector<ListedParticle> read_csv(std::ifstream& file, const std::string& path) {
  std::string text;
  std::getline(file, text);
  const ParticleColumns columns({path, 1}, split(text), false);
  std::vector<ListedParticle> particles;
  for (int line = 2; std::getline(file, text); ++line) {
    if (trimmed(text, 0, text.size()).text.empty()) continue;
    particles.push_back(columns.read({path, line}, split(text)));
  }
  if (file.bad()) throw ConfigError("{}: reading failed", path);
  return particles;
}

}  // namespace

std::vector<ListedParticle> read_particles(const std::string& path, const std::string& group) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 8> first{};
  file.read(first.data(), static_cast<std::streamsize>(first.size()));
  const std::string_view mark(first.data(), static_cast<std::size_t>(file.gcount()));
  if (mark.empty()) {
    throw ConfigError(
        "{}: cannot be read, or is empty; a CSV file with the header "
        "x,y,z[,vx,vy,vz][,wx,wy,wz][,diameter], an HDF5 file or a LAMMPS dump is needed (the path "
        "is taken from the directory in which the program runs)",
        path);
  }
  if (mark == "\x89HDF\r\n\x1a\n") return read_hdf5_particles(path, group);
  if (!group.empty()) {
    throw ConfigError("{}: `group` names a part of an HDF5 file, and this is none; remove it",
                      path);
  }
  if (mark.starts_with("ITEM:")) return read_dump(path);
  file.clear();
  file.seekg(0);
  return read_csv(file, path);
}

}  // namespace fluxpact
