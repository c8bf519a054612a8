// SPDX-License-Identifier: Apache-2.0
// The emulation of CUDA itself: what kernels may do works in every order, and planted faults are found.
// labels: memory threads
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include "gpu/emulation/words.h"
#include "standoff/error.h"

#ifndef __has_feature
#define __has_feature(x) 0
#endif

namespace standoff::emulation {
namespace {

constexpr Order kOrders[] = {Order::forward, Order::reverse, Order::random};
constexpr unsigned kThreads = 96;

// Each block reverses its part of the numbers through shared memory.
template <bool kWithBarrier>
void reverse_parts(const int* in, int* out) {
  __shared__ int part[kThreads];
  const unsigned t = threadIdx.x, first = blockIdx.x * blockDim.x;
  part[t] = in[first + t];
  if (kWithBarrier) __syncthreads();
  out[first + t] = part[blockDim.x - 1 - t];
  if (kWithBarrier) __syncthreads();
}

template <bool kWithBarrier>
bool reverses_in(Order order) {
  constexpr unsigned kBlocks = 3;
  std::vector<int> in(kBlocks * kThreads), out(in.size(), -1);
  std::iota(in.begin(), in.end(), 1);
  const OrderScope scope(order, 7);
  launch("reverse", kBlocks, kThreads, [&] { reverse_parts<kWithBarrier>(in.data(), out.data()); });
  for (unsigned b = 0; b < kBlocks; ++b) std::reverse(in.begin() + b * kThreads, in.begin() + (b + 1) * kThreads);
  return in == out;
}

TEST(Emulation, BarriersOrderSharedMemory) {
  for (const Order order : kOrders) EXPECT_TRUE(reverses_in<true>(order));
}

#if !defined(__SANITIZE_THREAD__)
TEST(Emulation, AMissingBarrierShows) {
  int right = 0;
  for (const Order order : kOrders) right += reverses_in<false>(order);
  EXPECT_LT(right, 3);
}
#endif

std::string fault_of(const std::function<void()>& kernel, unsigned threads = 64) {
  try {
    launch("faulty", 2, threads, kernel);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::internal);
    return error.what();
  }
  return "";
}

TEST(Emulation, ABarrierThatSomeThreadsSkipIsNamed) {
  const std::string fault = fault_of([] {
    if (threadIdx.x < 40) __syncthreads();
  });
  EXPECT_NE(fault.find("kernel 'faulty', block 0,0,0: divergent barrier: 24 of 64 threads have ended"),
            std::string::npos)
      << fault;
  EXPECT_NE(fault.find("emulation_test.cpp:"), std::string::npos) << fault;
}

TEST(Emulation, BarriersAtDifferentPlacesAreNamed) {
  const std::string fault = fault_of([] {
    if (threadIdx.x < 40)
      __syncthreads();
    else
      __syncthreads();
  });
  EXPECT_NE(fault.find("divergent barrier: threads wait at different call sites"), std::string::npos) << fault;
}

TEST(Emulation, BarriersOnTheSameLineOfDifferentFilesAreNamed) {
  const std::string fault = fault_of([] { __syncthreads(threadIdx.x < 40 ? "one.cuh" : "other.cuh", 7); });
  EXPECT_NE(fault.find("threads wait at different call sites, one.cuh:7 and other.cuh:7"), std::string::npos) << fault;
}

TEST(Emulation, VotesOfOneWarpAtDifferentPlacesAreNamed) {
  const std::string fault = fault_of([] {
    if (threadIdx.x % 2)
      __ballot_sync(0xffffffffu, 1);
    else
      __ballot_sync(0xffffffffu, 0);
  });
  EXPECT_NE(fault.find("divergent warp: lanes wait at different call sites"), std::string::npos) << fault;
}

TEST(Emulation, AShuffleWithoutItsWarpIsNamed) {
  const std::string fault = fault_of([] {
    if (threadIdx.x % 32 < 20) __shfl_sync(0xffffffffu, 1, 0);
  });
  EXPECT_NE(fault.find("threads wait for each other at "), std::string::npos) << fault;
}

TEST(Emulation, WorksAfterAFault) {
  fault_of([] {
    if (threadIdx.x == 0) __syncthreads();
  });
  EXPECT_TRUE(reverses_in<true>(Order::forward));
}

TEST(Emulation, ShufflesAndVotes) {
  for (const Order order : kOrders) {
    const OrderScope scope(order, 3);
    std::vector<int> sums(kThreads), rotated(kThreads);
    std::vector<std::uint32_t> votes(kThreads), some_votes(kThreads);
    launch("warps", 1, kThreads, [&] {
      const int t = static_cast<int>(threadIdx.x);
      int sum = t;
      for (int bits = 16; bits > 0; bits /= 2) sum += __shfl_xor_sync(0xffffffffu, sum, bits);
      sums[t] = sum;
      rotated[t] = __shfl_sync(0xffffffffu, t, (t + 1) % 32);
      votes[t] = __ballot_sync(0xffffffffu, t % 3 == 0);
      if (t % 32 < 8) some_votes[t] = __ballot_sync(0xffu, t % 2);
      __syncwarp();
    });
    for (int t = 0; t < static_cast<int>(kThreads); ++t) {
      const int warp = t / 32;
      EXPECT_EQ(sums[t], 32 * 32 * warp + 31 * 16);
      EXPECT_EQ(rotated[t], 32 * warp + (t + 1) % 32);
      std::uint32_t expected = 0;
      for (int lane = 0; lane < 32; ++lane) expected |= std::uint32_t{(32 * warp + lane) % 3 == 0} << lane;
      EXPECT_EQ(votes[t], expected);
      EXPECT_EQ(some_votes[t], t % 32 < 8 ? 0xaau : 0u);
    }
  }
}

TEST(Emulation, AVoteOfAnUnfilledWarp) {
  std::uint32_t votes = 0;
  launch("votes", 1, 40, [&] {
    const std::uint32_t mine = __ballot_sync(0xffffffffu, 1);
    if (threadIdx.x == 39) votes = mine;
  });
  EXPECT_EQ(votes, 0xffu);
}

TEST(Emulation, IndicesAndAtomics) {
  std::vector<int> seen(2 * 3 * 4 * 5);
  int least = 1000, sum = 0;
  launch("indices", dim3(2, 3), dim3(4, 5), [&] {
    const unsigned block = blockIdx.x + gridDim.x * blockIdx.y, thread = threadIdx.x + blockDim.x * threadIdx.y;
    atomicAdd(&seen[block * blockDim.x * blockDim.y + thread], 1);
    atomicMin(&least, static_cast<int>(thread) + 5);
    atomicAdd(&sum, 1);
  });
  EXPECT_EQ(seen, std::vector<int>(seen.size(), 1));
  EXPECT_EQ(least, 5);
  EXPECT_EQ(sum, 120);
}

// The sanitizers find what they are for, through the fibers: each in the build that has it.
void write_past_shared_memory(int* out) {
  __shared__ int part[kThreads];
  part[threadIdx.x + (threadIdx.x == kThreads - 1 ? 1 : 0)] = 1;
  __syncthreads();
  out[threadIdx.x] = part[threadIdx.x];
}

TEST(EmulationDeathTest, TheAddressSanitizerSeesSharedMemory) {
#if defined(__SANITIZE_ADDRESS__) || __has_feature(address_sanitizer)
  std::vector<int> out(kThreads);
  EXPECT_DEATH(launch("faulty", 1, kThreads, [&] { write_past_shared_memory(out.data()); }),
               "global-buffer-overflow|out of bounds");
#else
  (void)write_past_shared_memory;
  GTEST_SKIP() << "not built with the address sanitizer";
#endif
}

TEST(EmulationDeathTest, TheThreadSanitizerSeesRaces) {
#if defined(__SANITIZE_THREAD__)
  ::testing::GTEST_FLAG(death_test_style) = "threadsafe";
  EXPECT_EXIT(
      {
        reverses_in<false>(Order::forward);
        std::exit(0);
      },
      ::testing::ExitedWithCode(66), "data race");
#else
  GTEST_SKIP() << "not built with the thread sanitizer";
#endif
}

}  // namespace
}  // namespace standoff::emulation
