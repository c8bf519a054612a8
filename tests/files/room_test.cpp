// SPDX-License-Identifier: Apache-2.0
// labels: memory
// What does not fit on a disk is refused; a disk that does not tell, or nearly full, refuses nothing that fits.
#include "files/atomic_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "standoff/io.h"
#include "standoff/slabs.h"
#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

constexpr double kMiB = 1 << 20;

TEST(Room, WhatDoesNotFitIsRefused) {
  expect_room("a.vti", 3 * kMiB, 3 << 20);
  expect_error([] { expect_room("a.vti", 3 * kMiB + 1, 3 << 20); }, ErrorCode::output,
               "a.vti: cannot write it: it takes 4 MiB, and its disk has 3 MiB free; free some");
}

TEST(Room, ADiskThatDoesNotTellRefusesNothing) {
  expect_room("a.vti", 1e300, std::nullopt);
  const TempFolder folder;
  EXPECT_FALSE(room_for(folder / "no/a.vti")) << "there is no such folder";
  EXPECT_FALSE(room_for("/dev/null"));
  ASSERT_EQ(::mkfifo((folder / "pipe.vti").c_str(), 0600), 0);
  EXPECT_FALSE(room_for(folder / "pipe.vti"));
}

TEST(Room, IsThatOfTheFolderWhereLinksEnd) {
  const TempFolder folder;
  const auto room = room_for(folder / "a.vti");
  ASSERT_TRUE(room) << "of the disk with temporary files";
  EXPECT_LE(*room, std::filesystem::space(folder.path()).capacity);
  std::filesystem::create_symlink("/dev/null", folder / "link.vti");
  EXPECT_FALSE(room_for(folder / "link.vti"));
  write_bytes(folder / "old.vti", "old");
  EXPECT_TRUE(room_for(folder / "old.vti"));
}

// Of a grid that no disk has room for; nobody may ask for a slab.
class Endless : public FieldSlabs {
 public:
  const Grid& grid() const override { return grid_; }
  double thickness() const override { return 1; }
  const Provenance& provenance() const override { return provenance_; }
  bool has_nearest() const override { return false; }
  const DistanceField* next() override {
    ADD_FAILURE() << "a slab was made";
    return nullptr;
  }

 private:
  Grid grid_{{1 << 20, 1 << 20, 1 << 20}, {0, 0, 0}, {1, 1, 1}};
  Provenance provenance_;
};

TEST(Room, IsLookedAtBeforeAFieldIsWritten) {
  const TempFolder folder;
  for (const char* name : {"a.vti", "a.nrrd", "a.npz"}) {
    Endless slabs;
    expect_error([&] { write_field(folder / name, slabs, {.compress = false}); }, ErrorCode::output,
                 "it takes 4398046511104 MiB");
  }
  EXPECT_TRUE(folder.names().empty());
}

}  // namespace
}  // namespace standoff
