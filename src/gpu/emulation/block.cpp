// SPDX-License-Identifier: Apache-2.0
#include "gpu/emulation/block.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <memory>
#include <mutex>
#include <random>
#include <string>
#include <vector>

#include "gpu/emulation/fiber.h"
#include "standoff/error.h"

#define STANDOFF_UNWATCHED __attribute__((no_sanitize("thread")))

namespace standoff::emulation {
namespace {

constexpr unsigned kWarp = 32;

enum class State { ready, at_block_barrier, at_warp_barrier, done };

struct Thread {
  Fiber fiber;
  Index3 index{};
  unsigned rank = 0;
  State state = State::done;
  CallSite at{};                // the barrier it waits at
  std::uint32_t mask = 0;       // of that barrier
  unsigned block_barriers = 0;  // passed so far
  unsigned warp_barriers = 0;
};

// Two alternating tags: with one, a thread that runs ahead to the next barrier would hide races of those behind it.
struct Tags {
  char of_block[2] = {};
  char of_start = 0, of_end = 0;
};

struct Running {
  const char* label = "";
  Extent3 grid, block;
  Index3 at{};
  unsigned count = 0;  // threads a block
  const std::function<void()>* body = nullptr;
  Thread** threads = nullptr;
  std::uint64_t* exchange = nullptr;
  char* warp_tags = nullptr;
  Tags tags;
  Thread* current = nullptr;
} running;

std::mutex one_at_a_time;
std::atomic<std::int64_t> launches{0};
Order order_now = Order::forward;
unsigned seed_now = 1;

STANDOFF_UNWATCHED void wait(State state, const CallSite& at) {
  running.current->state = state;
  running.current->at = at;
  running.current->fiber.park();
}

STANDOFF_UNWATCHED void run_thread() {
  acquire(&running.tags.of_start);
  (*running.body)();
  release(&running.tags.of_end);
  running.current->state = State::done;
  running.current->fiber.finish();
}

STANDOFF_UNWATCHED CallSite call_site_of(unsigned n) { return running.threads[n]->at; }
STANDOFF_UNWATCHED bool same(const CallSite& a, const CallSite& b) {
  return a.line == b.line && std::strcmp(a.file, b.file) == 0;
}

[[noreturn]] void fail(const std::string& what) {
  // The threads that wait will not go on: what they did is over.
  for (char& tag : running.tags.of_block) acquire(&tag);
  acquire(&running.tags.of_end);
  for (unsigned n = 0; n < 2 * (running.count / kWarp + 1); ++n) acquire(&running.warp_tags[n]);
  throw Error(ErrorCode::internal, std::string("emulation: kernel '") + running.label + "', block " +
                                       std::to_string(running.at.x) + "," + std::to_string(running.at.y) + "," +
                                       std::to_string(running.at.z) + ": " + what);
}

class BlockRun {
 public:
  explicit BlockRun(std::mt19937& random) : random_(random), warps_((running.count + kWarp - 1) / kWarp) {
    for (unsigned n = 0; n < warps_.size(); ++n) warps_[n] = n;
    if (order_now == Order::reverse) std::reverse(warps_.begin(), warps_.end());
  }

  void run() {
    release(&running.tags.of_start);
    for (unsigned n = 0; n < running.count; ++n) {
      Thread& t = *running.threads[n];
      const unsigned width = running.block.x, height = running.block.y;
      t.rank = n;
      t.index = {n % width, n / width % height, n / (width * height)};
      t.state = State::ready;
      t.block_barriers = t.warp_barriers = 0;
      t.fiber.start(run_thread);
    }
    while (!all_done()) {
      bool moved = take_turns();
      moved |= open_block_barrier();
      if (!moved) fail("threads wait for each other at " + waiting_call_sites());
    }
    acquire(&running.tags.of_end);
  }

 private:
  // Each warp runs on its own as far as it can before the next one does, so that what only a barrier of the block would
  // order happens too early or too late. In random order it stops now and then, too.
  bool take_turns() {
    if (order_now == Order::random) std::shuffle(warps_.begin(), warps_.end(), random_);
    bool moved = false;
    for (const unsigned warp : warps_) {
      int rounds = order_now == Order::random ? static_cast<int>(random_() % 4) : -1;
      for (; rounds != 0 && run_warp(warp); --rounds) moved = true;
    }
    if (!moved)  // perhaps those that could run were passed over
      for (const unsigned warp : warps_) moved |= run_warp(warp);
    return moved;
  }

  // Lets every thread of the warp run that can, then opens its barriers.
  STANDOFF_UNWATCHED bool run_warp(unsigned warp) {
    const unsigned first = warp * kWarp, count = std::min(kWarp, running.count - first);
    const unsigned shift = order_now == Order::random ? static_cast<unsigned>(random_() % count) : 0;
    bool moved = false;
    for (unsigned n = 0; n < count; ++n) {
      Thread& t = *running.threads[first + (order_now == Order::reverse ? count - 1 - n : (n + shift) % count)];
      if (t.state != State::ready) continue;
      running.current = &t;
      t.fiber.resume();
      moved = true;
    }
    return open_warp_barriers(first, first + count) || moved;
  }

  unsigned count(State state) const {
    unsigned n = 0;
    for (unsigned i = 0; i < running.count; ++i) n += running.threads[i]->state == state;
    return n;
  }
  bool all_done() const { return count(State::done) == running.count; }

