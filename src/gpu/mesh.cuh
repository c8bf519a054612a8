// SPDX-License-Identifier: Apache-2.0
// Meshes in device memory, as kernels read them; and the outcome that says that one of their triangles is not valid.
#pragma once

#include <string>

#include "geometry/triple.h"
#include "gpu/platform.cuh"
#include "gpu/scan.h"
#include "standoff/cuda.h"
#include "standoff/error.h"
#include "standoff/field.h"

namespace standoff::STANDOFF_PLATFORM {

#ifndef __CUDACC__  // the emulation runs the tasks of standoff/cuda.h in plain memory
using cuda::DeviceMesh;
using cuda::DeviceOutput;
using cuda::DeviceSidecars;
using cuda::Outcome;
using cuda::Task;
#endif

/// The outcome of a task that has not begun.
STANDOFF_DEVICE Outcome no_outcome() { return {0, Outcome::kNone, 0, 0, 0, 0, 0}; }

/// Makes all later kernels write nothing.
STANDOFF_DEVICE void stop(Outcome* outcome) { atomicAdd(&outcome->stopped, Counter{1}); }

/// A triangle's corners, world units.
struct Corners {
  Triple<double> at[3];
};

STANDOFF_DEVICE bool is_finite(double a) { return a - a == 0; }

STANDOFF_DEVICE Triple<double> vertex_of(const DeviceMesh& mesh, std::int64_t vertex) {
  const double* v = mesh.vertices + 3 * vertex;
  return {v[0], v[1], v[2]};
}
STANDOFF_DEVICE std::uint32_t vertex_index(const DeviceMesh& mesh, std::uint32_t triangle, int which) {
  return mesh.triangles[3 * std::int64_t{triangle} + which];
}

/// Requires a triangle that is_valid.
STANDOFF_DEVICE Corners corners_of(const DeviceMesh& mesh, std::uint32_t triangle) {
  Corners c;
  for (int which = 0; which < 3; ++which) c.at[which] = vertex_of(mesh, vertex_index(mesh, triangle, which));
  return c;
}

/// Whether the triangle exists, its indices are in range and its corners finite. If not, the outcome records it.
STANDOFF_DEVICE bool is_valid(const DeviceMesh& mesh, std::uint32_t triangle, Outcome* outcome) {
  bool valid = triangle < mesh.triangle_count;
  for (int which = 0; which < 3 && valid; ++which) {
    const std::int64_t vertex = vertex_index(mesh, triangle, which);
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

/// Throws Error{usage} if there is no triangle, or one whose index is kNoTriangle, or fewer than are to be used.
inline void check_count(const DeviceMesh& mesh) {
  if (mesh.used_count() < 1 || mesh.triangle_count >= kNoTriangle || mesh.used_count() > mesh.triangle_count)
    throw Error(ErrorCode::usage, "cuda: the mesh has " + std::to_string(mesh.used_count()) +
                                      " triangles to use; give it 1 to 4294967294");
}

}  // namespace standoff::STANDOFF_PLATFORM
