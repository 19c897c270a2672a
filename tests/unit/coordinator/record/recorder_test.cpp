#include "coordinator/record/recorder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>

#include "coordinator/record/results_file.hpp"
#include "proto/base/errors.hpp"
#include "tests/unit/coordinator/record/sample_run.hpp"
#include "tests/unit/proto/io/file_limit.hpp"
#include "tests/unit/proto/io/scratch_folder.hpp"

namespace fluxpact {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

const RunDescription run{"version: 1\n", "0.0-test", Continuity::conservative};

template <class ErrorType, class Action>
std::string message_of(Action action) {
  try {
    action();
  } catch (const ErrorType& error) {
    return error.what();
  }
  return "no error";
}

// What the independent reader says.
std::string check_record(const std::filesystem::path& directory, const Mesh& mesh) {
  const std::string command =
      fmt::format(CHECK_RECORD " '{}' {} {} 2>&1", directory.string(), mesh.cells(), mesh.faces());
  std::FILE* pipe = ::popen(command.c_str(), "r");
  std::string output;
  std::array<char, 256> part{};
  while (std::fgets(part.data(), static_cast<int>(part.size()), pipe) != nullptr)
    output += part.data();
  const int status = ::pclose(pipe);
  return status == 0 ? output : "FAILED: " + output;
}

std::vector<std::vector<std::string>> read_csv(const std::filesystem::path& path) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream text(read_file(path));
  for (std::string line; std::getline(text, line);) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

TEST(Recorder, keeps_scalars_of_the_scene_in_all_files) {
  const ScratchFolder folder;
  const Mesh mesh = sample_box();
  RunDescription with_scalars = run;
  with_scalars.scalars = {{"heat", ScalarKind::temperature}, {"tracer", ScalarKind::species}};
  Recorder recorder(folder / "run", mesh, with_scalars);
  const SampleState state(mesh, 0, 1);
  const std::vector<double> warm(static_cast<std::size_t>(mesh.cells()), 300.5);
  FieldRecord fields = state.fields();
  fields.scalars = {warm, state.scalar};
  recorder.record_fields({0, 0}, fields);
  AuditRow row = sample_row(1);
  row.scalars = {{1, 2, 3, 4, 5, 6, 7}, {8, 9, 10, 11, 12, 13, 14}};
  recorder.append(row);
  recorder.close();
  const auto csv = read_csv(folder / "run" / "audit.csv");
  ASSERT_EQ(csv.size(), 2U);
  EXPECT_EQ(csv[0].size(), csv[1].size());
  EXPECT_EQ(csv[0].back(), "scalar_tracer_max");
  EXPECT_EQ(csv[1].back(), "14");
  // The independent reader compares the columns of both files and follows the index.
  EXPECT_EQ(check_record(folder / "run", mesh), "rows 1 fields and particles 1 0\n");
  const std::string index = read_file(folder / "run" / "results.xdmf");
  EXPECT_THAT(index, HasSubstr("/fields/000000/scalar_tracer"));
  EXPECT_THAT(index, HasSubstr("/fields/000000/scalar_heat"));
}

TEST(Recorder, writes_what_a_reader_without_our_code_understands) {
  const ScratchFolder folder;
  for (const Mesh& mesh :
       {sample_box(), sample_box({Axis::x}), sample_sheared(), sample_sheared({Axis::y})}) {
    record_sample_run(folder / "run", mesh);
    // The start has no particles, so there is one time less to draw.
    EXPECT_EQ(check_record(folder / "run", mesh), "rows 300 fields and particles 3 2\n");
  }
}

TEST(Recorder, gives_back_every_number_to_the_bit) {
  const ScratchFolder folder;
  const Mesh mesh = sample_box();
  record_sample_run(folder / "run", mesh);
  const Hdf5File file = open_results(folder / "run/results.h5");
  const SampleState state(mesh, 3, 100);
  EXPECT_EQ(file.read_doubles("/fields/000001/voidage"), state.scalar);
  EXPECT_EQ(file.read_doubles("/fields/000001/face_flux"), state.flux);
  const auto vectors = as_doubles(state.vector);
  EXPECT_EQ(file.read_doubles("/fields/000001/velocity"),
            std::vector<double>(vectors.begin(), vectors.end()));
  EXPECT_EQ(file.text_attribute("/fields/000001/velocity", "units"), "m/s");
  EXPECT_EQ(file.whole_attribute("/fields/000001", "step"), 100);
  EXPECT_EQ(file.real_attribute("/fields/000001", "time"), 0.1 * 100);
  EXPECT_EQ(file.read_whole("/particles/000001/id"), (std::vector<std::int64_t>{1, 3, 5}));
  EXPECT_EQ(file.read_doubles("/particles/000002/radius"), state.radius);
  EXPECT_EQ(file.shape("/particles/000000/position"), (Hdf5Shape{0, 3}));
  EXPECT_EQ(file.read_whole("/audit/step").size(), 300);
}

TEST(Recorder, writes_csv_rows_that_read_back_to_the_same_bits) {
  const ScratchFolder folder;
  record_sample_run(folder / "run", sample_box());
  const auto rows = read_csv(folder / "run/audit.csv");
  ASSERT_EQ(rows.size(), 301);
  for (int step = 1; step <= 300; ++step) {
    const AuditRow row = sample_row(step);
    const auto& cells = rows[static_cast<std::size_t>(step)];
    ASSERT_EQ(cells.size(), audit_columns().size());
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const double expected = std::visit(
          [&](const auto get) { return static_cast<double>(get(row)); }, audit_columns()[i].value);
      if (audit_columns()[i].name == std::string("wall_dem")) continue;  // set by the run
      EXPECT_EQ(std::strtod(cells[i].c_str(), nullptr), expected) << rows[0][i];
    }
  }
}

