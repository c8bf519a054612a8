// SPDX-License-Identifier: Apache-2.0
// The threads of a call: as many as asked for, and nothing that is made anew for each call or mixes with the caller's
// own tasks.
#include "core/threads.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <tbb/parallel_for.h>
#include <tbb/task_group.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <stdexcept>
#include <thread>
#include <vector>

namespace standoff {
namespace {

std::int64_t memory_in_use() {
  std::int64_t all = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> all >> resident;
  return resident * ::getpagesize();
}

// Adds up 0 to 99 on so many threads.
int add_up(int threads) {
  std::atomic<int> sum{0};
  Threads(threads).run([&] { tbb::parallel_for(0, 100, [&](int n) { sum += n; }); });
  return sum;
}
constexpr int kSum = 4950;

TEST(Threads, CountsWhatTheWorkMayUse) {
  for (const int count : {1, 2, 3, 7}) {
    Threads threads(count);
    EXPECT_EQ(threads.count(), count);
    EXPECT_EQ(threads.run([] { return tbb::this_task_arena::max_concurrency(); }), count);
  }
  tbb::task_arena three(3);
  EXPECT_EQ(three.execute([] { return Threads(0).run([] { return tbb::this_task_arena::max_concurrency(); }); }), 3);
  EXPECT_THROW(Threads(2).run([] { throw std::runtime_error("passes"); }), std::runtime_error);
}

// TBB frees an arena long after its last use: one for each call took 6 to 10 KB a call, so 12 MB here. What threads
// keep at hand under the address sanitizer on a busy machine was 3 MB.
TEST(Threads, ManyCallsTakeNoMoreMemory) {
  for (const int threads : {0, 1, 2, 3, 5}) {
    for (int n = 0; n < 200; ++n) EXPECT_EQ(add_up(threads), kSum);
    const std::int64_t before = memory_in_use();
    for (int n = 0; n < 2000; ++n) add_up(threads);
    EXPECT_LT(memory_in_use() - before, 6'000'000) << threads << " threads";
  }
}

TEST(Threads, CallsAtOnceFromManyThreads) {
  std::vector<std::thread> callers;
  std::atomic<int> right{0};
  for (int caller = 0; caller < 20; ++caller)
    callers.emplace_back([&, caller] {
      for (int n = 0; n < 50; ++n) right += add_up((caller + n) % 5) == kSum;
    });
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(right, 20 * 50);
}

// A thread that waits for the work must not take up what else there is to do: it may hold what that waits for.
TEST(Threads, WorkIsApartFromTheCallersTasks) {
  static thread_local bool is_working = false;
  for (const int threads : {0, 1, 2}) {
    std::atomic<int> mixed{0}, done{0};
    const auto task = [&] {
      mixed += is_working;
      const bool before = is_working;
      is_working = true;
      Threads(threads).run([] { tbb::parallel_for(0, 64, [](int) { std::this_thread::yield(); }); });
      is_working = before;
      ++done;
    };
    tbb::parallel_for(0, 200, [&](int) { task(); });
    tbb::task_group group;
    for (int n = 0; n < 200; ++n) group.run(task);
    task();
    group.wait();
    EXPECT_EQ(done, 401);
    EXPECT_EQ(mixed, 0) << threads << " threads";
  }
}

// Else it would look as if it was done.
TEST(Threads, WorkOfACancelledTaskIsDone) {
  for (const int threads : {0, 1, 2, 3}) {
    std::atomic<int> sum{0};
    tbb::task_group group;
    group.run_and_wait([&] {
      group.cancel();
      sum = add_up(threads);
    });
    EXPECT_EQ(sum, kSum) << threads << " threads";
  }
}

TEST(Threads, CallsInCalls) {
  std::atomic<int> right{0};
  for (const int outer : {0, 1, 2, 3})
    Threads(outer).run([&] {
      right += add_up(0) == kSum;
      tbb::parallel_for(0, 20, [&](int n) { right += add_up(n % 4) == kSum; });
    });
  EXPECT_EQ(right, 4 * 21);
}

// Arenas are kept, but no lock is. A thread that is at work while another one forks may hold locks of TBB's own, for
// ever in the child: so the one beside has done its work.
TEST(Threads, AForkedProcessGoesOn) {
  for (const int threads : {0, 1, 2, 3}) ASSERT_EQ(add_up(threads), kSum);
  std::atomic<bool> worked{false}, done{false};
  std::thread beside([&] {
    add_up(2);
    worked = true;
    worked.notify_one();
    done.wait(false);
  });
  worked.wait(false);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));  // TBB's workers go to rest, too
  for (int n = 0; n < 20; ++n) {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      ::alarm(60);
      for (const int threads : {0, 1, 2})
        if (add_up(threads) != kSum) ::_exit(1);
      ::_exit(0);
    }
    int status = -1;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
  }
  done = true;
  done.notify_one();
  beside.join();
}

TEST(KeptByThread, IsOnesOwnWhileItIsUsed) {
  struct Counter {
    int uses = 0;
  };
  for (int n = 0; n < 3; ++n) {
    const KeptByThread<Counter> outer;
    EXPECT_EQ(outer->uses++, n);
    const KeptByThread<Counter> inner;  // as in a callback
    EXPECT_NE(&*outer, &*inner);
  }
  std::thread([] { EXPECT_EQ(KeptByThread<Counter>()->uses, 0); }).join();
}

}  // namespace
}  // namespace standoff
