#include "coordinator/record/results_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/base/errors.hpp"
#include "tests/unit/coordinator/record/sample_run.hpp"
#include "tests/unit/proto/io/scratch_folder.hpp"

namespace fluxpact {
namespace {

TEST(ResultsFile, refuses_a_newer_format_and_names_who_wrote_it) {
  const ScratchFolder folder;
  {
    Hdf5File file = Hdf5File::create(folder / "results.h5");
    file.set_attribute("/", "format_version", results_format_version + 1);
    file.set_attribute("/", "program_version", std::string_view("9.9"));
  }
  try {
    open_results(folder / "results.h5");
    FAIL() << "was accepted";
  } catch (const SystemError& error) {
    EXPECT_THAT(error.what(),
                testing::AllOf(testing::HasSubstr("version 2"), testing::HasSubstr("9.9")));
  }
}

TEST(ResultsFile, says_which_continuity_was_solved) {
  const ScratchFolder folder;
  create_results(folder / "legacy.h5", "1", Continuity::legacy);
  create_results(folder / "conservative.h5", "1", Continuity::conservative);
  EXPECT_EQ(open_results(folder / "legacy.h5").text_attribute("/", "continuity"), "legacy");
  EXPECT_EQ(open_results(folder / "conservative.h5").text_attribute("/", "continuity"),
            "conservative");
}

TEST(ResultsFile, holds_a_mesh_that_can_be_rebuilt) {
  const ScratchFolder folder;
  const Mesh mesh = sample_sheared({Axis::y});
  {
    Hdf5File file = create_results(folder / "results.h5", "1", Continuity::conservative);
    write_mesh(file, mesh);
  }
  const Hdf5File file = open_results(folder / "results.h5");
  const auto vectors = [&](const char* name) {
    const std::vector<double> values = file.read_doubles(name);
    const auto rows = as_vectors(values);
    return std::vector<Vector3>(rows.begin(), rows.end());
  };
  const auto indices = [&](const char* name) {
    const std::vector<std::int64_t> values = file.read_whole(name);
    return std::vector<int>(values.begin(), values.end());
  };
  MeshTopology topology{vectors("/mesh/points"),       indices("/mesh/face_offsets"),
                        indices("/mesh/face_points"),  indices("/mesh/owner"),
                        indices("/mesh/neighbour"),    indices("/mesh/periodic_faces"),
                        vectors("/mesh/translations"), {}};
  const auto names = file.read_texts("/mesh/patches/name");
  const auto first = indices("/mesh/patches/first");
  const auto size = indices("/mesh/patches/size");
  for (std::size_t i = 0; i < names.size(); ++i)
    topology.patches.push_back({names[i], first[i], size[i]});
  EXPECT_EQ(fingerprint(topology), fingerprint(mesh));
  EXPECT_EQ(file.read_doubles("/mesh/cell_volumes"), with_geometry(topology).cell_volumes);
}

TEST(RecordName, sorts_as_its_number) {
  EXPECT_EQ(record_name(7), "000007");
  EXPECT_LT(record_name(9), record_name(10));
  EXPECT_EQ(record_name(1234567), "1234567");
}

}  // namespace
}  // namespace fluxpact
