// Text dumps of LAMMPS and LIGGGHTS: frames of
//   ITEM: TIMESTEP / ITEM: NUMBER OF ATOMS / ITEM: BOX BOUNDS ... / ITEM: ATOMS <names of columns>
#include <algorithm>
#include <fstream>
#include <numeric>

#include "dem_server/insertion/particle_columns.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

constexpr std::string_view count_item = "ITEM: NUMBER OF ATOMS";
constexpr std::string_view atoms_item = "ITEM: ATOMS";

std::vector<TextCell> words_of(std::string_view line, std::size_t begin) {
  constexpr std::string_view blanks = " \t\r";
  std::vector<TextCell> words;
  std::size_t first = line.find_first_not_of(blanks, begin);
  while (first != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(blanks, first), line.size());
    words.push_back({line.substr(first, end - first), static_cast<int>(first) + 1});
    first = line.find_first_not_of(blanks, end);
  }
  return words;
}

/// A dump on its way: the frame that was read last.
struct Dump {
  std::ifstream file;
  const std::string& path;
  int line = 0;
  std::string text;
  std::vector<ListedParticle> particles;
  std::vector<double> id;

  TextLine here() const { return {path, line}; }
  bool next() {
    ++line;
    return static_cast<bool>(std::getline(file, text));
  }
  void expect_next(const char* what) {
    if (next()) return;
    throw ConfigError("{}:{}: the file ends where {} should stand; is the last frame whole?", path,
                      line, what);
  }
};

void read_frame(Dump& dump, double count) {
  const ParticleColumns columns(dump.here(), words_of(dump.text, atoms_item.size()), true);
  dump.particles.clear();
  dump.id.clear();
  for (double row = 0; row < count; ++row) {
    dump.expect_next("an atom");
    const std::vector<TextCell> words = words_of(dump.text, 0);
    dump.particles.push_back(columns.read(dump.here(), words));
    dump.id.push_back(columns.id() < 0 ? row : read_number(dump.here(), words[columns.id()]));
  }
}

}  // namespace

std::vector<ListedParticle> read_dump(const std::string& path) {
  Dump dump{std::ifstream(path), path, 0, {}, {}, {}};
  double count = -1;
  bool any = false;
  while (dump.next()) {
    if (dump.text.starts_with(count_item)) {
      dump.expect_next("the number of atoms");
      const std::vector<TextCell> words = words_of(dump.text, 0);
      if (words.size() != 1) {
        throw ConfigError("{}:{}: the number of atoms should stand here", path, dump.line);
      }
      count = read_number(dump.here(), words.front());
    } else if (dump.text.starts_with(atoms_item)) {
      if (count < 0) {
        throw ConfigError("{}:{}: `{}` comes before `{}`", path, dump.line, atoms_item, count_item);
      }
      read_frame(dump, count);
      any = true;
    }
  }
  if (!any) throw ConfigError("{}: no `{}` in this dump", path, atoms_item);
  std::vector<std::size_t> order(dump.id.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return dump.id[a] < dump.id[b]; });
  std::vector<ListedParticle> sorted;
  sorted.reserve(order.size());
  for (const std::size_t row : order) sorted.push_back(dump.particles[row]);
  return sorted;
}

}  // namespace fluxpact
