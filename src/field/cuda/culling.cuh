// SPDX-License-Identifier: Apache-2.0
// How far a triangle is from a cell at least: what cells and groups of samples drop triangles by.
#pragma once

#include "field/lattice.h"
#include "field/tolerances.h"
#include "geometry/triangle_box.h"
#include "geometry/triple.h"
#include "gpu/platform.cuh"

namespace standoff::STANDOFF_PLATFORM {

/// The largest coordinate of a box, in magnitude.
STANDOFF_DEVICE float farthest_coordinate(const BoxOf<float>& b) {
  return max(max(max(abs(b.low.x), abs(b.high.x)), max(abs(b.low.y), abs(b.high.y))), max(abs(b.low.z), abs(b.high.z)));
}

/// The error of a distance computed from coordinates up to `farthest`.
STANDOFF_DEVICE float distance_slack(float farthest) { return fma(farthest, kSlackOfCoordinate, kSlack); }

/// A box around a triangle, by its middle and half its sides.
struct CenteredBox {
  Triple<float> middle, half;
};
STANDOFF_DEVICE CenteredBox centered(const BoxOf<float>& box) { return {middle_of(box), (box.high - box.low) * 0.5f}; }

/// A point of the mesh near the centre of a cell.
struct NearSurface {
  Triple<float> point;
  float within;  // bounds its distance from the centre; infinite if no point is known
};

/// A cell: its width along each axis, and half its diagonal.
struct CellExtent {
  float width[3], radius;
};

/// The test `bisector` (docs/cuda.md): a triangle in a box whose distance from the centre of a cell is no less than the
/// root of this is nowhere nearer than that point to a sample of the cell. `slack` bounds the error of distances.
STANDOFF_DEVICE float bisector_sq(const CellExtent& cell, const CenteredBox& box, float slack,
                                  const NearSurface& surface) {
  const Triple<float> from = surface.point - box.middle;
  const float within = surface.within * (1 + kBisectorSlack);
  // A sample is up to a radius farther from both than the centre is, so errors are that much larger in squares there.
  float sum = fma(4 * slack, cell.radius, within * within);
  sum = fma(cell.width[0], abs(from.x) + box.half.x, sum);
  sum = fma(cell.width[1], abs(from.y) + box.half.y, sum);
  return fma(cell.width[2], abs(from.z) + box.half.z, sum);
}

}  // namespace standoff::STANDOFF_PLATFORM
