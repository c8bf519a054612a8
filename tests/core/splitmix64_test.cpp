// SPDX-License-Identifier: Apache-2.0
#include "core/hashes.h"

#include <gtest/gtest.h>

#include "scenes/random.h"

namespace standoff {
namespace {

// The first numbers of Vigna's splitmix64.c from the seed 1234567. Hashes of meshes and flights of bodies depend on
// them.
TEST(Splitmix64, GivesThePublishedNumbers) {
  std::uint64_t state = 1234567;
  for (const std::uint64_t expected : {6457827717110365317u, 3203168211198807973u, 9817491932198370423u,
                                       4593380528125082431u, 16408922859458223821u}) {
    EXPECT_EQ(splitmix64(state), expected);
    EXPECT_EQ(scenes::hash(state), expected) << "the scenes' own copy";
    state += kSplitmixStep;
  }
}

}  // namespace
}  // namespace standoff
