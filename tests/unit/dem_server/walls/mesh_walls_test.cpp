// Walls and room of meshes that are no boxes.
#include "dem_server/walls/mesh_surface.hpp"
#include "dem_server/walls/room.hpp"
#include "proto/mesh/gmsh.hpp"
#include "tests/unit/dem_server/walls/surfaces.hpp"

namespace fluxpact {
namespace {

/// The pipe of configs/bed_in_a_pipe.yaml: radius 25 mm, from z = 0 (inlet) to 150 mm (outlet).
class PipeWalls : public ::testing::Test {
 protected:
  PipeWalls()
      : mesh_(with_geometry(
            read_gmsh(std::string(FLUXPACT_SOURCE_DIR) + "/configs/meshes/pipe.msh", 1e-3))) {
    scene_.fluid.boundaries["inlet"].type = BoundaryType::velocity;
    scene_.fluid.boundaries["outlet"].type = BoundaryType::pressure;
    scene_.fluid.boundaries["pipe"].type = BoundaryType::wall;
  }
  Scene scene_ = wall_scene();
  Mesh mesh_;
};

TEST_F(PipeWalls, domain_has_walls_where_faces_lie_and_is_open_elsewhere) {
  const Domain domain = particle_domain(scene_, mesh_);
  for (const int side : {0, 1, 2, 3}) EXPECT_EQ(domain.sides[side], SideKind::open) << side;
  EXPECT_EQ(domain.sides[4], SideKind::wall) << "the inlet";
  EXPECT_EQ(domain.sides[5], SideKind::open) << "the outlet";
}

TEST_F(PipeWalls, sphere_in_the_pipe_touches_its_wall_once_at_the_distance_of_the_polygon) {
  const Walls walls = make_walls(scene_, mesh_);
  ASSERT_EQ(walls.size(), 1);
  EXPECT_EQ(walls[0].name, "mesh");
  EXPECT_EQ(walls[0].material, "walls");
  // The circle has 22 corners or so; a chord of one 20th of it sags by R (1 - cos(π/20)).
  const double sag = 0.025 * (1 - std::cos(std::numbers::pi / 20));
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int n = 0; n < 2000; ++n) {
    const double angle = std::numbers::pi * uniform(random);
    const Vector3 radial(std::cos(angle), std::sin(angle), 0);
    const Vector3 x = 0.0225 * radial + Vector3(0, 0, 0.075 + 0.07 * uniform(random));
    const auto touches = touches_at(walls, x, 0.003);
    ASSERT_EQ(touches.size(), 1U) << n;
    EXPECT_NEAR(touches[0].distance, 0.0025, sag);
    EXPECT_LE(touches[0].distance, 0.0025);
    EXPECT_GE(-touches[0].normal.dot(radial), std::cos(std::numbers::pi / 20));
  }
  EXPECT_TRUE(touches_at(walls, {0, 0, 0.149}, 0.003).empty()) << "the outlet is open";
}

TEST_F(PipeWalls, room_is_the_inside_of_the_pipe) {
  const Room room(scene_, mesh_);
  EXPECT_TRUE(room.fits({0, 0, 0.05}, 0.02));
  EXPECT_FALSE(room.fits({0, 0, 0.05}, 0.0251));
  EXPECT_TRUE(room.fits({0.02, 0, 0.05}, 0.004));
  EXPECT_FALSE(room.fits({0.022, 0, 0.05}, 0.004));
  // In the corners of the bounding box, clear of the wall, but outside.
  EXPECT_FALSE(room.fits({0.024, 0.024, 0.05}, 0.001));
  EXPECT_FALSE(room.fits({-0.024, 0.0249, 0.149}, 0.001));
  EXPECT_EQ(room.nearest_wall({0.02, 0, 0.05}), "mesh");
  // The outlet is open: up to its plane nothing is in the way.
  EXPECT_TRUE(room.fits({0, 0, 0.1495}, 0.01));
}

TEST_F(PipeWalls, without_walls_from_the_mesh_nothing_is_touched) {
  scene_.particles.walls = WallSource::none;
  EXPECT_TRUE(make_walls(scene_, mesh_).empty());
}

/// A box, periodic in x, whose top is a wave of triangles and quadrangles.
Mesh wavy_box(const Scene& scene) {
  const Mesh box = make_box(scene.fluid.mesh);
  MeshTopology mesh = box;
  for (Vector3& point : mesh.points) {
    const double share = (point.z() + 1) / 2;
    point.z() -= 0.2 * share * (1 - std::cos(std::numbers::pi * (point.x() - 0.25)));
  }
  return with_geometry(std::move(mesh));
}

TEST(MeshWalls, wall_goes_on_through_a_periodic_side) {
  Scene scene = wall_scene();
  scene.fluid.mesh.box.cells = {8, 2, 2};
  scene.fluid.mesh.periodic = {Axis::x};
  const Mesh mesh = wavy_box(scene);
  const Domain domain = particle_domain(scene, mesh);
  EXPECT_EQ(domain.sides[0], SideKind::periodic);
  const Walls walls = make_walls(scene, mesh);
  // The same place on both sides of the seam, and a period on.
  for (const double y : {-0.3, 0.01}) {
    for (const double off : {-0.03, -0.001, 0.001, 0.02}) {
      const double z = 0.62;
      const auto low = touches_at(walls, {-1 + off, y, z}, 0.3);
      const auto high = touches_at(walls, {1 + off, y, z}, 0.3);
      ASSERT_EQ(low.size(), 1U) << off;
      ASSERT_EQ(high.size(), 1U) << off;
      EXPECT_NEAR(low[0].distance, high[0].distance, 1e-6 * 4) << "the points are merged to that";
      EXPECT_LE((low[0].normal - high[0].normal).norm(), 1e-4);
    }
  }
}

TEST(MeshWalls, faces_become_triangles_of_their_area_and_direction) {
  Scene scene = wall_scene();
  scene.fluid.mesh.box.cells = {5, 4, 3};
  const Mesh mesh = make_box(scene.fluid.mesh);
  std::vector<int> faces;
  for (int face = mesh.internal_faces(); face < mesh.faces(); ++face) faces.push_back(face);
  const TriangleSurface surface = triangles_of(mesh, faces);
  const SurfaceQuality quality = measure_surface(surface);
  EXPECT_TRUE(quality.closed());
  EXPECT_EQ(quality.triangles, 2 * static_cast<int>(faces.size()));
  EXPECT_NEAR(enclosed_volume(surface), 8, 1e-13);
}

TEST(MeshWalls, face_that_is_not_convex_is_a_fan_about_its_notch) {
  Mesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0.6, 0.3, 0}, {0, 1, 0}};
  mesh.face_offsets = {0, 5};
  mesh.face_points = {2, 3, 4, 0, 1};
  mesh.face_areas = {Vector3(0, 0, 0.65)};
  const std::vector<int> faces{0};
  const TriangleSurface surface = triangles_of(mesh, faces);
  EXPECT_EQ(surface.triangles.size(), 3U);
  double area = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    const Vector3 twice =
        (surface.points[b] - surface.points[a]).cross(surface.points[c] - surface.points[a]);
    EXPECT_GT(twice.z(), 0);
    area += 0.5 * twice.z();
  }
  EXPECT_NEAR(area, 0.65, 1e-15);
}

