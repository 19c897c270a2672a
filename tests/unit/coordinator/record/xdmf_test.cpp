#include "coordinator/record/xdmf.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/unit/coordinator/record/sample_run.hpp"

namespace fluxpact {
namespace {

// Volume of each drawn polyhedron by the divergence theorem, from nothing but the drawing. Faces
// may be oriented either way, so each counts by the side of the mean of the cell's points that it
// is on.
std::vector<double> drawn_volumes(const XdmfPolyhedra& drawing) {
  std::vector<double> volumes;
  std::size_t at = 0;
  const auto next = [&] { return drawing.connectivity.at(at++); };
  while (at < drawing.connectivity.size()) {
    EXPECT_EQ(next(), 16);
    std::vector<std::vector<Vector3>> faces(static_cast<std::size_t>(next()));
    Vector3 centre{0, 0, 0};
    double count = 0;
    for (auto& face : faces) {
      face.resize(static_cast<std::size_t>(next()));
      for (Vector3& point : face) {
        point = drawing.points.at(static_cast<std::size_t>(next()));
        centre += point;
        ++count;
      }
    }
    centre /= count;
    double volume = 0;
    for (const auto& face : faces) {
      Vector3 area{0, 0, 0};
      for (std::size_t i = 1; i + 1 < face.size(); ++i) {
        area += 0.5 * (face[i] - face[0]).cross(face[i + 1] - face[0]);
      }
      volume += std::abs(area.dot(face[0] - centre)) / 3;
    }
    volumes.push_back(volume);
  }
  return volumes;
}

TEST(Polyhedra, enclose_the_volumes_of_the_cells_on_both_sides_of_a_period) {
  for (const Mesh& mesh :
       {sample_sheared(), sample_sheared({Axis::y}), sample_box({Axis::x, Axis::y})}) {
    const std::vector<double> volumes = drawn_volumes(draw_polyhedra(mesh));
    ASSERT_EQ(volumes.size(), mesh.cell_volumes.size());
    for (std::size_t c = 0; c < volumes.size(); ++c) {
      // A dozen terms of the size of the volume.
      EXPECT_NEAR(volumes[c], mesh.cell_volumes[c], 1e-14 * mesh.cell_volumes[c]) << "cell " << c;
    }
  }
}

TEST(XdmfIndex, has_no_grid_before_the_first_record) {
  const Mesh mesh = sample_box();
  EXPECT_EQ(XdmfIndex("results.h5", *mesh.lattice).text().find("<Grid"), std::string::npos);
}

}  // namespace
}  // namespace fluxpact
