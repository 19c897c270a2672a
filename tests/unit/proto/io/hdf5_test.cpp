#include "proto/io/hdf5.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "proto/base/errors.hpp"
#include "proto/io/text_file.hpp"
#include "tests/unit/proto/io/file_limit.hpp"
#include "tests/unit/proto/io/scratch_folder.hpp"

namespace fluxpact {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

template <class Action>
std::string message_of(Action action) {
  try {
    action();
  } catch (const SystemError& error) {
    return error.what();
  }
  return "no error";
}

// Every kind of content, the same each time.
void write_sample(const std::filesystem::path& path) {
  Hdf5File file = Hdf5File::create(path);
  file.set_attribute("/", "format_version", std::int64_t{3});
  file.set_attribute("/", "program", std::string_view("fluxpact"));
  file.make_group("/fields/000000");
  file.set_attribute("/fields/000000", "time", 0.1);
  const std::vector<double> reals{1.5, -0.1, 1e300, 5e-324, 0.0, -0.0};
  file.write("/fields/000000/velocity", reals, {2, 3}, "m/s");
  file.write("/mesh/owner", std::vector<std::int32_t>{1, -2, 3}, {3}, "1");
  file.write("/particles/id", std::vector<std::int64_t>{1, std::int64_t{1} << 60}, {2}, "1");
  file.write("/mesh/patches/name", std::vector<std::string>{"jet", "", "Wände"});
  Hdf5Column time = file.make_real_column("/audit/time", "s", 4);
  Hdf5Column step = file.make_whole_column("/audit/step", "1", 4);
  for (int row = 0; row < 6; ++row) {  // a piece and a half
    time.append(std::vector<double>{0.5 * row});
    step.append(std::vector<std::int64_t>{row});
  }
  file.write("/particles/none", std::vector<double>{}, {0, 3}, "m");
}

TEST(Hdf5File, reads_back_what_was_written) {
  const ScratchFolder folder;
  write_sample(folder / "a.h5");
  const Hdf5File file = Hdf5File::open(folder / "a.h5");
  EXPECT_EQ(file.whole_attribute("/", "format_version"), 3);
  EXPECT_EQ(file.text_attribute("/", "program"), "fluxpact");
  EXPECT_EQ(file.real_attribute("/fields/000000", "time"), 0.1);
  EXPECT_THAT(file.shape("/fields/000000/velocity"), ElementsAre(2, 3));
  EXPECT_EQ(file.text_attribute("/fields/000000/velocity", "units"), "m/s");
  EXPECT_THAT(file.read_doubles("/fields/000000/velocity"),
              ElementsAre(1.5, -0.1, 1e300, 5e-324, 0.0, -0.0));
  EXPECT_THAT(file.read_whole("/mesh/owner"), ElementsAre(1, -2, 3));
  EXPECT_THAT(file.read_whole("/particles/id"), ElementsAre(1, std::int64_t{1} << 60));
  EXPECT_THAT(file.read_texts("/mesh/patches/name"), ElementsAre("jet", "", "Wände"));
  EXPECT_THAT(file.read_doubles("/audit/time"), ElementsAre(0, 0.5, 1, 1.5, 2, 2.5));
  EXPECT_THAT(file.read_whole("/audit/step"), ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_EQ(file.text_attribute("/audit/time", "units"), "s");
  EXPECT_THAT(file.shape("/particles/none"), ElementsAre(0, 3));
  EXPECT_THAT(file.read_doubles("/particles/none"), IsEmpty());
}

TEST(Hdf5File, lists_and_finds_its_objects) {
  const ScratchFolder folder;
  write_sample(folder / "a.h5");
  const Hdf5File file = Hdf5File::open(folder / "a.h5");
  EXPECT_THAT(file.members("/"), ElementsAre("audit", "fields", "mesh", "particles"));
  EXPECT_TRUE(file.exists("/"));
  EXPECT_TRUE(file.exists("/mesh/patches/name"));
  EXPECT_FALSE(file.exists("/mesh/patches/size"));
  EXPECT_FALSE(file.exists("/nothing/on/the/way"));
}

TEST(Hdf5File, has_the_same_bytes_for_the_same_data) {
  const ScratchFolder folder;
  write_sample(folder / "a.h5");
  // Time stamps of HDF5 count whole seconds.
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  // What the memory held before must not get into the file.
  {
    std::vector<std::string> rubbish;
    for (std::size_t size = 1; size < 70000; size += size / 3 + 1)
      rubbish.emplace_back(size, '\xa5');
  }
  write_sample(folder / "b.h5");
  EXPECT_TRUE(read_file(folder / "a.h5") == read_file(folder / "b.h5"));
}

TEST(Hdf5File, is_readable_up_to_the_last_flush_after_its_writer_was_killed) {
  const ScratchFolder folder;
  EXPECT_EXIT(
      {
        Hdf5File file = Hdf5File::create(folder / "a.h5");
        Hdf5Column time = file.make_real_column("/audit/time", "s", 4);
        time.append(std::vector<double>(6, 1.0));
        file.flush();
        time.append(std::vector<double>(6, 2.0));
        std::raise(SIGKILL);
      },
      testing::KilledBySignal(SIGKILL), "");
  const Hdf5File file = Hdf5File::open(folder / "a.h5");
  EXPECT_EQ(file.read_doubles("/audit/time"), std::vector<double>(6, 1.0));
}

TEST(Hdf5File, names_file_and_reason_when_it_cannot_be_made) {
  const ScratchFolder folder;
  replace_file(folder / "plain", "x");
  EXPECT_THAT(message_of([&] { Hdf5File::create(folder / "plain/a.h5"); }),
              AllOf(HasSubstr("plain/a.h5"), HasSubstr("Not a directory")));
}

TEST(Hdf5File, names_what_is_missing_or_of_another_kind) {
  const ScratchFolder folder;
  write_sample(folder / "a.h5");
  const Hdf5File file = Hdf5File::open(folder / "a.h5");
  EXPECT_THAT(message_of([&] { file.read_doubles("/audit/tyme"); }),
              AllOf(HasSubstr("a.h5:/audit/tyme"), HasSubstr("doesn't exist")));
  EXPECT_THAT(message_of([&] { file.read_whole("/audit/time"); }),
              AllOf(HasSubstr("a.h5:/audit/time"), HasSubstr("whole numbers")));
  EXPECT_THAT(message_of([&] { file.real_attribute("/", "program"); }), HasSubstr("@program"));
  replace_file(folder / "text.h5", "no HDF5");
  EXPECT_THAT(message_of([&] { Hdf5File::open(folder / "text.h5"); }), HasSubstr("text.h5"));
}

TEST(Hdf5File, refuses_values_that_do_not_fill_the_shape) {
  const ScratchFolder folder;
  Hdf5File file = Hdf5File::create(folder / "a.h5");
  const std::vector<double> values(5);
  EXPECT_THAT(message_of([&] { file.write("/a", values, {2, 3}, "1"); }), HasSubstr("a.h5:/a"));
}

// In a process of its own: HDF5 keeps files that it could not close, and must still let the process
// end.
TEST(Hdf5File, names_file_and_reason_when_the_disk_is_full) {
  const ScratchFolder folder;
  const auto fill = [&] {
    const FileLimit limit(100000);
    const std::vector<double> values(20000, 1.0);
    const std::string message = message_of([&] {
      Hdf5File file = Hdf5File::create(folder / "a.h5");
      file.write("/fields/voidage", values, {values.size()}, "1");
      file.close();
    });
    std::fputs(message.c_str(), stderr);
    std::exit(0);
  };
  EXPECT_EXIT(fill(), testing::ExitedWithCode(0), "a.h5.*File too large");
}

}  // namespace
}  // namespace fluxpact
