// SPDX-License-Identifier: Apache-2.0
// What a write promises of a machine that loses its power: the bytes are on the disk before they get the file's name.
// The program's own fsync stands before the system's, and tells what it was asked for.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <string>
#include <vector>

#include "files/atomic_file.h"
#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"

namespace {

struct Synced {
  bool folder;
  bool target_is_there;  // under its name, with its new content
  off_t bytes;
};
std::vector<Synced> synced;
std::filesystem::path target;
int fail_with = 0, failures = 0;

}  // namespace

extern "C" int fsync(int file) {
  struct stat about {
  }, named{};
  ::fstat(file, &about);
  const bool there = ::stat(target.c_str(), &named) == 0 && named.st_size == 7;
  synced.push_back({S_ISDIR(about.st_mode), there, about.st_size});
  if (failures > 0 && !synced.back().folder) {
    --failures;
    errno = fail_with;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_fsync, file));
}

namespace standoff {
namespace {

class DurableWrite : public ::testing::TestWithParam<AtomicFile::Unfinished> {
 protected:
  void SetUp() override {
    target = folder / "target";
    synced.clear();
    failures = 0;
  }
  void write() const {
    AtomicFile file(target, Existing::replace, GetParam());
    file.write("content", 7);
    file.commit();
  }
  const TempFolder folder;
};
INSTANTIATE_TEST_SUITE_P(Kinds, DurableWrite,
                         ::testing::Values(AtomicFile::Unfinished::unnamed_if_possible, AtomicFile::Unfinished::named));

TEST_P(DurableWrite, BytesAreOnTheDiskBeforeTheNameAndTheNameBeforeTheEnd) {
  for (const bool replaces : {false, true}) {
    if (replaces) folder.file("target", "before");
    synced.clear();
    write();
    ASSERT_EQ(synced.size(), 2u);
    EXPECT_FALSE(synced[0].folder);
    EXPECT_FALSE(synced[0].target_is_there);
    EXPECT_EQ(synced[0].bytes, 7);
    EXPECT_TRUE(synced[1].folder);
    EXPECT_TRUE(synced[1].target_is_there);
  }
}

TEST_P(DurableWrite, ADiskThatFailsLeavesTheTargetAsItWas) {
  folder.file("target", "before");
  failures = 1;
  fail_with = EIO;
  expect_error([&] { write(); }, ErrorCode::output, "target: cannot write it: ");
  EXPECT_EQ(read_bytes(target), "before");
  std::filesystem::remove(target);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST_P(DurableWrite, WaitsOnAfterASignalAndTakesWhatCannotSync) {
  for (const int error : {EINTR, EINVAL}) {
    failures = 1;
    fail_with = error;
    EXPECT_NO_THROW(write());
    EXPECT_EQ(read_bytes(target), "content");
  }
}

// Of thousands of files that are made again where one is missing, none is waited for; each appears whole all the same.
TEST_P(DurableWrite, IsLeftToTheSystemWhereTheCallerSaysSo) {
  for (const bool replaces : {false, true}) {
    if (replaces) folder.file("target", "before");
    synced.clear();
    AtomicFile file(target, Existing::replace, GetParam());
    file.leave_to_system();
    file.write("content", 7);
    EXPECT_EQ(std::filesystem::exists(target), replaces);
    file.commit();
    EXPECT_TRUE(synced.empty());
    EXPECT_EQ(read_bytes(target), "content");
  }
}

TEST(DurablePipe, IsNotSynced) {
  synced.clear();
  AtomicFile file("/dev/null");
  file.write("content", 7);
  file.commit();
  EXPECT_TRUE(synced.empty());
}

}  // namespace
}  // namespace standoff
