// SPDX-License-Identifier: Apache-2.0
// The table of the kernels of queries at points for this file's instruction set.
#pragma once

#include "bvh/overlapping.inl"
#include "points/cpu/kernels/closest.inl"
#include "points/cpu/kernels/look_at.inl"
#include "points/cpu/kernels/look_at_all.inl"
#include "points/cpu/kernels/solid_angles.inl"

namespace standoff::cpu::STANDOFF_TARGET {

constexpr PointKernels kTable{.make_frames = make_frames,
                              .look_at = look_at,
                              .look_at_all = look_at_all,
                              .closest = closest,
                              .add_solid_angles = add_solid_angles,
                              .overlapping = standoff::STANDOFF_TARGET::overlapping_lanes};

}  // namespace standoff::cpu::STANDOFF_TARGET

const standoff::cpu::PointKernels standoff::cpu::PointKernels::STANDOFF_TARGET = standoff::cpu::STANDOFF_TARGET::kTable;
