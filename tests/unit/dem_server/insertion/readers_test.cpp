// Particles from files of every kind: what is read, and how errors name their place.
#include "dem_server/insertion/read_particles.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "proto/base/errors.hpp"
#include "proto/io/hdf5.hpp"

namespace fluxpact {
namespace {

/// A path that no other process has, and that is free again after the test.
class TestFile {
 public:
  TestFile()
      : path_(::testing::TempDir() + "fluxpact_readers_" + std::to_string(getpid()) + "_" +
              ::testing::UnitTest::GetInstance()->current_test_info()->name()) {}
  explicit TestFile(const std::string& text) : TestFile() { std::ofstream(path_) << text; }
  ~TestFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TestFile(const TestFile&) = delete;
  TestFile& operator=(const TestFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

void expect_refusal(const std::string& text, const std::string& expected) {
  const TestFile file(text);
  try {
    read_particles(file.path());
    ADD_FAILURE() << "no error was thrown";
  } catch (const ConfigError& error) {
    const std::string seen = error.what();
    EXPECT_NE(seen.find(file.path() + expected), std::string::npos) << seen;
  }
}

constexpr auto two_frames =
    "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\n"
    "ITEM: ATOMS id type x y z radius\n1 1 9 9 9 9\n"
    "ITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\n"
    "ITEM: ATOMS id type x y z ix vx vy vz fx omegax omegay omegaz radius \n"
    "7 1 0.1 0.2 0.3 0 1 2 3 0 4 5 6 1e-3 \n"
    "3 2 0.4 0.5 0.6 0 -1 -2 -3 0 -4 -5 -6 2e-3 \n";

TEST(ReadDump, takes_the_last_frame_in_the_order_of_its_ids) {
  const TestFile file(two_frames);
  const auto particles = read_particles(file.path());
  ASSERT_EQ(particles.size(), 2U);
  EXPECT_EQ(particles[0].position, Vector3(0.4, 0.5, 0.6));
  EXPECT_EQ(particles[0].velocity, Vector3(-1, -2, -3));
  EXPECT_EQ(particles[0].spin, Vector3(-4, -5, -6));
  EXPECT_EQ(particles[0].diameter, 4e-3);
  EXPECT_EQ(particles[1].position, Vector3(0.1, 0.2, 0.3));
}

TEST(ReadDump, names_line_and_column_of_an_error) {
  const std::string head =
      "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\n";
  expect_refusal(head + "ITEM: ATOMS id x y z\n1 0 0 0\n2 0 oops 0\n", ":11:5: `oops`");
  expect_refusal(head + "ITEM: ATOMS id x y z\n1 0 0 0\n", ":11: the file ends");
  expect_refusal(head + "ITEM: ATOMS id x y z\n1 0 0 0\n2 0 0\n", ":11: 3 values under");
  expect_refusal(head + "ITEM: ATOMS id xs ys zs\n", ":9: the columns must name x, y and z");
  expect_refusal("ITEM: TIMESTEP\n0\n", ": no `ITEM: ATOMS`");
}

TEST(ReadCsv, names_line_and_column_of_an_error) {
  expect_refusal("x,y,z\n0,0,0\n1, 2,abc\n", ":3:6: `abc`");
  expect_refusal("x,y,z,radius\n0,0,0, -1\n", ":2:8: radius -1 m");
  expect_refusal("x,y,z,wx,wy\n", ":1: the header must name all of wx, wy and wz");
  expect_refusal("x,y,z,radius,diameter\n", ":1: radius and diameter");
  expect_refusal("x,y,z,id\n", ":1:7: column `id` is not known");
}

TEST(ReadCsv, reads_spins_and_radii) {
  const TestFile file("radius,z,y,x,wz,wy,wx\n1e-3,3,2,1,6,5,4\n");
  const auto particles = read_particles(file.path());
  ASSERT_EQ(particles.size(), 1U);
  EXPECT_EQ(particles[0].position, Vector3(1, 2, 3));
  EXPECT_EQ(particles[0].spin, Vector3(4, 5, 6));
  EXPECT_EQ(particles[0].diameter, 2e-3);
}

TEST(ReadHdf5, takes_columns_at_the_top) {
  const TestFile file;
  Hdf5File data = Hdf5File::create(file.path());
  const std::vector<double> x{1, 2};
  const std::vector<double> y{3, 4};
  for (const char* name : {"/x", "/z", "/vx", "/vz", "/radius"}) data.write(name, x, {2}, "m");
  for (const char* name : {"/y", "/vy"}) data.write(name, y, {2}, "m");
  data.close();
  const auto particles = read_particles(file.path());
  ASSERT_EQ(particles.size(), 2U);
  EXPECT_EQ(particles[1].position, Vector3(2, 4, 2));
  EXPECT_EQ(particles[1].velocity, Vector3(2, 4, 2));
  EXPECT_EQ(particles[1].diameter, 4.0);
  EXPECT_EQ(particles[1].spin, Vector3::Zero());
}

TEST(ReadHdf5, takes_the_last_record_of_a_run_or_the_group_that_is_named) {
  const TestFile file;
  Hdf5File data = Hdf5File::create(file.path());
  for (const double at : {1.0, 2.0}) {
    const std::string group = at == 1.0 ? "/particles/000000/" : "/particles/000001/";
    const std::vector<double> rows{at, 0, 0, 5 * at, 0, 0};
    for (const char* name : {"position", "velocity", "spin"}) {
      data.write(group + name, rows, {2, 3}, "m");
    }
    data.write(group + "radius", std::vector<double>{at, at}, {2}, "m");
  }
  data.close();
  EXPECT_EQ(read_particles(file.path()).at(1).position, Vector3(10, 0, 0));
  EXPECT_EQ(read_particles(file.path()).at(1).spin, Vector3(10, 0, 0));
  EXPECT_EQ(read_particles(file.path(), "/particles/000000").at(1).position, Vector3(5, 0, 0));
  EXPECT_THROW(read_particles(file.path(), "/particles/7"), ConfigError);
}

TEST(ReadHdf5, names_a_dataset_of_another_length) {
  const TestFile file;
  Hdf5File data = Hdf5File::create(file.path());
  for (const char* name : {"/x", "/y"}) data.write(name, std::vector<double>{1, 2}, {2}, "m");
  data.write("/z", std::vector<double>{1}, {1}, "m");
  data.close();
  try {
    read_particles(file.path());
    ADD_FAILURE() << "no error was thrown";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("dataset /z has 1 values where 2"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace fluxpact
