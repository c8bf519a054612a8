// SPDX-License-Identifier: Apache-2.0
// The table of the queries' kernels for this file's instruction set.
#pragma once

#include "collision/cpu/kernels/boxes.inl"
#include "collision/cpu/kernels/close_triangles.inl"
#include "collision/cpu/kernels/sphere_gaps.inl"
#include "collision/cpu/kernels/triangle_pairs.inl"

namespace standoff::collision::STANDOFF_TARGET {

extern const Kernels kKernels;
const Kernels kKernels{.name = STANDOFF_TARGET_NAME,
                       .gaps = gaps,
                       .gaps_at = gaps_at,
                       .overlaps = overlaps,
                       .distances_sq = distances_sq,
                       .transform_triangles = transform_triangles,
                       .close_pairs = close_pairs,
                       .overlap_pairs = overlap_pairs,
                       .closest = closest};

}  // namespace standoff::collision::STANDOFF_TARGET
