#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "proto/scene/read_scene.hpp"

namespace fluxpact {
namespace {

TEST(SceneReference, is_the_committed_document) {
  std::ifstream file(std::string(FLUXPACT_SOURCE_DIR) + "/docs/scene-reference.md",
                     std::ios::binary);
  const std::string committed((std::istreambuf_iterator<char>(file)),
                              std::istreambuf_iterator<char>());
  EXPECT_TRUE(committed == scene_reference())
      << "docs/scene-reference.md is older than the schema; refresh it: coordinator reference > "
         "docs/scene-reference.md";
}

TEST(SceneReference, has_a_row_for_a_key_with_all_that_the_schema_says) {
  const std::string text = scene_reference();
  for (const char* row : {"| `end_time` | number | s | **required** | > 0 |",
                          "## `fluid.boundaries.NAME`", "## `particles.insertion[]`",
                          "| `convection` | upwind \\| linear_upwind \\| limited | | `limited` | |",
                          "| m | m, cm, mm, um |"}) {
    EXPECT_NE(text.find(row), std::string::npos) << row;
  }
}

}  // namespace
}  // namespace fluxpact
