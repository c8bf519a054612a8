// SPDX-License-Identifier: Apache-2.0
// Where the lines of a path begin; tests/fly asks it of the files that standoff fly writes.
#include "io/points/points.h"

#include <gtest/gtest.h>

#include "standoff/error.h"
#include "tests/support/error_code.h"

namespace standoff {
namespace {

TEST(PathStarts, OtherFilesOfPointsAreNoPaths) {
  EXPECT_FALSE(is_path("x,y,z\n1,2,3\n"));
  EXPECT_FALSE(is_path("ply\nformat ascii 1.0\nelement vertex 3\nend_header\n"));
  EXPECT_FALSE(is_path("ply\nformat ascii 1.0\nelement vertex 3\nelement face 1\nelement edge 2\nend_header\n"));
  EXPECT_FALSE(is_path(""));
}

TEST(PathStarts, DamagedTextHasStartsWithinThePoints) {
  for (const char* text : {"ply\nformat ascii 1.0\nelement edge 2\nend_header\n1 2\n0 1\n7 8\n-1 0\nx y\n",
                           "ply\nformat ascii 1.0\n", "flier,step,x\n\n\n", "flier,step\n0\n1\n1"})
    for (const std::size_t start : path_starts("path", text, 2)) EXPECT_LT(start, 2U) << text;
}

TEST(PathStarts, BinaryFilesAreRefused) {
  EXPECT_EQ(testing::code_of([] {
              path_starts("path.ply", "ply\nformat binary_little_endian 1.0\nelement edge 1\nend_header\n\1\0\0", 2);
            }),
            ErrorCode::input);
}

}  // namespace
}  // namespace standoff
