// STL files as programs write them, damaged ones, and what is measured of a surface.
#include "proto/mesh/stl.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

class SurfaceFile {
 public:
  explicit SurfaceFile(const std::string& bytes)
      : path_(::testing::TempDir() + "fluxpact_" +
              ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".stl") {
    std::ofstream(path_, std::ios::binary) << bytes;
  }
  ~SurfaceFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  SurfaceFile(const SurfaceFile&) = delete;
  SurfaceFile& operator=(const SurfaceFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

using Triangle = std::array<std::array<float, 3>, 3>;

/// A tetrahedron that points out, its corners at the origin and on the axes.
const std::vector<Triangle> tetrahedron{{{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}}},
                                        {{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}},
                                        {{{0, 0, 0}, {0, 0, 1}, {0, 1, 0}}},
                                        {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};

std::string ascii(const std::vector<Triangle>& triangles) {
  std::string text = "solid a name of words\n";
  for (const Triangle& triangle : triangles) {
    text += "  facet normal 0 0 1\n    outer loop\n";
    for (const auto& [x, y, z] : triangle)
      text += fmt::format("      vertex {:e} {:e} {:e}\n", x, y, z);
    text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid a name of words\n";
}

std::string binary(const std::vector<Triangle>& triangles) {
  std::string bytes(80, ' ');
  bytes.replace(0, 5, "solid");  // some programs begin a binary file with the word of the other
  const auto add = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  add(static_cast<std::uint32_t>(triangles.size()));
  for (const Triangle& triangle : triangles) {
    add(std::array<float, 3>{});
    add(triangle);
    add(std::uint16_t{0});
  }
  return bytes;
}

std::string refusal_of(const std::string& bytes) {
  const SurfaceFile file(bytes);
  try {
    read_stl(file.path(), 1);
  } catch (const ConfigError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.substr(0, file.path().size()), file.path());
    return text.substr(file.path().size());
  }
  ADD_FAILURE() << "no error was thrown";
  return {};
}

void expect_in(const std::string& part, const std::string& text) {
  EXPECT_NE(text.find(part), std::string::npos) << "`" << part << "` is not in: " << text;
}

TEST(Stl, ascii_and_binary_files_are_the_same_surface) {
  for (const std::string& bytes : {ascii(tetrahedron), binary(tetrahedron)}) {
    const SurfaceFile file(bytes);
    const TriangleSurface surface = read_stl(file.path(), 1e-3);
    EXPECT_EQ(surface.points.size(), 4U);
    EXPECT_EQ(surface.triangles.size(), 4U);
    EXPECT_NEAR(enclosed_volume(surface), 1e-9 / 6, 1e-24);
    const SurfaceQuality quality = measure_surface(surface);
    EXPECT_TRUE(quality.closed());
    EXPECT_EQ(quality.lower, Vector3(0, 0, 0));
    EXPECT_NEAR(quality.upper.x(), 1e-3, 1e-18);
    EXPECT_NEAR(quality.smallest_area, 0.5e-6, 1e-21);
    EXPECT_NEAR(quality.shortest_edge, 1e-3, 1e-18);
  }
}

TEST(Stl, words_may_be_in_capitals_on_lines_of_windows_and_in_several_solids) {
  std::string text = ascii(tetrahedron);
  text.replace(text.find("facet normal"), 12, "FACET NORMAL");
  for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 2)) {
    text.insert(at, 1, '\r');
  }
  const SurfaceFile file(text + ascii(tetrahedron));
  EXPECT_EQ(read_stl(file.path(), 1).triangles.size(), 8U);
}

TEST(Stl, points_that_differ_by_single_precision_are_one) {
  std::vector<Triangle> rough = tetrahedron;
  rough[1][1][0] = 1.0F + 2e-7F;
  rough[2][2][1] = 1.0F - 2e-7F;
  const SurfaceFile file(binary(rough));
  const TriangleSurface surface = read_stl(file.path(), 1);
  EXPECT_EQ(surface.points.size(), 4U);
  EXPECT_TRUE(measure_surface(surface).closed());
}

