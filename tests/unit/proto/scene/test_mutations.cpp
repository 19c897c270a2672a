// Garbled scenes: whatever the text, reading it gives a scene or a ConfigError, never anything
// else.
#include <random>
#include <sstream>

#include "tests/unit/proto/scene/scene_text.hpp"

namespace fluxpact {
namespace {

using Lines = std::vector<std::string>;

Lines lines_of(const std::string& text) {
  Lines lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    lines.push_back(line);
  }
  return lines;
}

std::size_t below(std::size_t limit, std::mt19937_64& random) { return random() % limit; }

const std::vector<std::string> tokens{"[",     "]",     "{",
                                      "}",     ":",     "- ",
                                      "&a ",   "*a",    "!!str ",
                                      "\"",    "'",     "|",
                                      ">",     "?",     "#",
                                      "%",     "@",     "~",
                                      "null",  "yes",   "-1",
                                      "0",     "1e400", ".nan",
                                      "012",   "\t",    "\n",
                                      "\r",    "---\n", "...\n",
                                      "<<",    "\xff",  "\xef\xbb\xbf",
                                      "walls", "1 mm",  "9999999999",
                                      "\\x",   ", ",    "  "};

void mutate(Lines& lines, std::mt19937_64& random) {
  const std::size_t at = below(lines.size(), random);
  const std::size_t other = below(lines.size(), random);
  std::string& line = lines[at];
  switch (below(7, random)) {
    case 0:
      lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(at));
      break;
    case 1:
      lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(at), std::string(lines[other]));
      break;
    case 2:
      std::swap(line, lines[other]);
      break;
    case 3:
      line.insert(below(line.size() + 1, random), tokens[below(tokens.size(), random)]);
      break;
    case 4:
      line.erase(below(line.size() + 1, random), 1 + below(4, random));
      break;
    case 5:
      line.resize(below(line.size() + 1, random));
      break;
    default:
      if (!line.empty()) {
        line[below(line.size(), random)] = static_cast<char>(random() % 256);
      }
  }
}

TEST(Mutations, end_in_a_scene_or_a_config_error) {
  constexpr std::uint64_t seed = 20111;
  constexpr int rounds = 4000;
  int refused = 0;
  for (int round = 0; round < rounds; ++round) {
    std::mt19937_64 random(seed + static_cast<std::uint64_t>(round));
    Lines lines = lines_of(valid_scene);
    for (std::size_t i = 1 + below(4, random); i > 0 && !lines.empty(); --i) {
      mutate(lines, random);
    }
    std::string text;
    for (const std::string& line : lines) {
      text += line + '\n';
    }
    try {
      const Scene scene = read_scene(text, "s.yaml");
      const std::string written = write_scene(scene);
      EXPECT_EQ(write_scene(read_scene(written, "written")), written)
          << "seed " << seed << " round " << round;
    } catch (const ConfigError& error) {
      ++refused;
      EXPECT_EQ(std::string(error.what()).substr(0, 7), "s.yaml:")
          << "seed " << seed << " round " << round;
    } catch (const std::exception& error) {
      ADD_FAILURE() << "seed " << seed << " round " << round << ": " << error.what() << "\n"
                    << text;
    }
  }
  // Most mutations hit something: a reader that refuses few of them overlooks mistakes.
  EXPECT_GT(refused, rounds / 2);
}

}  // namespace
}  // namespace fluxpact
