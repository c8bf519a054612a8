// SPDX-License-Identifier: Apache-2.0
// Runs CUDA kernels on the CPU, to test them without a GPU: the threads of a block are fibers that take turns, and
// blocks run one after another. words.h defines the CUDA words of the kernels.
//
// It finds: missing barriers (results differ between the three orders), races within a block (under the thread
// sanitizer), accesses out of bounds (under the address sanitizer; shared memory is plain static memory), and barriers,
// votes and shuffles that not all threads reach, or reach at different call sites (an Error that names them). It does
// not find: races between blocks, which never run at once here; wrong assumptions about the order in which other
// threads see writes; errors with cooperative groups, asynchronous copies, or streams, which are in order here; bank
// conflicts and other matters of time; reads of shared memory before it is written, which hold what the block before
// left there. It is stricter than the hardware: a barrier is a fault once a thread of the block has ended.
#pragma once

#include <cstdint>
#include <functional>

namespace standoff::emulation {

/// The order in which the threads of a block take turns. Forward and reverse let each warp run alone as far as it can,
/// the first or the last one first; random mixes warps and stops them now and then.
enum class Order { forward, reverse, random };

/// While it lives, launches run in this order. Not thread-safe.
class OrderScope {
 public:
  explicit OrderScope(Order order, unsigned seed = 1);
  ~OrderScope();
  OrderScope(const OrderScope&) = delete;
  OrderScope& operator=(const OrderScope&) = delete;

 private:
  Order before_;
  unsigned seed_before_;
};

struct Index3 {
  unsigned x, y, z;
};

struct Extent3 {
  unsigned x = 1, y = 1, z = 1;
  Extent3(unsigned width = 1, unsigned height = 1, unsigned depth = 1) : x(width), y(height), z(depth) {}
};

/// Runs `body` once for every thread of every block. One launch runs at a time; others wait. Throws Error{internal} if
/// threads wait for each other for ever.
void launch(const char* label, Extent3 grid, Extent3 block, const std::function<void()>& body);

/// The number of launches so far, for tests that count them.
std::int64_t launch_count();

// Functions for a running thread.
Index3 thread_index();
Index3 block_index();
Extent3 block_extent();
Extent3 grid_extent();
unsigned lane();

/// The place in the source where a thread waits.
struct CallSite {
  const char* file;
  int line;
};

/// Waits for all threads of the block.
void block_barrier(const CallSite& at);
/// Waits for the threads of the warp named in `mask`.
void warp_barrier(std::uint32_t mask, const CallSite& at);
/// A slot per lane of the calling thread's warp, for shuffles and votes.
std::uint64_t& exchange_slot(unsigned of_lane);
/// The lanes of the warp that exist.
std::uint32_t existing_lanes();

}  // namespace standoff::emulation
