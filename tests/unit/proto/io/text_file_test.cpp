#include "proto/io/text_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "proto/base/errors.hpp"
#include "tests/unit/proto/io/file_limit.hpp"
#include "tests/unit/proto/io/scratch_folder.hpp"

namespace fluxpact {
namespace {

using testing::AllOf;
using testing::HasSubstr;

template <class Action>
std::string message_of(Action action) {
  try {
    action();
  } catch (const SystemError& error) {
    return error.what();
  }
  return "no error";
}

TEST(TextFile, holds_each_append_at_once) {
  const ScratchFolder folder;
  TextFile file = TextFile::create(folder / "a.csv");
  file.append("one\n");
  EXPECT_EQ(read_file(folder / "a.csv"), "one\n");
  file.append("two\n");
  EXPECT_EQ(read_file(folder / "a.csv"), "one\ntwo\n");
}

TEST(TextFile, names_path_and_reason_when_the_device_is_full) {
  TextFile file = TextFile::create("/dev/full");
  EXPECT_THAT(message_of([&] { file.append("row\n"); }),
              AllOf(HasSubstr("/dev/full"), HasSubstr("No space left on device")));
}

TEST(TextFile, names_path_and_reason_when_it_cannot_be_made) {
  const ScratchFolder folder;
  replace_file(folder / "plain", "x");
  // Below a plain file nothing can be made, not even by root.
  EXPECT_THAT(message_of([&] { TextFile::create(folder / "plain/a.csv"); }),
              AllOf(HasSubstr("plain/a.csv"), HasSubstr("Not a directory")));
}

TEST(TextFile, takes_a_torn_line_back) {
  const ScratchFolder folder;
  TextFile file = TextFile::create(folder / "a.csv");
  file.append("whole\n");
  {
    const FileLimit limit(10);  // 6 bytes are there: 4 of the next line fit
    EXPECT_THAT(message_of([&] { file.append("torn line\n"); }), HasSubstr("File too large"));
  }
  EXPECT_EQ(read_file(folder / "a.csv"), "whole\n");
  file.append("next\n");
  EXPECT_EQ(read_file(folder / "a.csv"), "whole\nnext\n");
}

TEST(ReplaceFile, leaves_the_old_file_when_the_new_one_cannot_be_written) {
  const ScratchFolder folder;
  replace_file(folder / "a.txt", "old");
  {
    const FileLimit limit(10);
    EXPECT_THAT(message_of([&] { replace_file(folder / "a.txt", std::string(100, 'x')); }),
                AllOf(HasSubstr("a.txt"), HasSubstr("File too large")));
  }
  EXPECT_EQ(read_file(folder / "a.txt"), "old");
  EXPECT_FALSE(std::filesystem::exists(folder / "a.txt.partial"));
  replace_file(folder / "a.txt", "new");
  EXPECT_EQ(read_file(folder / "a.txt"), "new");
}

}  // namespace
}  // namespace fluxpact
