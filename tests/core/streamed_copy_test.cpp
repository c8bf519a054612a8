// SPDX-License-Identifier: Apache-2.0
// Copies past the caches, to places and of lengths that they are made for, and others.
#include "core/streamed_copy.h"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>

namespace standoff {
namespace {

TEST(StreamedCopy, CopiesWhatItSaysAndNothingElse) {
  constexpr std::size_t kSize = 256;
  alignas(64) std::array<unsigned char, kSize> from{}, to{};
  for (std::size_t n = 0; n < kSize; ++n) from[n] = static_cast<unsigned char>(n);
  for (const std::size_t bytes : {0, 1, 15, 16, 48, 100, 128})
    for (const std::size_t begin : {0, 4, 16, 33, 64})
      for (const std::size_t source : {0, 7}) {
        to.fill(0xee);
        {
          const StreamedCopies copies;
          copies.copy(to.data() + begin, from.data() + source, bytes);
        }
        for (std::size_t n = 0; n < kSize; ++n)
          EXPECT_EQ(to[n], n >= begin && n < begin + bytes ? from[source + n - begin] : 0xee);
      }
}

}  // namespace
}  // namespace standoff
