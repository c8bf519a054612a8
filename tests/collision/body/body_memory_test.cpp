// SPDX-License-Identifier: Apache-2.0
// memory_bytes() against a heap that counts.
#include <gtest/gtest.h>

#include "standoff/collision.h"
#include "tests/collision/solids.h"
#include "tests/support/heap.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

using namespace standoff::testing;

// Bookkeeping that the contract leaves out: list heads, the shared pointer's counts, and padding to cache lines.
constexpr std::int64_t kBookkeeping = 4096;

void expect_counted(const Body& body, std::int64_t held) {
  EXPECT_LE(body.memory_bytes(), held);
  EXPECT_GE(body.memory_bytes(), held - kBookkeeping);
}

void expect_what_the_heap_holds(const Mesh& mesh) {
  const Body once(ball_mesh(1, 3), {.execution = {.threads = 1}});  // what is made on first use is not the body's
  const TempFolder folder;
  const std::int64_t before = testing::heap::held;
  const Body built(mesh, {.spacing = 0.1, .execution = {.threads = 1}});
  expect_counted(built, testing::heap::held - before);

  built.save(folder.path() / "x.body");
  const std::int64_t then = testing::heap::held;
  const Body loaded = Body::load(folder.path() / "x.body");
  expect_counted(loaded, testing::heap::held - then);

  const std::int64_t now = testing::heap::held;
  const Body copy = built;  // NOLINT(performance-unnecessary-copy-initialization)
  EXPECT_EQ(testing::heap::held, now) << "copies share";
  EXPECT_EQ(copy.memory_bytes(), built.memory_bytes());
}

// The triangles in packets of sixteen, 36 bytes each, were once left out: a fifth of a body's memory beside its
// fields.
TEST(BodyMemory, IsWhatTheHeapHolds) { expect_what_the_heap_holds(random_soup(3, 5000, 1, 0.05)); }

TEST(BodyMemory, OfASignedField) { expect_what_the_heap_holds(solid_ball(1, 40)); }

}  // namespace
}  // namespace standoff
