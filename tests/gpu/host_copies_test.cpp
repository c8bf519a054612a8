// SPDX-License-Identifier: Apache-2.0
// Copies by pieces, emulated: arrays of many pieces and odd ends arrive whole, from and to several threads; an
// exception of a callback is the caller's.
#include "gpu/host_copies.cuh"

#include <gtest/gtest.h>

#include <numeric>
#include <stdexcept>
#include <vector>

namespace standoff::emulated {
namespace {

std::vector<std::uint32_t> numbers(std::int64_t count, std::uint32_t first) {
  std::vector<std::uint32_t> all(static_cast<std::size_t>(count));
  std::iota(all.begin(), all.end(), first);
  return all;
}

HostArray array_of(std::vector<std::uint32_t>& to, const std::vector<std::uint32_t>& from, std::int64_t words) {
  return {to.data(), static_cast<std::int64_t>(from.size()) / words, 4 * words,
          [&from, words](void* piece, std::int64_t first, std::int64_t count) {
            std::copy_n(from.data() + words * first, words * count, static_cast<std::uint32_t*>(piece));
          }};
}

TEST(HostCopies, ArraysOfManyPiecesArriveWhole) {
  // Of 6 words an item: pieces that no power of two fills. No item, one, and more than all workers have pieces for.
  for (const std::int64_t items : {0, 1, 43'690, 43'691, 1'000'001})
    for (const int threads : {1, 4}) {
      const std::vector<std::uint32_t> first = numbers(6 * items, 1), second = numbers(77, 5), none;
      std::vector<std::uint32_t> to_first(first.size()), to_second(second.size()), to_none;
      copy_in_by_pieces(threads,
                        {array_of(to_first, first, 6), array_of(to_none, none, 1), array_of(to_second, second, 1)});
      EXPECT_TRUE(to_first == first && to_second == second) << items << " " << threads;
    }
}

TEST(HostCopies, EveryItemComesBackOnce) {
  constexpr std::int64_t kCount = 3'000'003, kTaken = 100'000, kAtOnce = 30'000;
  const std::vector<std::uint32_t> from = numbers(kCount, 7);
  for (const int threads : {1, 4}) {
    std::vector<std::uint32_t> to(from.size(), 0);
    std::atomic<std::int64_t> taken{0}, used{0};
    copy_out_by_pieces(
        threads, {kCount, 4, kTaken, kAtOnce},
        [&](int, std::int64_t first, std::int64_t count) {
          EXPECT_EQ(first % kTaken, 0);
          taken += count;
        },
        [&](void* piece, std::int64_t first, std::int64_t count) {
          copy_out_later(piece, from.data() + first, 4 * count, nullptr);
        },
        [&](int, const void* piece, std::int64_t first, std::int64_t count) {
          std::copy_n(static_cast<const std::uint32_t*>(piece), count, to.data() + first);
          used += count;
        });
    EXPECT_EQ(taken, kCount);
    EXPECT_EQ(used, kCount);
    EXPECT_TRUE(to == from);
  }
}

TEST(HostCopies, AnExceptionOfACallbackIsThrownAgain) {
  std::vector<std::uint32_t> to(3'000'000);
  const HostArray fails{to.data(), 3'000'000, 4, [](void*, std::int64_t first, std::int64_t) {
                          if (first > 1'000'000) throw std::runtime_error("no more");
                        }};
  EXPECT_THROW(copy_in_by_pieces(4, {fails}), std::runtime_error);
  // The pieces can be used again.
  const std::vector<std::uint32_t> from = numbers(1'000'000, 3);
  copy_in_by_pieces(4, {array_of(to, from, 1)});
  EXPECT_TRUE(std::equal(from.begin(), from.end(), to.begin()));
}

}  // namespace
}  // namespace standoff::emulated
