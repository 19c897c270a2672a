// Insertion entries of a scene, and what is refused with which words.
#include "dem_server/insertion/insertion.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "proto/base/errors.hpp"
#include "proto/mesh/box.hpp"

namespace fluxpact {
namespace {

Scene insertion_scene() {
  Scene scene;
  scene.fluid.mesh.box = {Vector3::Zero(), {0.01, 0.02, 0.03}, {2, 2, 2}};
  scene.particles.materials["glass"].density = 2500;
  scene.particles.materials["steel"].density = 7800;
  return scene;
}

InsertionSettings& add_entry(Scene& scene, InsertionType type) {
  InsertionSettings entry;
  entry.type = type;
  entry.material = "glass";
  entry.diameter = 1e-3;
  scene.particles.insertion.push_back(entry);
  return scene.particles.insertion.back();
}

ParticleState insert(const Scene& scene) {
  return insert_particles(scene, make_box(scene.fluid.mesh));
}

void expect_refusal(const Scene& scene, const std::vector<std::string>& parts) {
  try {
    insert(scene);
    ADD_FAILURE() << "no error was thrown";
  } catch (const ConfigError& error) {
    const std::string text = error.what();
    for (const std::string& part : parts) {
      EXPECT_NE(text.find(part), std::string::npos) << "`" << part << "` is not in: " << text;
    }
  }
}

/// A file that lives as long as the test.
class CsvFile {
 public:
  explicit CsvFile(const std::string& text)
      : path_(::testing::TempDir() + "fluxpact_insertion_" +
              ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv") {
    std::ofstream(path_) << text;
  }
  ~CsvFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  CsvFile(const CsvFile&) = delete;
  CsvFile& operator=(const CsvFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

Scene file_scene(const CsvFile& file) {
  Scene scene = insertion_scene();
  add_entry(scene, InsertionType::file).path = file.path();
  return scene;
}

TEST(Insertion, numbers_the_particles_of_all_entries_in_order) {
  Scene scene = insertion_scene();
  InsertionSettings& below = add_entry(scene, InsertionType::packing);
  below.count = 200;
  below.within.z = {0, 0.01};
  below.velocity = {1, 2, 3};
  InsertionSettings& above = add_entry(scene, InsertionType::lattice);
  above.material = "steel";
  above.diameter = 2e-3;
  above.within.z = {0.01, 0.03};
  const ParticleState state = insert(scene);
  EXPECT_EQ(material_names(scene.particles), (std::vector<std::string>{"glass", "steel"}));
  // 1 cm, 2 cm and 2 cm hold 4, 9 and 9 spheres of 2 mm at 2.002 mm.
  ASSERT_EQ(state.size(), 200 + 4 * 9 * 9);
  for (int row = 0; row < state.size(); ++row) {
    const bool first = row < 200;
    EXPECT_EQ(state.id[row], row + 1);
    EXPECT_EQ(state.material[row], first ? 0 : 1);
    EXPECT_EQ(state.density[row], first ? 2500 : 7800);
    EXPECT_EQ(state.radius[row], first ? 0.5e-3 : 1e-3);
    EXPECT_EQ(state.velocity[row], first ? Vector3(1, 2, 3) : Vector3::Zero());
    EXPECT_EQ(state.spin[row], Vector3::Zero());
    EXPECT_EQ(state.position[row].z() < 0.01, first);
  }
}

TEST(Insertion, lattice_starts_at_the_low_sides_and_keeps_its_spacing) {
  Scene scene = insertion_scene();
  scene.fluid.mesh.periodic = {Axis::x};
  InsertionSettings& entry = add_entry(scene, InsertionType::lattice);
  entry.spacing = 1.25e-3;
  entry.within.y = {0.002, 0.0045};
  entry.within.z = {0.01, 0.011};
  const ParticleState state = insert(scene);
  ASSERT_EQ(state.size(), 8 * 2);  // 8 periods of 1.25 mm in 1 cm
  const Vector3 first(0.625e-3, 2.5e-3, 10.5e-3);
  EXPECT_LT((state.position[0] - first).norm(), 1e-17);
  EXPECT_LT((state.position[1] - first - Vector3(1.25e-3, 0, 0)).norm(), 1e-17);
  EXPECT_LT((state.position[8] - first - Vector3(0, 1.25e-3, 0)).norm(), 1e-17);
}

TEST(Insertion, reads_columns_by_name) {
  const CsvFile file(
      "diameter, z,y,x,vx,vy,vz\r\n2e-3,0.015,0.01,0.005,1,2,3\r\n\n1e-3,0.02,0.01,5e-3,0,0,-1\n");
  const ParticleState state = insert(file_scene(file));
  ASSERT_EQ(state.size(), 2);
  EXPECT_EQ(state.position[0], Vector3(0.005, 0.01, 0.015));
  EXPECT_EQ(state.velocity[0], Vector3(1, 2, 3));
  EXPECT_EQ(state.radius[0], 1e-3);
  EXPECT_EQ(state.velocity[1], Vector3(0, 0, -1));
  EXPECT_EQ(state.radius[1], 0.5e-3);
}

TEST(Insertion, fixes_the_spheres_of_entries_that_ask_for_it) {
  // A file of spheres on the move: those of a fixed entry stand still.
  const CsvFile file(
      "x,y,z,vx,vy,vz,wx,wy,wz\n0.001,0.001,0.001,1,2,3,4,5,6\n0.004,0.004,0.004,1,2,3,4,5,6\n");
  Scene scene = file_scene(file);
  EXPECT_EQ(insert(scene).velocity[1], Vector3(1, 2, 3));
  EXPECT_TRUE(insert(scene).fixed.empty()) << "nothing is stored for what no entry asks for";
  InsertionSettings& above = add_entry(scene, InsertionType::lattice);
  above.diameter = 5e-3;
  above.within.z = {0.02, 0.026};
  scene.particles.insertion[0].motion = Mobility::fixed;
  const ParticleState state = insert(scene);
  ASSERT_GT(state.size(), 2);
  for (int row = 0; row < state.size(); ++row) EXPECT_EQ(state.is_fixed(row), row < 2) << row;
  EXPECT_EQ(state.velocity[1], Vector3::Zero());
  EXPECT_EQ(state.spin[1], Vector3::Zero());
}

TEST(Insertion, takes_the_diameter_of_the_entry_if_the_file_has_none) {
  const CsvFile file("x,y,z\n0.005,0.01,0.015\n");
  Scene scene = file_scene(file);
  EXPECT_EQ(insert(scene).radius[0], 0.5e-3);
  scene.particles.insertion[0].diameter = 0;
  expect_refusal(scene, {"entry 1", "diameter is 0"});
}

TEST(InsertionRefusal, names_file_and_line) {
  const auto refuses = [](const char* text, const std::vector<std::string>& parts) {
    const CsvFile file(text);
    expect_refusal(file_scene(file), parts);
  };
  refuses("x,y,z\n1,2,3\n1,2,3e\n", {".csv:3:", "`3e`"});
  refuses("x,y,z\n1,2\n", {".csv:2:", "2 values under a header of 3"});
  refuses("x,y,z,w\n", {".csv:1:", "`w`"});
  refuses("x,y\n", {".csv:1:", "must name x, y and z"});
  refuses("x,y,z,vx\n", {".csv:1:", "vx, vy and vz"});
  refuses("x,x,y,z\n", {".csv:1:", "twice"});
  refuses("x,y,z\n0.005,nan,0\n", {".csv:2:", "`nan`"});
  refuses("x,y,z,diameter\n0.005,0.01,0.015,-1\n", {".csv:2:", "must be positive"});
  refuses("", {"cannot be read, or is empty"});
  Scene scene = insertion_scene();
  add_entry(scene, InsertionType::file).path = "/no/such/file.csv";
  expect_refusal(scene, {"/no/such/file.csv", "cannot be read"});
}

TEST(InsertionRefusal, names_what_is_outside) {
  const CsvFile file("x,y,z\n0.005,0.01,0.015\n0.005,0.021,0.015\n");
  expect_refusal(file_scene(file), {"particle 2", "entry 1", "outside", "y_max", "0.001 m"});
  const CsvFile edge("x,y,z\n0.00035,0.01,0.015\n");
  expect_refusal(file_scene(edge), {"particle 1", "sticks out", "x_min"});
  const CsvFile touching("x,y,z\n0.00045,0.01,0.015\n");  // a tenth of a radius into the wall
  EXPECT_NO_THROW(insert(file_scene(touching)));
}

TEST(InsertionRefusal, names_the_pair_that_overlaps_most) {
  const CsvFile file("x,y,z\n0.005,0.01,0.015\n0.0059,0.01,0.015\n0.005,0.01085,0.015\n");
  expect_refusal(file_scene(file), {"particle 3", "particle 1", "0.15 of the smaller diameter"});
  const CsvFile close("x,y,z\n0.005,0.01,0.015\n0.00591,0.01,0.015\n");
  EXPECT_NO_THROW(insert(file_scene(close)));
}

TEST(InsertionRefusal, sees_an_overlap_across_a_periodic_side) {
  const CsvFile file("x,y,z\n0.0001,0.01,0.015\n0.0098,0.01,0.015\n");
  Scene scene = file_scene(file);
  scene.fluid.mesh.periodic = {Axis::x};
  expect_refusal(scene, {"particle 2", "particle 1", "0.7 of"});
}

TEST(InsertionRefusal, says_what_would_fit) {
  Scene scene = insertion_scene();
  InsertionSettings& entry = add_entry(scene, InsertionType::packing);
  entry.within.y = {0, 0.01};
  entry.within.z = {0, 0.01};
  entry.count = 1500;  // 1500 π/6 mm³ in 1 cm³: 0.785
  try {
    insert(scene);
    ADD_FAILURE() << "no error was thrown";
  } catch (const ConfigError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("fill 0.785"), std::string::npos) << text;
    const std::size_t at = text.find("does not reach; ") + 16;
    scene.particles.insertion[0].count = std::stoi(text.substr(at));
  }
  EXPECT_GT(scene.particles.insertion[0].count, 950);  // 0.50
  EXPECT_NO_THROW(insert(scene));
}

TEST(InsertionRefusal, of_regions_and_materials_that_do_not_exist) {
  Scene scene = insertion_scene();
  add_entry(scene, InsertionType::lattice).within.z = {0.02, 0.04};
  expect_refusal(scene, {"entry 1", "within.z", "[0, 0.03]"});
  scene.particles.insertion[0].within.z = {0.02, 0.0205};
  expect_refusal(scene, {"entry 1", "too short"});
  scene.particles.insertion[0].within.z.reset();
  scene.particles.insertion[0].material = "sand";
  expect_refusal(scene, {"entry 1", "`sand`", "glass, steel"});
}

}  // namespace
}  // namespace fluxpact
