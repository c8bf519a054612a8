// SPDX-License-Identifier: Apache-2.0
// The words of CUDA C++ that the kernels use, for a plain C++ compiler (block.h). Only kernels include this, because
// the names are CUDA's own and in no namespace.
#pragma once

#include <atomic>
#include <bit>
#include <cstdint>
#include <cstring>

#include "gpu/emulation/block.h"

#define __global__
#define __device__
#define __host__
#define __forceinline__ inline
#define __launch_bounds__(...)
// Blocks run one after another, so one copy serves all. It is static memory, which the address sanitizer guards.
#define __shared__ static

#define threadIdx (::standoff::emulation::thread_index())
#define blockIdx (::standoff::emulation::block_index())
#define blockDim (::standoff::emulation::block_extent())
#define gridDim (::standoff::emulation::grid_extent())

// The last parameters of functions that threads wait in: the call site. (clang 14 has no std::source_location.)
#define STANDOFF_CALLED_FROM const char *file = __builtin_FILE(), int line = __builtin_LINE()

using dim3 = ::standoff::emulation::Extent3;

inline void __syncthreads(STANDOFF_CALLED_FROM) { ::standoff::emulation::block_barrier({file, line}); }
inline void __syncwarp(std::uint32_t mask = 0xffffffffu, STANDOFF_CALLED_FROM) {
  ::standoff::emulation::warp_barrier(mask, {file, line});
}

template <class T>
T __shfl_sync(std::uint32_t mask, T value, int source, STANDOFF_CALLED_FROM) {
  static_assert(sizeof(T) <= sizeof(std::uint64_t));
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof value);
  ::standoff::emulation::exchange_slot(::standoff::emulation::lane()) = bits;
  ::standoff::emulation::warp_barrier(mask, {file, line});
  bits = ::standoff::emulation::exchange_slot(static_cast<unsigned>(source) & 31u);
  ::standoff::emulation::warp_barrier(mask, {file, line});
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

template <class T>
T __shfl_xor_sync(std::uint32_t mask, T value, int bits, STANDOFF_CALLED_FROM) {
  return __shfl_sync(mask, value, static_cast<int>(::standoff::emulation::lane()) ^ bits, file, line);
}

inline std::uint32_t __ballot_sync(std::uint32_t mask, int vote, STANDOFF_CALLED_FROM) {
  ::standoff::emulation::exchange_slot(::standoff::emulation::lane()) = vote != 0;
  ::standoff::emulation::warp_barrier(mask, {file, line});
  std::uint32_t votes = 0;
  const std::uint32_t lanes = mask & ::standoff::emulation::existing_lanes();
  for (unsigned n = 0; n < 32; ++n)
    if (lanes >> n & 1) votes |= static_cast<std::uint32_t>(::standoff::emulation::exchange_slot(n)) << n;
  ::standoff::emulation::warp_barrier(mask, {file, line});
  return votes;
}

/// The lanes whose value equals this lane's.
template <class T>
std::uint32_t __match_any_sync(std::uint32_t mask, T value, STANDOFF_CALLED_FROM) {
  static_assert(sizeof(T) <= sizeof(std::uint64_t));
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof value);
  ::standoff::emulation::exchange_slot(::standoff::emulation::lane()) = bits;
  ::standoff::emulation::warp_barrier(mask, {file, line});
  std::uint32_t same = 0;
  const std::uint32_t lanes = mask & ::standoff::emulation::existing_lanes();
  for (unsigned n = 0; n < 32; ++n)
    if ((lanes >> n & 1) && ::standoff::emulation::exchange_slot(n) == bits) same |= 1u << n;
  ::standoff::emulation::warp_barrier(mask, {file, line});
  return same;
}

inline int __popc(std::uint32_t bits) { return std::popcount(bits); }
inline int __ffs(int bits) { return __builtin_ffs(bits); }
inline int __ffsll(long long bits) { return __builtin_ffsll(bits); }
inline std::uint32_t __float_as_uint(float value) { return std::bit_cast<std::uint32_t>(value); }
inline float __uint_as_float(std::uint32_t bits) { return std::bit_cast<float>(bits); }
inline long long __double_as_longlong(double value) { return std::bit_cast<long long>(value); }

template <class T>
T atomicAdd(T* at, T value) {
  return std::atomic_ref<T>(*at).fetch_add(value, std::memory_order_relaxed);
}
template <class T>
T atomicSub(T* at, T value) {
  return std::atomic_ref<T>(*at).fetch_sub(value, std::memory_order_relaxed);
}
template <class T>
T atomicOr(T* at, T value) {
  return std::atomic_ref<T>(*at).fetch_or(value, std::memory_order_relaxed);
}
template <class T>
T atomicCAS(T* at, T expected, T value) {
  std::atomic_ref<T>(*at).compare_exchange_strong(expected, value, std::memory_order_relaxed);
  return expected;
}
template <class T>
T atomicMin(T* at, T value) {
  std::atomic_ref<T> ref(*at);
  T before = ref.load(std::memory_order_relaxed);
  while (value < before && !ref.compare_exchange_weak(before, value, std::memory_order_relaxed)) {
  }
  return before;
}
