// What no wall can be made of, and which words say so.
#include <functional>

#include "dem_server/walls/room.hpp"
#include "proto/base/errors.hpp"
#include "tests/unit/dem_server/walls/surfaces.hpp"

namespace fluxpact {
namespace {

void expect_refusal(const SurfaceSettings& surface, const std::vector<std::string>& parts) {
  try {
    walls_with(surface);
    ADD_FAILURE() << "no error was thrown";
  } catch (const ConfigError& error) {
    const std::string text = error.what();
    for (const std::string& part : parts) {
      EXPECT_NE(text.find(part), std::string::npos) << "`" << part << "` is not in: " << text;
    }
  }
}

TEST(WallRefusals, directions_without_length_are_named) {
  expect_refusal(plane({0, 0, 0}, {0, 0, 0}), {"particles.surfaces.wall.normal", "no direction"});
  expect_refusal(cylinder({0, 0, 0}, {0, 0, 0}, 1), {"particles.surfaces.wall.direction"});
  SurfaceSettings turning = plane({0, 0, 0}, {0, 0, 1});
  turning.motion.type = MotionType::rotation;
  expect_refusal(turning, {"particles.surfaces.wall.motion.direction"});
}

TEST(WallRefusals, missing_file_is_named) {
  SurfaceSettings surface;
  surface.type = SurfaceType::stl;
  surface.path = "/nowhere/blade.stl";
  expect_refusal(surface, {"/nowhere/blade.stl", "no such file"});
}

TEST(WallRefusals, strip_with_one_side_is_refused) {
  TriangleSurface strip;
  constexpr int n = 12;
  for (int k = 0; k < n; ++k) {
    const double angle = 2 * std::numbers::pi * k / n;
    const Vector3 middle(std::cos(angle), std::sin(angle), 0);
    const Vector3 across = std::cos(angle / 2) * middle + std::sin(angle / 2) * Vector3::UnitZ();
    strip.points.push_back(middle + 0.2 * across);
    strip.points.push_back(middle - 0.2 * across);
  }
  for (int k = 0; k < n; ++k) {
    const int a = 2 * k;
    const int b = 2 * k + 1;
    const int c = k + 1 < n ? a + 2 : 1;
    const int d = k + 1 < n ? b + 2 : 0;
    strip.triangles.push_back({a, b, c});
    strip.triangles.push_back({b, d, c});
  }
  const StlFile file(strip);
  expect_refusal(file.surface(), {file.path(), "one side only", "triangle"});
}

TEST(WallRefusals, inside_of_an_open_file_is_refused_with_its_open_edges) {
  TriangleSurface open = cube(0.5, 1);
  open.triangles.pop_back();
  const StlFile file(open);
  SurfaceSettings surface = file.surface();
  EXPECT_NO_THROW(walls_with(surface));
  surface.side = SurfaceSide::inside;
  expect_refusal(surface, {"particles.surfaces.wall.side", "not closed", "3 open edges"});
}

}  // namespace
}  // namespace fluxpact
