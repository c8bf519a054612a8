// SPDX-License-Identifier: Apache-2.0
#include "files/atomic_file.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace standoff {
namespace {

TEST(TempFile, IsItsOwnersAndGoes) {
  std::filesystem::path path;
  {
    const TempFile file(".obj", "v 0 0 0\n");
    path = file.path();
    EXPECT_EQ(path.extension(), ".obj");
    EXPECT_EQ(std::filesystem::file_size(path), 8u);
    EXPECT_EQ(std::filesystem::status(path).permissions(),
              std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace standoff
