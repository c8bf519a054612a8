// SPDX-License-Identifier: Apache-2.0
// How many numbers CUB sums up at once, which depends on its version.
#include <gtest/gtest.h>

#include <string>

#include "gpu/scan.h"

namespace standoff {
namespace {

// CUB before 2.7 sums an int's worth of numbers; of more it took the first few, and said nothing.
TEST(CudaRunningSum, WhatTheLibraryCannotCountIsRefused) {
  EXPECT_GT(gpu::longest_running_sum(200700), std::int64_t{1} << 40);
  const std::int64_t longest = gpu::longest_running_sum(200500);
  EXPECT_EQ(longest, 2147483647);
  EXPECT_NO_THROW(gpu::expect_summable(longest, longest));
  try {
    gpu::expect_summable(longest + 1, longest);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::limit);
    EXPECT_NE(std::string(error.what()).find("over 2147483648 numbers, of which this build sums up 2147483647 at most"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace standoff