TEST(Recorder, gives_the_same_bytes_for_the_same_data_whatever_the_clock_said) {
  const ScratchFolder folder;
  const Mesh mesh = sample_box();
  record_sample_run(folder / "a", mesh, 0.5);
  record_sample_run(folder / "b", mesh, 0.75);
  record_sample_run(folder / "b", mesh, 0.75);  // over an earlier record, too
  for (const char* name : {"results.h5", "results.xdmf", "scene.yaml"}) {
    EXPECT_TRUE(read_file(folder / "a" / name) == read_file(folder / "b" / name)) << name;
  }
  EXPECT_FALSE(read_file(folder / "a/audit.csv") == read_file(folder / "b/audit.csv"));
}

TEST(Recorder, hands_each_row_of_the_csv_over_at_once) {
  const ScratchFolder folder;
  Recorder recorder(folder / "run", sample_box(), run);
  EXPECT_EQ(read_csv(folder / "run/audit.csv").size(), 1);
  recorder.append(sample_row(1));
  EXPECT_EQ(read_csv(folder / "run/audit.csv").size(), 2);
}

TEST(Recorder, leaves_files_readable_up_to_the_last_record_when_it_is_killed) {
  const ScratchFolder folder;
  const Mesh mesh = sample_box();
  EXPECT_EXIT(
      {
        Recorder recorder(folder / "run", mesh, run);
        for (int step = 1; step <= 10; ++step) recorder.append(sample_row(step));
        recorder.record_fields({10, 1.0}, SampleState(mesh, 0, 1).fields());
        for (int step = 11; step <= 20; ++step) recorder.append(sample_row(step));
        std::raise(SIGKILL);
      },
      testing::KilledBySignal(SIGKILL), "");
  const Hdf5File file = open_results(folder / "run/results.h5");
  EXPECT_EQ(file.read_whole("/audit/step").size(), 10);
  EXPECT_EQ(file.read_doubles("/fields/000000/voidage"), SampleState(mesh, 0, 1).scalar);
  EXPECT_EQ(read_csv(folder / "run/audit.csv").size(), 21);
}

TEST(Recorder, saves_what_it_kept_back_when_an_exception_ends_the_run) {
  const ScratchFolder folder;
  try {
    Recorder recorder(folder / "run", sample_box(), run);
    recorder.append(sample_row(1));
    throw NumericsError("the run ended");
  } catch (const NumericsError&) {
  }
  EXPECT_EQ(open_results(folder / "run/results.h5").read_whole("/audit/step").size(), 1);
}