  // Opens the barriers of a warp, threads first to end, that all threads in the mask have reached.
  bool open_warp_barriers(unsigned first, unsigned end) {
    bool moved = false;
    for (unsigned n = first; n < end; ++n) {
      const Thread& t = *running.threads[n];
      if (t.state != State::at_warp_barrier) continue;
      bool all = true, together = true;
      for (unsigned m = first; m < end; ++m) {
        if (!(t.mask >> (m - first) & 1)) continue;
        const Thread& other = *running.threads[m];
        all &= other.state == State::at_warp_barrier && other.mask == t.mask;
        together &= !all || same(other.at, t.at);
      }
      if (!all) continue;
      if (!together) fail("divergent warp: lanes wait at different call sites, " + waiting_call_sites());
      const std::uint32_t mask = t.mask;
      for (unsigned m = first; m < end; ++m)
        if (mask >> (m - first) & 1) running.threads[m]->state = State::ready;
      moved = true;
    }
    return moved;
  }

  bool open_block_barrier() {
    const unsigned waiting = count(State::at_block_barrier), done = count(State::done);
    if (waiting == 0 || waiting + done != running.count) return false;
    if (done != 0)
      fail("divergent barrier: " + std::to_string(done) + " of " + std::to_string(running.count) +
           " threads have ended, the others wait at " + waiting_call_sites());
    for (unsigned n = 0; n < running.count; ++n)
      if (!same(call_site_of(n), call_site_of(0)))
        fail("divergent barrier: threads wait at different call sites, " + waiting_call_sites());
    for (unsigned n = 0; n < running.count; ++n) running.threads[n]->state = State::ready;
    return true;
  }

  std::string waiting_call_sites() const {
    std::vector<std::string> sites;
    for (unsigned n = 0; n < running.count; ++n)
      if (running.threads[n]->state == State::at_block_barrier || running.threads[n]->state == State::at_warp_barrier)
        sites.push_back(std::string(call_site_of(n).file) + ":" + std::to_string(call_site_of(n).line));
    std::sort(sites.begin(), sites.end());
    sites.erase(std::unique(sites.begin(), sites.end()), sites.end());
    std::string all;
    for (const std::string& one : sites) all += (all.empty() ? "" : " and ") + one;
    return all;
  }

  std::mt19937& random_;
  std::vector<unsigned> warps_;  // in the order of their turns
};

}  // namespace

OrderScope::OrderScope(Order order, unsigned seed) : before_(order_now), seed_before_(seed_now) {
  order_now = order;
  seed_now = seed;
}

OrderScope::~OrderScope() {
  order_now = before_;
  seed_now = seed_before_;
}

void launch(const char* label, Extent3 grid, Extent3 block, const std::function<void()>& body) {
  const std::lock_guard lock(one_at_a_time);
  ++launches;
  static std::vector<std::unique_ptr<Thread>> pool;  // stacks are kept from launch to launch
  const unsigned count = block.x * block.y * block.z;
  if (count == 0 || count > 1024)
    throw Error(ErrorCode::internal, std::string("emulation: kernel '") + label + "': a block has 1 to 1024 threads");
  while (pool.size() < count) pool.push_back(std::make_unique<Thread>());

  std::vector<Thread*> threads(count);
  for (unsigned n = 0; n < count; ++n) threads[n] = pool[n].get();
  std::vector<std::uint64_t> exchange(count);
  std::vector<char> warp_tags(2 * (count / kWarp + 1));
  running = {label, grid, block, {}, count, &body, threads.data(), exchange.data(), warp_tags.data(), {}, nullptr};
  std::mt19937 random(seed_now);
  BlockRun run(random);
  for (unsigned z = 0; z < grid.z; ++z)
    for (unsigned y = 0; y < grid.y; ++y)
      for (unsigned x = 0; x < grid.x; ++x) {
        running.at = {x, y, z};
        run.run();
      }
}

std::int64_t launch_count() { return launches; }

STANDOFF_UNWATCHED Index3 thread_index() { return running.current->index; }
STANDOFF_UNWATCHED Index3 block_index() { return running.at; }
STANDOFF_UNWATCHED Extent3 block_extent() { return running.block; }
STANDOFF_UNWATCHED Extent3 grid_extent() { return running.grid; }
STANDOFF_UNWATCHED unsigned lane() { return running.current->rank % kWarp; }

STANDOFF_UNWATCHED void block_barrier(const CallSite& at) {
  char* tag = &running.tags.of_block[running.current->block_barriers++ & 1];
  release(tag);
  wait(State::at_block_barrier, at);
  acquire(tag);
}

STANDOFF_UNWATCHED void warp_barrier(std::uint32_t mask, const CallSite& at) {
  char* tag = &running.warp_tags[2 * (running.current->rank / kWarp) + (running.current->warp_barriers++ & 1)];
  release(tag);
  running.current->mask = mask & existing_lanes();
  wait(State::at_warp_barrier, at);
  acquire(tag);
}

STANDOFF_UNWATCHED std::uint64_t& exchange_slot(unsigned of_lane) {
  return running.exchange[running.current->rank / kWarp * kWarp + of_lane];
}

STANDOFF_UNWATCHED std::uint32_t existing_lanes() {
  const unsigned left = running.count - running.current->rank / kWarp * kWarp;
  return left >= kWarp ? 0xffffffffu : (1u << left) - 1;
}

}  // namespace standoff::emulation
