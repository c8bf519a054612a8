// SPDX-License-Identifier: Apache-2.0
// Chooses the kernels of a feature at run time: the best set that this processor can run, or the set that the user asks
// for.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <span>
#include <string>

#include "standoff/error.h"
#include "standoff/execution.h"

namespace standoff {

/// Whether this processor has all instructions that the kernels of a set are compiled with (cmake/simd.cmake): if it
/// lacked one, they would crash.
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

/// The kernels of a feature that this processor can run. `Kernels` is the feature's table of functions; its static
/// members avx512, avx2 and portable are the tables compiled for each set.
template <class Kernels>
class Dispatch {
 public:
  struct Compiled {
    Simd set;
    const Kernels* kernels;
  };

  Dispatch()
      : Dispatch({
#ifdef __x86_64__
            {Simd::avx512, &Kernels::avx512},
            {Simd::avx2, &Kernels::avx2},
#endif
            {Simd::portable, &Kernels::portable},
        }) {
  }
  /// The best set first, and portable kernels last.
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

  /// The tables of all sets that this processor can run, the best first: tests compare them.
  std::span<const Kernels* const> all() const { return {runnable_, static_cast<std::size_t>(count_)}; }

 private:
  static constexpr int kSets = 3;
  const Kernels* runnable_[kSets] = {};
  Simd sets_[kSets] = {};
  int count_ = 0;
};

/// Of this processor.
template <class Kernels>
const Dispatch<Kernels>& dispatch_of() {
  static const Dispatch<Kernels> dispatch;
  return dispatch;
}

}  // namespace standoff
