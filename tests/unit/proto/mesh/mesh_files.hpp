// What the tests of the mesh readers share: the files of the real tools, and messages of refusals.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numeric>
#include <sstream>
#include <string>

#include "proto/base/errors.hpp"
#include "proto/mesh/mesh.hpp"
#include "tests/unit/proto/io/scratch_folder.hpp"

namespace fluxpact {

inline std::filesystem::path mesh_file(const std::string& name) {
  return std::filesystem::path(FLUXPACT_SOURCE_DIR) / "tests/data/meshes" / name;
}

inline std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  EXPECT_FALSE(text.str().empty()) << path;
  return text.str();
}

inline void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// The text with the one occurrence of a part replaced.
inline std::string changed(std::string text, const std::string& part, const std::string& by) {
  const std::size_t at = text.find(part);
  EXPECT_NE(at, std::string::npos) << part;
  return at == std::string::npos ? text : text.replace(at, part.size(), by);
}

inline double total_volume(const Mesh& mesh) {
  return std::accumulate(mesh.cell_volumes.begin(), mesh.cell_volumes.end(), 0.0);
}

inline int faces_of(const Mesh& mesh, const std::string& patch) {
  const Patch* found = mesh.find_patch(patch);
  return found == nullptr ? 0 : found->size;
}

/// Exactly this call is refused, with all of these words.
template <class Call>
void expect_refusal(const Call& call, const std::vector<std::string>& words) {
  try {
    call();
    ADD_FAILURE() << "accepted";
  } catch (const ConfigError& error) {
    for (const std::string& word : words) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos)
          << "no `" << word << "` in: " << error.what();
    }
  }
}

}  // namespace fluxpact
