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

/// What is said of a backend.
struct BackendInfo {
  Backend backend;
  const char* name;          ///< in options and reports
  bool has_devices = false;  ///< that are counted from 0: "cuda:1"
};

/// All backends. Checks, messages, help and reports ask this table.
inline constexpr BackendInfo kBackends[] = {
    {Backend::automatic, "auto"},
    {Backend::cpu, "cpu"},
    {Backend::cuda, "cuda", true},
    {Backend{1000}, "emulated", true},  // testing::kEmulated
};

/// The row of a backend; nullptr for numbers that are none.
constexpr const BackendInfo* find_info(Backend backend) {
  for (const BackendInfo& info : kBackends)
    if (info.backend == backend) return &info;
  return nullptr;
}

/// The name of a backend.
constexpr const char* name_of(Backend backend) {
  const BackendInfo* const info = find_info(backend);
  return info ? info->name : "";
}

/// The instruction set of the CPU's kernels: of compute() by the method `tiles`, of building a body's fields, and of
/// batches of collision queries. Queries without an Execution take the best set. verify(), closest_points(),
/// interpolation and Algorithm 1 have no kernels to choose. The bits of a result do not depend on the set.
enum class Simd { automatic, portable, avx2, avx512 };

/// The largest number of threads a call accepts.
inline constexpr int kMaxThreads = 1024;

/// Where a call runs. No member changes a result, with one exception: if several pairs of triangles intersect, a GPU
/// may report another pair than the CPU. Every call throws Error{usage} for invalid values and for a backend that it
/// does not have.
struct Execution {
  /// At most kMaxThreads. 0: the concurrency of the calling TBB arena, by default all cores.
  int threads = 0;
  Backend backend = Backend::automatic;
  int device = 0;  ///< which GPU, from 0, for Backend::cuda
  Simd simd = Simd::automatic;
};

}  // namespace standoff
