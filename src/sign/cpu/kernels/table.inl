// SPDX-License-Identifier: Apache-2.0
// The table of the sign's kernels for one instruction set.
#pragma once

#include "sign/cpu/kernels/cross_rows.inl"
#include "sign/cpu/kernels/solid_angles.inl"

namespace standoff::cpu::STANDOFF_TARGET {

extern const SignKernels kSignKernels;
const SignKernels kSignKernels{.cross_rows = cross_rows, .add_solid_angles = add_solid_angles};

}  // namespace standoff::cpu::STANDOFF_TARGET
