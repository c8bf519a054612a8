// SPDX-License-Identifier: Apache-2.0
// Fibers: stacks of their own that take turns on one thread of the machine. Over Boost.Context where it is there, over
// ucontext (slower: a system call a switch) where not. Every switch is announced to the sanitizers.
#pragma once

#include <cstddef>

namespace standoff::emulation {

/// A function with a stack. It runs when resumed, until it parks itself or ends.
class Fiber {
 public:
  Fiber();
  ~Fiber();
  Fiber(const Fiber&) = delete;
  Fiber& operator=(const Fiber&) = delete;

  /// Makes ready to run `entry` from its beginning; what ran before is forgotten. `entry` must not throw, and must
  /// call finish() where it ends.
  void start(void (*entry)());
  /// Runs the fiber until it parks or ends. Called from the thread's own stack.
  void resume();
  /// Returns to whoever resumed this fiber. Called on the fiber.
  void park();
  /// The same, for good.
  [[noreturn]] void finish();

 private:
  static constexpr std::size_t kStackBytes = std::size_t{64} << 10;

  void leave(bool for_good);

  char* stack_ = nullptr;  // its lowest byte; below it lies a page that faults
  struct Context;
  Context* context_;
};

/// Tells the thread sanitizer that what happened before a release at `tag` happens before an acquire of it.
void release(void* tag);
void acquire(void* tag);

}  // namespace standoff::emulation
