// SPDX-License-Identifier: Apache-2.0
// Where work runs, and how long work tells how far it is.
#pragma once

#include <functional>

namespace standoff {

/// Where work runs (docs/cuda.md).
enum class Backend {
  automatic,  ///< an NVIDIA GPU where there is one and the work is large enough for it, else the CPU
  cpu,
  cuda,  ///< an NVIDIA GPU
};

/// The instruction set that fills fields on the CPU. The bits of the result do not depend on it.
enum class Simd { automatic, portable, avx2, avx512 };

/// The most threads that may be asked for: more than any machine has, fewer than the system would refuse.
inline constexpr int kMaxThreads = 1024;

/// Where a call runs. No member changes a result, but for which pair of touching triangles a GPU reports. Every call
/// throws Error{usage} for values that make no sense and for a backend that it does not have.
struct Execution {
  /// At most kMaxThreads. 0: the concurrency of the calling TBB arena, by default all cores.
  int threads = 0;
  Backend backend = Backend::automatic;
  int device = 0;  ///< which GPU, from 0, for Backend::cuda
  Simd simd = Simd::automatic;
};

struct Progress {
  const char* stage = "";  ///< of compute: "prepare", "bin", "gather", "copy" (from a GPU), "hash" (not of
                           ///< compute_into dense memory), "done"; of verify: "sort", "verify"
  double fraction = 0;     ///< of the whole work, 0 to 1, never falling
};

/// Called now and then, from one thread at a time; return false to cancel, which throws Error{interrupted}. What it
/// throws itself ends the work and comes out of the call as it is.
using ProgressCallback = std::function<bool(const Progress&)>;

}  // namespace standoff
