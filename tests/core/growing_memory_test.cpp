// SPDX-License-Identifier: Apache-2.0
#include "core/memory.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <functional>
#include <new>

#include "standoff/error.h"
#include "standoff/field.h"

namespace standoff {
namespace {

constexpr std::size_t kMiB = std::size_t{1} << 20;

TEST(GrowingMemory, GrowsWithoutMoving) {
  GrowingMemory memory;
  memory.reserve(std::size_t{1} << 40);  // far more than any machine has
  EXPECT_GE(memory.room(), std::size_t{1} << 40);
  memory.resize(kMiB);
  auto* const bytes = static_cast<unsigned char*>(memory.data());
  bytes[kMiB - 1] = 7;
  memory.resize(64 * kMiB);
  EXPECT_EQ(memory.data(), bytes);
  EXPECT_EQ(bytes[kMiB - 1], 7);
  EXPECT_EQ(bytes[64 * kMiB - 1], 0);
  memory.reserve(kMiB);
  EXPECT_EQ(memory.data(), bytes) << "there is room enough";
  EXPECT_EQ(memory.size(), 64 * kMiB);
}

TEST(GrowingMemory, WhatIsGivenBackIsZeroWhenItIsTakenAgain) {
  GrowingMemory memory;
  memory.reserve(4 * kMiB);
  memory.resize(2 * kMiB);
  auto* const bytes = static_cast<unsigned char*>(memory.data());
  bytes[0] = bytes[kMiB] = 7;
  memory.resize(kMiB);
  memory.resize(2 * kMiB);
  EXPECT_EQ(bytes[0], 7);
  EXPECT_EQ(bytes[kMiB], 0);
}

TEST(GrowingMemory, PagesAreAccounted) {
  static std::int64_t held = 0;
  const auto before = account_pages;
  account_pages = [](std::int64_t bytes) {
    if (bytes > static_cast<std::int64_t>(8 * kMiB)) throw std::bad_alloc();
    held += bytes;
  };
  {
    GrowingMemory memory;
    memory.reserve(64 * kMiB);
    EXPECT_EQ(held, 0);
    memory.resize(8 * kMiB);
    EXPECT_EQ(held, 8 * kMiB);
    EXPECT_THROW(memory.resize(32 * kMiB), std::bad_alloc);
    EXPECT_EQ(memory.size(), 8 * kMiB);
    memory.resize(3 * kMiB);
    EXPECT_EQ(held, 3 * kMiB);
    memory.reserve(256 * kMiB);  // new addresses: the pages are gone
    EXPECT_EQ(held, 0);
    memory.resize(kMiB);
  }
  EXPECT_EQ(held, 0);
  account_pages = before;
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which need addresses themselves

// Runs in a child that may use so many bytes of addresses more than it does.
int with_addresses(std::size_t bytes, const std::function<bool()>& call) {
  const pid_t child = ::fork();
  if (child == 0) {
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    const rlim_t most = pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) + bytes;
    const rlimit limit{most, most};
    ::setrlimit(RLIMIT_AS, &limit);
    ::_exit(call() ? 0 : 1);
  }
  int status = -1;
  ::waitpid(child, &status, 0);
  return status;
}

TEST(GrowingMemory, TakesAPartOfTheAddressesWhereTheyAreFew) {
  EXPECT_EQ(with_addresses(64 * kMiB,
                           [] {
                             GrowingMemory memory;
                             memory.reserve(1024 * kMiB);
                             if (memory.room() < 8 * kMiB || memory.room() > 32 * kMiB) return false;
                             memory.resize(memory.room());
                             static_cast<char*>(memory.data())[memory.room() - 1] = 1;
                             return true;
                           }),
            0);
}

TEST(GrowingMemory, AFieldThatNeedsMoreAddressesIsALimitError) {
  EXPECT_EQ(with_addresses(64 * kMiB,
                           [] {
                             DistanceField field({{8 * 1024, 8 * 1024, 8}, {}, {1, 1, 1}}, 1);
                             std::int64_t stored = 0;
                             try {
                               for (;; ++stored) field.store_tile(stored % 1024, stored / 1024, 0)[0] = 1;
                             } catch (const Error& error) {
                               return error.code() == ErrorCode::limit && stored > 1000 &&
                                      field.stored_tiles() == stored &&
                                      std::string(error.what()).find("addresses") != std::string::npos;
                             }
                           }),
            0);
}

#endif

}  // namespace
}  // namespace standoff
