// SPDX-License-Identifier: Apache-2.0
// What all fragments of the field's kernels begin with: the wide types of the instruction set, and the tolerances.
//
// Only always-inlined functions of other rooms may be called from kernels, and nothing of the standard library: a
// function compiled for AVX-512 that the linker shares with the rest of the program would crash older processors
// (script/check_weak_symbols).
#pragma once

#include "field/cpu/kernels.h"
#include "field/cpu/lattice.h"
#include "field/tolerances.h"
#include "simd/points.inl"

namespace standoff::cpu::STANDOFF_TARGET {

using namespace standoff::STANDOFF_TARGET;

static_assert(kLanes == WideFloat::kLanes);

namespace {

STANDOFF_INLINE const WideFloat& component(const WidePoint& p, int axis) {
  return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
