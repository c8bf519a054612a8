// SPDX-License-Identifier: Apache-2.0
// Where work runs.
#pragma once

namespace standoff {

/// Where work runs (docs/cuda.md).
enum class Backend {
  automatic,  ///< an NVIDIA GPU if there is one and the work is large enough for it, else the CPU
  cpu,
  cuda,  ///< an NVIDIA GPU
};

/// The instruction set that fills fields on the CPU. The bits of the result do not depend on it.
enum class Simd { automatic, portable, avx2, avx512 };

/// The largest number of threads a call accepts.
inline constexpr int kMaxThreads = 1024;

/// Where a call runs. No member changes a result, except which of several intersecting pairs of triangles a GPU
/// reports. Every call throws Error{usage} for invalid values and for a backend that it does not have.
struct Execution {
  /// At most kMaxThreads. 0: the concurrency of the calling TBB arena, by default all cores.
  int threads = 0;
  Backend backend = Backend::automatic;
  int device = 0;  ///< which GPU, from 0, for Backend::cuda
  Simd simd = Simd::automatic;
};

}  // namespace standoff
