// SPDX-License-Identifier: Apache-2.0
#include "core/threads.h"

#include <array>
#include <atomic>
#include <cstddef>

namespace standoff {
namespace {

// Arenas that no call uses, and for how many threads each of them is. Calls at the same time and of different numbers
// of threads need one each; the number of places is arbitrary, an idle arena takes some KB.
struct Place {
  std::atomic<tbb::task_arena*> arena{nullptr};
  std::atomic<int> threads{0};  // of the arena that came last: where to look
};
constexpr std::size_t kPlaces = 16;
// They are never destroyed: threads may end later than this library.
std::array<Place, kPlaces> places;
std::atomic<std::size_t> next_to_go{0};

void give_back(tbb::task_arena* arena) {
  for (Place& place : places) {
    tbb::task_arena* none = nullptr;
    if (!place.arena.compare_exchange_strong(none, arena)) continue;
    place.threads.store(arena->max_concurrency(), std::memory_order_relaxed);
    return;
  }
  // All are taken: one of them gives way.
  Place& place = places[next_to_go.fetch_add(1, std::memory_order_relaxed) % kPlaces];
  place.threads.store(arena->max_concurrency(), std::memory_order_relaxed);
  delete place.arena.exchange(arena);
}

}  // namespace

BorrowedArena::BorrowedArena(int threads) : arena_(nullptr) {
  for (Place& place : places) {
    if (place.threads.load(std::memory_order_relaxed) != threads) continue;
    arena_ = place.arena.exchange(nullptr);
    if (!arena_) continue;
    if (arena_->max_concurrency() == threads) return;
    give_back(arena_);
  }
  arena_ = new tbb::task_arena(threads);
}

BorrowedArena::~BorrowedArena() { give_back(arena_); }

}  // namespace standoff