TEST(WallRoom, side_of_a_surface_says_where_particles_may_start) {
  SurfaceSettings drum = cylinder({0, 0, -0.5}, {0, 0, 1}, 0.4, 1.0);
  Scene scene = wall_scene();
  scene.particles.surfaces = {{"drum", drum}, {"floor", plane({0, 0, -0.5}, {0, 0, 1})}};
  const Mesh mesh = make_box(scene.fluid.mesh);
  const Vector3 inside(0.1, 0.1, 0);
  const Vector3 outside(0.6, 0.1, 0);
  EXPECT_TRUE(Room(scene, mesh).fits(inside, 0.1));
  EXPECT_TRUE(Room(scene, mesh).fits(outside, 0.1));
  scene.particles.surfaces[0].second.side = SurfaceSide::inside;
  EXPECT_TRUE(Room(scene, mesh).fits(inside, 0.1));
  EXPECT_FALSE(Room(scene, mesh).fits(outside, 0.1));
  EXPECT_TRUE(Room(scene, mesh).fits({0.6, 0.1, 0.8}, 0.1)) << "beyond its end";
  EXPECT_FALSE(Room(scene, mesh).fits({0, 0, -0.45}, 0.1)) << "through the floor";
  EXPECT_EQ(Room(scene, mesh).nearest_wall({0, 0, -0.45}), "floor");
  scene.particles.surfaces[0].second.side = SurfaceSide::outside;
  EXPECT_FALSE(Room(scene, mesh).fits(inside, 0.1));
  const StlFile file(ball(0.5, 2));
  scene.particles.surfaces = {{"ball", file.surface()}};
  scene.particles.surfaces[0].second.side = SurfaceSide::inside;
  EXPECT_TRUE(Room(scene, mesh).fits({0.1, 0.2, 0}, 0.1));
  EXPECT_FALSE(Room(scene, mesh).fits({0.6, 0.6, 0.6}, 0.1));
}

}  // namespace
}  // namespace fluxpact