TEST(Stl, triangle_that_is_an_edge_is_dropped_and_the_numbers_stay_those_of_the_file) {
  std::vector<Triangle> more = tetrahedron;
  more.insert(more.begin(), {{{0, 0, 0}, {0, 0, 0}, {1, 0, 0}}});
  const SurfaceFile file(ascii(more));
  const TriangleSurface surface = read_stl(file.path(), 1);
  EXPECT_EQ(surface.number, (std::vector<int>{2, 3, 4, 5}));
  EXPECT_TRUE(measure_surface(surface).closed());
}

TEST(Stl, triangle_on_a_line_is_refused_by_its_number) {
  std::vector<Triangle> more = tetrahedron;
  more.push_back({{{0, 0, 0}, {0.5F, 0, 0}, {1, 0, 0}}});
  const std::string text = refusal_of(ascii(more));
  expect_in("triangle 5", text);
  expect_in("on one line", text);
}

TEST(Stl, damaged_files_are_refused_with_line_and_word) {
  std::string text = ascii(tetrahedron);
  text.replace(text.find("vertex"), 6, "vertox");
  expect_in(":4: `vertox` where `vertex` is expected", refusal_of(text));
  text = ascii(tetrahedron);
  text.replace(text.find("0.000000e+00"), 12, "zero");
  expect_in(":4: `zero` is not a finite number", refusal_of(text));
  text = ascii(tetrahedron);
  text.replace(text.find("0.000000e+00"), 12, "nan");
  expect_in(":4: `nan` is not a finite number", refusal_of(text));
  expect_in("ends too early", refusal_of(ascii(tetrahedron).substr(0, 200)));
  text = ascii(tetrahedron);
  expect_in("`endsolid` is missing", refusal_of(text.substr(0, text.find("endsolid"))));
  expect_in("its count of 4 triangles makes 284 bytes, but it has 200",
            refusal_of(binary(tetrahedron).substr(0, 200)));
  expect_in("no triangle in it", refusal_of("solid empty\nendsolid empty\n"));
  expect_in("no triangle in it", refusal_of(binary({})));
  std::vector<Triangle> infinite = tetrahedron;
  infinite[2][1][1] = std::numeric_limits<float>::infinity();
  expect_in("triangle 3: a corner is not finite", refusal_of(binary(infinite)));
  expect_in("smaller than single precision can tell", refusal_of(ascii({Triangle{}})));
}

TEST(Stl, missing_file_is_named) {
  try {
    read_stl("/nowhere/a.stl", 1);
    ADD_FAILURE() << "no error was thrown";
  } catch (const ConfigError& error) {
    expect_in("/nowhere/a.stl: no such file", error.what());
  }
}

TEST(TriangleSurface, open_crowded_and_turned_edges_are_counted) {
  TriangleSurface surface;
  surface.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}};
  surface.triangles = {{0, 1, 2}, {0, 1, 3}};  // both run along the edge 0-1 in one direction
  SurfaceQuality quality = measure_surface(surface);
  EXPECT_EQ(quality.open_edges, 4);
  EXPECT_EQ(quality.turned_edges, 1);
  EXPECT_EQ(quality.crowded_edges, 0);
  surface.triangles.push_back({1, 0, 4});
  quality = measure_surface(surface);
  EXPECT_EQ(quality.open_edges, 6);
  EXPECT_EQ(quality.crowded_edges, 1);
  EXPECT_FALSE(quality.closed());
}

TEST(TriangleSurface, points_are_merged_over_the_borders_of_the_search) {
  // Pairs 0.8 of the tolerance apart, anywhere: also across the cubes in which they are sought.
  TriangleSurface surface;
  constexpr double tolerance = 1e-4;
  for (int n = 0; n < 3000; ++n) {
    const Vector3 at(0.0123 * n - 18, 0.0057 * n, -0.031 * n);
    surface.points.push_back(at);
    surface.points.push_back(at + Vector3(0.8 * tolerance, 0, 0));
    surface.points.push_back(at + Vector3(0, 3 * tolerance, 0));
    surface.triangles.push_back({3 * n, 3 * n + 1, 3 * n + 2});
  }
  const TriangleSurface merged = with_merged_points(surface, tolerance);
  EXPECT_EQ(merged.points.size(), 6000U);
  EXPECT_TRUE(merged.triangles.empty());
}

}  // namespace
}  // namespace fluxpact
