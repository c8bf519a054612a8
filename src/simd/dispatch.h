// SPDX-License-Identifier: Apache-2.0
// Chooses a feature's kernels at run time: the best this processor can run, or those of the set that was asked for.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <span>
#include <string>

#include "standoff/error.h"
#include "standoff/execution.h"

namespace standoff {

// What the processor has, asked in one place: kernels are compiled for sets of instructions (cmake/simd.cmake), and a
// processor that lacks one of a set's would crash in its kernels.

/// Whether this processor has all that the kernels of a set are compiled with. Every one has `portable`.
inline bool processor_has(Simd set) {
#ifdef __x86_64__
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (set == Simd::avx2) return avx2;
  if (set == Simd::avx512)
    return avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
#endif
  return set == Simd::portable;
}

/// The kernels of a feature, `Kernels` being its table of functions: one such table per instruction set. Which of them
/// this processor can run is asked once, when the object is made.
template <class Kernels>
class Dispatch {
 public:
  /// Kernels compiled for a set.
  struct Compiled {
    Simd set;
    const Kernels* kernels;
  };

  /// All that were compiled, at most one per set and the best first; the last must be portable ones.
  explicit Dispatch(std::initializer_list<Compiled> compiled) {
    for (const Compiled& row : compiled) {
      if (!processor_has(row.set)) continue;
      runnable_[count_] = row.kernels;
      sets_[count_++] = row.set;
    }
  }

  const Kernels& best() const { return *runnable_[0]; }

  /// The kernels of a set; the best for Simd::automatic. Throws Error{usage} that begins with `where` when this
  /// processor cannot run them.
  const Kernels& of(Simd set, const char* where) const {
    if (set == Simd::automatic) return best();
    for (int n = 0; n < count_; ++n)
      if (sets_[n] == set) return *runnable_[n];
    throw Error(ErrorCode::usage,
                std::string(where) + ": this processor lacks the instruction set asked for; use automatic");
  }

  /// All that this processor can run, best first: tests compare them.
  std::span<const Kernels* const> all() const { return {runnable_, static_cast<std::size_t>(count_)}; }

 private:
  static constexpr int kSets = 3;
  const Kernels* runnable_[kSets] = {};
  Simd sets_[kSets] = {};
  int count_ = 0;
};

}  // namespace standoff
