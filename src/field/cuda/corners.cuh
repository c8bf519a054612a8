// SPDX-License-Identifier: Apache-2.0
// A triangle's corners out of device memory, checked, and moved to where they become float.
#pragma once

#include <string>

#include "field/lattice.h"
#include "geometry/triangle_box.h"
#include "geometry/triangle_frame.h"
#include "gpu/platform.cuh"
#include "gpu/scan.h"
#include "standoff/cuda.h"
#include "standoff/error.h"
#include "standoff/field.h"

namespace standoff::STANDOFF_PLATFORM {

#ifndef __CUDACC__  // the emulation takes the tasks of standoff/cuda.h, over plain memory
using cuda::DeviceMesh;
using cuda::DeviceOutput;
using cuda::Outcome;
using cuda::Task;
#endif

/// Lets no later kernel write anything.
STANDOFF_DEVICE void stop(Outcome* outcome) { atomicAdd(&outcome->stopped, Counter{1}); }

/// The second pass over the triangles wants more of a list, or less, than the first one counted for it. What is
/// computed is the same, so the mesh is not: it was written meanwhile.
STANDOFF_DEVICE void stop_for_miscount(Outcome* outcome) {
  outcome->needed_entries = Outcome::kNone;
  stop(outcome);
}

/// World units.
struct Corners {
  Triple<double> at[3];
};

STANDOFF_DEVICE bool is_finite(double a) { return a - a == 0; }

/// The n-th triangle to use.
STANDOFF_DEVICE std::uint32_t used_triangle(const DeviceMesh& mesh, std::int64_t n) {
  return mesh.kept ? mesh.kept[n] : static_cast<std::uint32_t>(n);
}

/// Requires a triangle that is_valid.
STANDOFF_DEVICE Corners corners_of(const DeviceMesh& mesh, std::uint32_t triangle) {
  Corners c;
  for (int which = 0; which < 3; ++which) {
    const double* v = mesh.vertices + 3 * std::int64_t{mesh.triangles[3 * std::int64_t{triangle} + which]};
    c.at[which] = {v[0], v[1], v[2]};
  }
  return c;
}

/// Whether the triangle exists, its indices are in range and its corners finite. Where not, the outcome remembers it.
STANDOFF_DEVICE bool is_valid(const DeviceMesh& mesh, std::uint32_t triangle, Outcome* outcome) {
  bool valid = triangle < mesh.triangle_count;
  for (int which = 0; which < 3 && valid; ++which) {
    const std::int64_t vertex = mesh.triangles[3 * std::int64_t{triangle} + which];
    valid = vertex < mesh.vertex_count;
    if (!valid) break;
    const double* v = mesh.vertices + 3 * vertex;
    valid = is_finite(v[0]) && is_finite(v[1]) && is_finite(v[2]);
  }
  if (!valid) {
    atomicMin(&outcome->bad_triangle, static_cast<Counter>(triangle));
    stop(outcome);
  }
  return valid;
}

/// Throws Error{usage} where there is no triangle, or one whose index is kNoTriangle.
inline void check_count(const DeviceMesh& mesh) {
  if (mesh.used_count() < 1 || mesh.triangle_count >= kNoTriangle)
    throw Error(ErrorCode::usage, "cuda: the mesh has " + std::to_string(mesh.used_count()) +
                                      " triangles to use; give it 1 to 4294967294");
}

/// The farthest coordinate of a box from the origin.
STANDOFF_DEVICE float farthest_coordinate(const BoxOf<float>& b) {
  return max(max(max(abs(b.low.x), abs(b.high.x)), max(abs(b.low.y), abs(b.high.y))), max(abs(b.low.z), abs(b.high.z)));
}

}  // namespace standoff::STANDOFF_PLATFORM