TEST(Recorder, writes_the_resolved_scene) {
  const ScratchFolder folder;
  const Recorder recorder(folder / "deep/run", sample_box(), run);
  EXPECT_THAT(read_file(folder / "deep/run/scene.yaml"),
              AllOf(StartsWith("# "), testing::EndsWith("\nversion: 1\n")));
}

TEST(Recorder, writes_over_its_own_files_only) {
  const ScratchFolder folder;
  const Mesh mesh = sample_box();
  record_sample_run(folder / "run", mesh);
  replace_file(folder / "run/notes.txt", "mine");
  {
    const Recorder recorder(folder / "run", mesh, run);
    EXPECT_FALSE(std::filesystem::exists(folder / "run/results.xdmf"));  // of the old record
  }
  EXPECT_EQ(read_file(folder / "run/notes.txt"), "mine");

  for (const char* name : {"scene.yaml", "audit.csv", "results.h5", "results.xdmf"}) {
    const std::filesystem::path foreign = folder / (std::string("foreign ") + name);
    std::filesystem::create_directories(foreign);
    replace_file(foreign / name, "mine");
    EXPECT_THAT(message_of<ConfigError>([&] { Recorder recorder(foreign, mesh, run); }),
                AllOf(HasSubstr(name), HasSubstr("--out")));
    EXPECT_EQ(read_file(foreign / name), "mine");
  }
}

TEST(Recorder, names_path_and_reason_when_the_directory_cannot_be_made) {
  const ScratchFolder folder;
  replace_file(folder / "plain", "x");
  for (const char* place : {"plain", "plain/run"}) {
    EXPECT_THAT(
        message_of<SystemError>([&] { Recorder recorder(folder / place, sample_box(), run); }),
        AllOf(HasSubstr(place), HasSubstr("Not a directory")));
  }
}

TEST(Recorder, refuses_ids_that_are_not_whole_or_not_ascending) {
  const ScratchFolder folder;
  const Mesh mesh = sample_box();
  Recorder recorder(folder / "run", mesh, run);
  SampleState state(mesh, 3, 1);
  state.id[2] = 2.5;
  EXPECT_THAT(message_of<ProtocolError>([&] {
                recorder.record_particles({1, 0.1}, state.particles());
              }),
              HasSubstr("id 2.5 in row 2"));
  state.id[2] = state.id[1];
  EXPECT_THAT(message_of<ProtocolError>([&] {
                recorder.record_particles({1, 0.1}, state.particles());
              }),
              HasSubstr("row 2"));
}

// In a process of its own, which must come to its end in spite of what could not be written.
template <class Action>
void expect_full_disk(rlim_t room, const std::string& pattern, Action action) {
  EXPECT_EXIT(
      {
        const FileLimit limit(room);
        std::fputs(message_of<SystemError>(action).c_str(), stderr);
        std::exit(0);
      },
      testing::ExitedWithCode(0), pattern);
}

TEST(Recorder, names_path_and_reason_when_the_disk_is_full) {
  const ScratchFolder folder;
  const Mesh mesh = sample_box();
  // So little room that not even the start fits.
  expect_full_disk(100, "File too large", [&] { Recorder recorder(folder / "tiny", mesh, run); });
  // Room for the start: sooner or later a record or a row does not fit, whichever file it is in.
  expect_full_disk(150000, "results.h5.*File too large", [&] {
    Recorder recorder(folder / "fields", mesh, run);
    for (int step = 0; step < 1000; ++step) {
      recorder.record_fields({step, 0.1 * step}, SampleState(mesh, 0, 1).fields());
    }
  });
}

TEST(Recorder, names_the_table_when_its_device_is_full) {
  const ScratchFolder folder;
  record_sample_run(folder / "run", sample_box());
  std::filesystem::remove(folder / "run/audit.csv");
  std::filesystem::create_symlink("/dev/full", folder / "run/audit.csv");
  EXPECT_THAT(
      message_of<SystemError>([&] { Recorder recorder(folder / "run", sample_box(), run); }),
      AllOf(HasSubstr("audit.csv"), HasSubstr("No space left on device")));
}

}  // namespace
}  // namespace fluxpact
