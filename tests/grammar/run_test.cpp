// SPDX-License-Identifier: Apache-2.0
// What counts files must see each way in which one can go wrong, or its zeros say nothing.
#include "tests/grammar/run.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/grammar/judge.h"
#include "tests/support/temp_folder.h"

namespace standoff::grammar {
namespace {

class Run : public ::testing::Test {
 protected:
  const TempFolder own;
  const std::filesystem::path folder = own / "files";

  void SetUp() override {
    std::filesystem::create_directory(folder);
    set_traps(folder);
  }
  Tally count(File (*make)(Choices&), const Bounds& bounds = {}) const {
    return run({"off", Kind::mesh, make}, 1, 20, folder, bounds);
  }
};

File triangle(Choices&) {
  File file{"OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", {}, {}};
  file.truth.triangles = {{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}}};
  return file;
}

TEST_F(Run, GoodFilesAreRead) {
  const Tally tally = count(triangle);
  EXPECT_EQ(tally.files, 20u);
  EXPECT_EQ(tally.read, 20u);
  EXPECT_EQ(tally.compared, 20u);
  EXPECT_EQ(tally.bad(), 0u);
}

TEST_F(Run, OtherTrianglesThanWereWrittenAreWrong) {
  const Tally moved = count([](Choices& c) {
    File file = triangle(c);
    file.truth.triangles[0][2].y = 2;
    return file;
  });
  EXPECT_EQ(moved.wrong, 20u);
  EXPECT_FALSE(std::filesystem::is_empty(folder / "bad"));
  EXPECT_NE(moved.faults.at(0).find("triangle 0, (0, 0, 0) (1, 0, 0) (0, 2, 0), is not there"), std::string::npos);
  const Tally slack = count([](Choices& c) {
    File file = triangle(c);
    file.truth.slack = {1e-9};
    file.truth.triangles[0][2].y += 1e-6;
    return file;
  });
  EXPECT_EQ(slack.wrong, 20u);
}

TEST_F(Run, GoodFilesThatAreRefusedAreWrong) {
  const auto cut = [](Choices& c) {
    File file = triangle(c);
    file.bytes = "OFF 3 1 0\n";
    return file;
  };
  EXPECT_EQ(count(cut).wrong, 20u);
  const Tally allowed = count([](Choices& c) {
    File file = triangle(c);
    file.bytes = "OFF 3 1 0\n";
    file.may_be_refused = true;
    return file;
  });
  EXPECT_EQ(allowed.refused, 20u);
  EXPECT_EQ(allowed.bad(), 0u);
  EXPECT_EQ(allowed.good, 0u);
}

TEST_F(Run, DeathsAreCountedAndTheRestIsRead) {
  const Tally tally = count([](Choices& c) {
    static int files = 0;
    if (++files == 3) std::_Exit(3);
    return triangle(c);
  });
  // Each child makes two files before the third ends it: of twenty, six end so.
  EXPECT_EQ(tally.crashed, 6u);
  EXPECT_EQ(tally.read, 14u);
  EXPECT_EQ(tally.faults.size(), 6u);
}

TEST_F(Run, TimeIsBounded) {
  const Tally tally = count(triangle, {.seconds = 1e-6});
  EXPECT_EQ(tally.hung, 20u);
}

#ifndef STANDOFF_SANITIZED
TEST_F(Run, MemoryIsBounded) {
  const Tally tally = count(triangle, {.times_its_size = 0, .and_bytes = 16});
  EXPECT_EQ(tally.over_memory, 20u);
}
#endif

}  // namespace
}  // namespace standoff::grammar
