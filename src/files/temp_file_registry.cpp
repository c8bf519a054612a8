// SPDX-License-Identifier: Apache-2.0
#include "files/temp_file_registry.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <cstring>

namespace standoff {
namespace {

// A handler may neither allocate nor lock: fixed slots, each published by one atomic store after its name is complete.
enum State : int { kFree, kFilling, kNoted };

struct Slot {
  std::atomic<int> state{kFree};
  std::array<char, 4096> name{};
};
static_assert(std::atomic<int>::is_always_lock_free);

// More files than one process writes at a time.
std::array<Slot, 32> slots;

}  // namespace

int note_unfinished(const std::filesystem::path& path) noexcept {
  const auto& name = path.native();
  if (name.size() >= slots[0].name.size()) return -1;
  for (std::size_t s = 0; s < slots.size(); ++s) {
    int expected = kFree;
    if (!slots[s].state.compare_exchange_strong(expected, kFilling)) continue;
    std::memcpy(slots[s].name.data(), name.c_str(), name.size() + 1);
    slots[s].state = kNoted;
    return static_cast<int>(s);
  }
  return -1;
}

void forget_unfinished(int slot) noexcept {
  if (slot >= 0) slots[static_cast<std::size_t>(slot)].state = kFree;
}

void remove_unfinished_files() noexcept {
  for (Slot& slot : slots)
    if (slot.state == kNoted) ::unlink(slot.name.data());
}

}  // namespace standoff
