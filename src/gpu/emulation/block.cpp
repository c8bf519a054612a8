// SPDX-License-Identifier: Apache-2.0
// Fibers, and the threads of a block, which run on them.
#include "gpu/emulation/block.h"

#include <sys/mman.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <mutex>
#include <new>
#include <random>
#include <string>
#include <vector>

#include "standoff/error.h"

#ifdef STANDOFF_HAVE_BOOST_CONTEXT
#include <boost/context/detail/fcontext.hpp>
#else
#include <ucontext.h>
#endif

#ifndef __has_feature
#define __has_feature(x) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || __has_feature(address_sanitizer)
#define STANDOFF_ASAN 1
#include <sanitizer/common_interface_defs.h>
#endif
#if defined(__SANITIZE_THREAD__) || __has_feature(thread_sanitizer)
#define STANDOFF_TSAN 1
#include <sanitizer/tsan_interface.h>
#endif

// The thread sanitizer must not watch the switches themselves: it would report their bookkeeping as races.
#define STANDOFF_UNWATCHED __attribute__((no_sanitize("thread")))

namespace standoff::emulation {
namespace {

// Fibers have their own stacks, and take turns on one thread of the machine. They use Boost.Context if it is installed,
// else ucontext, which is slower: it needs a system call per switch. Every switch is announced to the sanitizers.

// A function with its own stack. When resumed, it runs until it parks itself or ends.
class Fiber {
 public:
  Fiber();
  ~Fiber();
  Fiber(const Fiber&) = delete;
  Fiber& operator=(const Fiber&) = delete;

  // Prepares the fiber to run `entry` from its beginning, and abandons what it ran before. `entry` must not throw, and
  // must end with finish().
  void start(void (*entry)());
  // Runs the fiber until it parks or ends. Called from the thread's own stack.
  void resume();
  // Returns to the thread that resumed this fiber. Called on the fiber.
  void park();
  // The same, but the fiber has ended.
  [[noreturn]] void finish();

 private:
  static constexpr std::size_t kStackBytes = std::size_t{64} << 10;

  void leave(bool for_good);

