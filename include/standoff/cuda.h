// SPDX-License-Identifier: Apache-2.0
// Distance fields from and to device memory, asynchronously on the caller's CUDA stream (docs/cuda.md).
//
// enqueue() neither allocates nor waits for the GPU nor reads from it, so that calls can be captured into a CUDA graph.
// For host memory use compute() with Execution::backend = Backend::cuda, which is built on this.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "standoff/compute.h"
#include "standoff/export.h"
#include "standoff/field.h"
#include "standoff/grid.h"

struct CUstream_st;

namespace standoff::cuda {

/// A cudaStream_t.
using Stream = CUstream_st*;

/// A mesh in device memory: three doubles a vertex in world units, three indices a triangle.
struct DeviceMesh {
  const double* vertices = nullptr;
  std::int64_t vertex_count = 0;
  const std::uint32_t* triangles = nullptr;
  std::int64_t triangle_count = 0;  ///< 1 to 2^32 - 2
  /// The triangles to use, ascending; null: all of them. `kept_count` of them.
  const std::uint32_t* kept = nullptr;
  std::int64_t kept_count = 0;

  constexpr std::int64_t used_count() const { return kept ? kept_count : triangle_count; }
};

/// Where the field goes, in device memory. Dense: `slots` is null, and `values` holds one value a sample, x fastest.
/// Sparse: `slots` holds one entry a tile of 8x8x8 samples (x fastest), as DistanceField::slots() does: the tile's
/// slot; DistanceField::kOutside, -1, where every sample is +thickness; DistanceField::kInside, -2, where every sample
/// is -thickness (signed fields alone). Tile values stand at values + 512 * slot, x fastest. Slots ascend with the
/// tiles; some may stay unused.
struct DeviceOutput {
  float* values = nullptr;
  std::uint32_t* nearest = nullptr;  ///< as long as values, or null where nearest triangles are not wanted
  std::int32_t* slots = nullptr;
  std::int64_t slot_capacity = 0;  ///< sparse: how many tiles `values` can hold
};

/// The result of enqueue's work, which writes it to device memory. Copy it to the host and call check().
struct Outcome {
  static constexpr unsigned long long kNone = ~0ull;
  unsigned long long stopped;       ///< not 0: the task failed, and the output was not written
  unsigned long long bad_triangle;  ///< the first triangle with an index out of range or a corner not finite, or kNone
  unsigned long long needed_entries;    ///< triangle list entries needed; a lower bound if too few were given. kNone if
                                        ///< the mesh changed during the work
  unsigned long long needed_slots;      ///< tiles that may have to be stored (sparse output)
  unsigned long long samples_examined;  ///< as in ComputeReport
  unsigned long long samples_band;
};

/// One field to compute.
struct Task {
  DeviceMesh mesh;
  Grid grid;
  double thickness = 0;  ///< world units, may be infinite
  Method method = Method::tiles;
  DeviceOutput output;
  Outcome* outcome = nullptr;
};

/// An estimate of the list entries that suffices for most meshes of this size. Outcome::needed_entries gives the true
/// number. Too small an estimate never gives a wrong field. Errors: usage (grid, thickness).
STANDOFF_API std::int64_t likely_entries(std::int64_t triangles, const Grid& grid, double thickness,
                                         Method method = Method::tiles);

/// Bytes of device memory that enqueue needs for a mesh of at most `triangles` used triangles and `entries` list
/// entries.
STANDOFF_API std::int64_t workspace_bytes(std::int64_t triangles, const Grid& grid, double thickness, Method method,
                                          std::int64_t entries);

/// Puts the computation on the stream and returns. `workspace` (device memory, 256-byte aligned) is in use until the
/// work is done; its content before does not matter, and after is undefined. Mesh and output must not change until
/// then. The field has the bits that compute() gives. Errors: usage (grid, thickness, null pointers, too small a
/// workspace: it says how large), device.
STANDOFF_API void enqueue(const Task& task, void* workspace, std::int64_t bytes, Stream stream);

/// Several fields, one after the other on the stream, through one workspace that is large enough for each. If a task is
/// invalid, none is put on the stream. Errors: as above.
STANDOFF_API void enqueue(std::span<const Task> tasks, void* workspace, std::int64_t bytes, Stream stream);

/// Throws if the task failed. `outcome` is a copy in host memory. Error{input}: a bad triangle, or the mesh changed
/// during the work. Error{limit}: too few list entries or slots.
STANDOFF_API void check(const Outcome& outcome, const Task& task);

/// A GPU.
struct DeviceInfo {
  std::string name;
  int major = 0, minor = 0;  ///< compute capability
  std::int64_t memory_bytes = 0;
};

/// The GPUs, in CUDA's order; the name of one that is too old for this build says so. Empty without a driver, a GPU
/// that standoff can use, or CUDA in this build.
STANDOFF_API std::vector<DeviceInfo> devices();
/// A sentence that says why devices() is empty; empty if it is not.
STANDOFF_API std::string why_no_device();

}  // namespace standoff::cuda
