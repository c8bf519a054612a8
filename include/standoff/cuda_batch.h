// SPDX-License-Identifier: Apache-2.0
// Distance fields of many small meshes in device memory, all of one size, in one sequence of launches on the caller's
// CUDA stream (docs/cuda.md). A single small field cannot fill a GPU; ten thousand together can.
//
// As in standoff/cuda.h, enqueue() does not allocate, does not wait for the GPU and does not read from it, so that
// calls can be captured into a CUDA graph. No work on the host depends on the number of meshes.
#pragma once

#include <cstdint>

#include "standoff/cuda.h"
#include "standoff/export.h"
#include "standoff/vec.h"

namespace standoff::cuda {

/// The grid and the thickness of one of many fields, in world units.
struct BatchPlace {
  Vec3 origin;               ///< position of sample (0,0,0)
  Vec3 spacing = {1, 1, 1};  ///< per axis, positive
  double thickness = 0;      ///< positive, at most four times the largest spacing: a thin band
};

/// Fields of many meshes, all of one size. All pointers are to device memory. The meshes lie one behind the other:
/// vertices first_vertex[n] to first_vertex[n + 1] - 1 and triangles first_triangle[n] to first_triangle[n + 1] - 1 are
/// mesh n's, and the indices of its triangles count from its own first vertex. A mesh may have no triangle: its field
/// is the thickness everywhere.
struct BatchTask {
  std::int64_t count = 0;                        ///< of meshes, from 0
  const double* vertices = nullptr;              ///< three numbers per vertex, world units
  const std::uint32_t* triangles = nullptr;      ///< three indices per triangle
  const std::int64_t* first_vertex = nullptr;    ///< count + 1 numbers: ascending, from 0 to vertex_count
  const std::int64_t* first_triangle = nullptr;  ///< count + 1 numbers: ascending, from 0 to triangle_count
  std::int64_t vertex_count = 0;                 ///< of all meshes
  std::int64_t triangle_count = 0;               ///< of all meshes: 0 to kMaxTriangles
  const BatchPlace* places = nullptr;            ///< one per mesh
  Size3 size;                                    ///< samples of every field
  float* values = nullptr;                       ///< count * size samples: x fastest, one field behind the other
  std::uint32_t* nearest = nullptr;  ///< as long as values: the nearest triangle's index in its mesh, or kNoTriangle;
                                     ///< null if not wanted
  Outcome* outcomes = nullptr;       ///< one per mesh
  Outcome* total = nullptr;          ///< one: what stopped all fields, and the sums over those that did not stop
};

/// An estimate of the number of list entries of all meshes together, which is enough for most. The `needed_entries` of
/// the task's total gives the true number; if the estimate is too small, no field is written. Needs only the sizes of
/// the task, not its pointers. Errors: usage (sizes), limit.
STANDOFF_API std::int64_t likely_entries(const BatchTask& task);

/// Bytes of device memory that enqueue() needs as workspace for `entries` list entries. Needs only the sizes of the
/// task. Errors: usage (sizes), limit.
STANDOFF_API std::int64_t workspace_bytes(const BatchTask& task, std::int64_t entries);

/// Puts the computation on the stream and returns. `workspace` (device memory, 256-byte aligned) is in use until the
/// work is done, and its content does not matter. The task's arrays must not be changed until then. Every field has the
/// same bits as that of compute(), without a sign. A mesh with a bad triangle, or with a place that is not valid, is
/// told by its own outcome and its field is not written; the others are computed. If there is room for too few list
/// entries, or if the numbers of first_vertex or first_triangle do not ascend, no field is written, and the total and
/// every outcome say so. Errors: usage (sizes, null pointers, a workspace that is too small; the message gives the size
/// needed), limit, device.
STANDOFF_API void enqueue(const BatchTask& task, void* workspace, std::int64_t bytes, Stream stream);

/// Throws if a mesh failed, or if all did. `outcome` is a copy in host memory of a mesh's outcome, or of the total.
/// Error{input}: a bad triangle, or the mesh changed during the work. Error{usage}: a place that is not valid, numbers
/// that do not ascend. Error{limit}: too few list entries; the total says how many all meshes need.
STANDOFF_API void check(const Outcome& outcome, const BatchTask& task);

}  // namespace standoff::cuda
