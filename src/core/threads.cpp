// SPDX-License-Identifier: Apache-2.0
#include "core/threads.h"

#include <tbb/parallel_for.h>

#include <array>
#include <atomic>
#include <cstddef>

#include "core/side_by_side.h"

namespace standoff {
namespace {

// A place for an idle arena. Calls at the same time, and calls with different numbers of threads, need an arena each.
// The number of places is arbitrary: an idle arena takes some KB.
struct ArenaPlace {
  std::atomic<tbb::task_arena*> arena{nullptr};
  std::atomic<int> threads{0};  // a hint: the number of threads of the last arena in this place
};
constexpr std::size_t kArenaPlaces = 16;
// The arenas are never destroyed: threads may end later than this library.
std::array<ArenaPlace, kArenaPlaces> kept_arenas;
std::atomic<std::size_t> next_arena_to_go{0};

void give_back_arena(tbb::task_arena* arena) {
  const int threads = arena->max_concurrency();  // read it now: once in its place, others may take and delete the arena
  for (ArenaPlace& place : kept_arenas) {
    tbb::task_arena* none = nullptr;
    if (!place.arena.compare_exchange_strong(none, arena)) continue;
    place.threads.store(threads, std::memory_order_relaxed);
    return;
  }
  // All places are taken: replace one arena.
  ArenaPlace& place = kept_arenas[next_arena_to_go.fetch_add(1, std::memory_order_relaxed) % kArenaPlaces];
  place.threads.store(threads, std::memory_order_relaxed);
  delete place.arena.exchange(arena);
}

}  // namespace

BorrowedArena::BorrowedArena(int threads) : arena_(nullptr) {
  for (ArenaPlace& place : kept_arenas) {
    if (place.threads.load(std::memory_order_relaxed) != threads) continue;
    arena_ = place.arena.exchange(nullptr);
    if (!arena_) continue;
    if (arena_->max_concurrency() == threads) return;
    give_back_arena(arena_);
  }
  arena_ = new tbb::task_arena(threads);
}

BorrowedArena::~BorrowedArena() { give_back_arena(arena_); }

void side_by_side(int threads, int count, const std::function<void(int)>& work) {
  if (count <= 1) {
    if (count == 1) work(0);
    return;
  }
  Threads(threads).run([&] { tbb::parallel_for(0, count, work); });
}

}  // namespace standoff