  char* stack_ = nullptr;  // the lowest byte; a page below it faults
  struct Context;
  Context* context_;
};

constexpr std::size_t kGuardBytes = 4096;

// The stack of the thread that resumes fibers. A single one suffices, as one emulated launch runs at a time.
struct {
#ifdef STANDOFF_HAVE_BOOST_CONTEXT
  boost::context::detail::fcontext_t context;
#else
  ucontext_t context;
#endif
  const void* stack_bottom;
  std::size_t stack_bytes;
  void* tsan;
} home;

void (*entry_of_next)();

struct Fiber::Context {
#ifdef STANDOFF_HAVE_BOOST_CONTEXT
  boost::context::detail::fcontext_t context{};
#else
  ucontext_t context{};
#endif
  void* asan_fake_stack = nullptr;
  void* tsan = nullptr;
  bool ended = false;
};

STANDOFF_UNWATCHED void arrive_first() {
#ifdef STANDOFF_ASAN
  __sanitizer_finish_switch_fiber(nullptr, &home.stack_bottom, &home.stack_bytes);
#endif
  entry_of_next();
  std::abort();  // entries end with finish()
}

#ifdef STANDOFF_HAVE_BOOST_CONTEXT
STANDOFF_UNWATCHED void arrive(boost::context::detail::transfer_t from) {
  home.context = from.fctx;
  arrive_first();
}
#else
STANDOFF_UNWATCHED void arrive() { arrive_first(); }
#endif

Fiber::Fiber() : context_(new Context) {
  void* memory = mmap(nullptr, kGuardBytes + kStackBytes, PROT_READ | PROT_WRITE,
                      MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED || mprotect(memory, kGuardBytes, PROT_NONE) != 0) {
    delete context_;
    throw std::bad_alloc();
  }
  stack_ = static_cast<char*>(memory) + kGuardBytes;
}

Fiber::~Fiber() {
#ifdef STANDOFF_TSAN
  if (context_->tsan) __tsan_destroy_fiber(context_->tsan);
#endif
  munmap(stack_ - kGuardBytes, kGuardBytes + kStackBytes);
  delete context_;
}

STANDOFF_UNWATCHED void Fiber::start(void (*entry)()) {
  entry_of_next = entry;
#ifdef STANDOFF_HAVE_BOOST_CONTEXT
  context_->context = boost::context::detail::make_fcontext(stack_ + kStackBytes, kStackBytes, arrive);
#else
  getcontext(&context_->context);
  context_->context.uc_stack.ss_sp = stack_;
  context_->context.uc_stack.ss_size = kStackBytes;
  context_->context.uc_link = nullptr;
  makecontext(&context_->context, arrive, 0);
#endif
#ifdef STANDOFF_TSAN
  // Making one takes a millisecond: do it only if the last run was abandoned midway.
  if (context_->tsan && !context_->ended) {
    __tsan_destroy_fiber(context_->tsan);
    context_->tsan = nullptr;
  }
  if (!context_->tsan) context_->tsan = __tsan_create_fiber(0);
#endif
  context_->ended = false;
}

STANDOFF_UNWATCHED void Fiber::resume() {
#ifdef STANDOFF_ASAN
  void* fake_stack = nullptr;
  __sanitizer_start_switch_fiber(&fake_stack, stack_, kStackBytes);
#endif
#ifdef STANDOFF_TSAN
  home.tsan = __tsan_get_current_fiber();
  __tsan_switch_to_fiber(context_->tsan, __tsan_switch_to_fiber_no_sync);  // a switch orders no memory
#endif
#ifdef STANDOFF_HAVE_BOOST_CONTEXT
  context_->context = boost::context::detail::jump_fcontext(context_->context, nullptr).fctx;
#else
  swapcontext(&home.context, &context_->context);
#endif
#ifdef STANDOFF_ASAN
  __sanitizer_finish_switch_fiber(fake_stack, nullptr, nullptr);
#endif
}

STANDOFF_UNWATCHED void Fiber::leave(bool for_good) {
  context_->ended = for_good;
#ifdef STANDOFF_TSAN
  __tsan_switch_to_fiber(home.tsan, __tsan_switch_to_fiber_no_sync);
#endif
#ifdef STANDOFF_ASAN
  __sanitizer_start_switch_fiber(for_good ? nullptr : &context_->asan_fake_stack, home.stack_bottom, home.stack_bytes);
#endif
#ifdef STANDOFF_HAVE_BOOST_CONTEXT
  home.context = boost::context::detail::jump_fcontext(home.context, nullptr).fctx;
#else
  swapcontext(&context_->context, &home.context);
#endif
#ifdef STANDOFF_ASAN
  __sanitizer_finish_switch_fiber(context_->asan_fake_stack, &home.stack_bottom, &home.stack_bytes);
#endif
}

STANDOFF_UNWATCHED void Fiber::park() { leave(false); }

STANDOFF_UNWATCHED void Fiber::finish() {
  leave(true);
  std::abort();  // a finished fiber is started again, never resumed
}

// Tells the thread sanitizer that everything before a release at `tag` happens before an acquire of it.
void release([[maybe_unused]] void* tag) {
#ifdef STANDOFF_TSAN
  __tsan_release(tag);
#endif
}

void acquire([[maybe_unused]] void* tag) {
#ifdef STANDOFF_TSAN
  __tsan_acquire(tag);
#endif
}

constexpr unsigned kWarp = 32;

enum class State { ready, at_block_barrier, at_warp_barrier, done };

struct Thread {
  Fiber fiber;
  Index3 index{};
  unsigned rank = 0;
  State state = State::done;
  CallSite at{};                // the barrier that it waits at
  std::uint32_t mask = 0;       // the mask of that barrier
  unsigned block_barriers = 0;  // barriers of the block that it has passed
  unsigned warp_barriers = 0;
};

// Two alternating tags: with a single one, a thread that runs ahead to the next barrier would hide races of the threads
// behind it.
struct Tags {
  char of_block[2] = {};
  char of_start = 0, of_end = 0;
};

struct Running {
  const char* label = "";
  Extent3 grid, block;
  Index3 at{};
  unsigned count = 0;  // threads per block
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
  // The waiting threads will not go on: their work is over.
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
  // Runs each warp alone as far as it can go before the next one: so if only a missing barrier of the block would order
  // two accesses, one happens too early or too late. In random order, warps also stop now and then.
  bool take_turns() {
    if (order_now == Order::random) std::shuffle(warps_.begin(), warps_.end(), random_);
    bool moved = false;
    for (const unsigned warp : warps_) {
      int rounds = order_now == Order::random ? static_cast<int>(random_() % 4) : -1;
      for (; rounds != 0 && run_warp(warp); --rounds) moved = true;
    }
    if (!moved)  // random order may have skipped the threads that could run
      for (const unsigned warp : warps_) moved |= run_warp(warp);
    return moved;
  }

  // Runs every thread of the warp that can run, then opens its barriers.
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

  // Opens the barriers that all threads of their mask have reached; the warp has the threads from first to end.
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
  std::vector<unsigned> warps_;  // warps in the order of their turns
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
  static std::vector<std::unique_ptr<Thread>> pool;  // keeps stacks from launch to launch
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
