// SPDX-License-Identifier: Apache-2.0
// Distance fields of meshes in device memory, computed into device memory, asynchronously on the caller's CUDA stream
// (docs/cuda.md).
//
// enqueue() does not allocate, does not wait for the GPU and does not read from it, so that calls can be captured into
// a CUDA graph. For host memory use compute() with Execution::backend = Backend::cuda.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "standoff/compute.h"
#include "standoff/export.h"
#include "standoff/field.h"
#include "standoff/grid.h"
#include "standoff/sign.h"

struct CUstream_st;

namespace standoff::cuda {

/// A cudaStream_t.
using Stream = CUstream_st*;

/// A mesh in device memory: three doubles per vertex, in world units, and three indices per triangle.
struct DeviceMesh {
  const double* vertices = nullptr;
  std::int64_t vertex_count = 0;
  const std::uint32_t* triangles = nullptr;
  std::int64_t triangle_count = 0;  ///< 1 to 2^32 - 2
  /// The indices of the `kept_count` triangles to use, ascending; null: all triangles.
  const std::uint32_t* kept = nullptr;
  std::int64_t kept_count = 0;

  constexpr std::int64_t used_count() const { return kept ? kept_count : triangle_count; }
};

/// Where the field is written, in device memory. Dense: `slots` is null, and `values` has one value per sample, x
/// fastest. Sparse: `slots` has one entry per tile of 8x8x8 samples (x fastest), as in DistanceField::slots(): the
/// tile's slot, or DistanceField::kOutside (-1) if every sample is +thickness, or DistanceField::kInside (-2) if every
/// sample is -thickness (only in signed fields). The values of a tile are at values + 512 * slot, x fastest. Slots
/// ascend in the order of the tiles; some may be unused.
struct DeviceOutput {
  float* values = nullptr;
  std::uint32_t* nearest = nullptr;  ///< as long as values; null if nearest triangles are not wanted
  std::int32_t* slots = nullptr;
  std::int64_t slot_capacity = 0;  ///< sparse: how many tiles `values` can hold
};

/// Arrays beside the values, in device memory, with what SidecarKind says (standoff/sidecars.h) and the bits of
/// sidecars(); null: not wanted. The sample of values[n] has three numbers from 3 * n on, and its feature at n. Samples
/// without a nearest triangle have 0. Nothing is written where no values are: in tiles that are not stored, and by
/// tasks that fail.
struct DeviceSidecars {
  float* closest_point = nullptr;
  float* barycentric = nullptr;
  std::uint8_t* feature = nullptr;
  float* gradient = nullptr;

  constexpr bool any() const { return closest_point || barycentric || feature || gradient; }
};

/// The result of a task. The GPU writes it to device memory; copy it to the host and call check().
struct Outcome {
  static constexpr unsigned long long kNone = ~0ull, kNoSeeds = ~1ull, kNoPlace = ~2ull, kNoOrder = ~3ull;
  /// Bits of `doubts`.
  static constexpr unsigned long long kOpen = 1, kNotOutwards = 2, kTooDeep = 4;
  unsigned long long stopped;       ///< not 0: the task failed, and the output was not written
  unsigned long long bad_triangle;  ///< the first triangle with an index out of range or a corner not finite, or kNone
  unsigned long long needed_entries;    ///< triangle list entries needed; a lower bound if too few were given. kNone if
                                        ///< the mesh changed during the work; kNoSeeds if the method begins at samples
                                        ///< near the surface, and there are none. Of many meshes (cuda_batch.h):
                                        ///< kNoPlace if the mesh's place is not valid, kNoOrder if first_vertex or
                                        ///< first_triangle do not ascend
  unsigned long long needed_slots;      ///< tiles that may have to be stored (sparse output)
  unsigned long long samples_examined;  ///< as in ComputeReport
  unsigned long long samples_band;
  unsigned long long doubts;  ///< 0, or why the values did not get the sign asked for. kOpen: edges do not cancel.
                              ///< kNotOutwards: a part of the mesh is not closed by itself, or faces inwards, or there
                              ///< are more than 65536 parts. kTooDeep: 127 or more layers of the surface between two
                              ///< samples, which are sometimes counted. The magnitudes are right then, the signs are
                              ///< undefined
};

/// One field to compute.
struct Task {
  DeviceMesh mesh;
  Grid grid;
  double thickness = 0;  ///< world units, may be infinite
  Method method = Method::tiles;
  DeviceOutput output;
  Outcome* outcome = nullptr;
  /// Samples inside are negative, as in the field of compute(), if the mesh is closed and all its parts face outwards.
  /// The device finds out whether they do; if not, the outcome has doubts. `method` is none, or winding or automatic,
  /// which are the same here; `rule`, `invert` and `as_oriented` are obeyed; `strict` changes nothing.
  /// All triangles count for it, whatever is `kept`; one that is not valid is found after the values were written.
  SignOptions sign = SignOptions{SignMethod::none};
  /// Requires output.nearest. Gradients are those of the values with their signs; where the outcome has doubts about
  /// these, gradients are undefined too.
  DeviceSidecars sidecars = {};
};

/// An estimate of the number of list entries, which is enough for most meshes of this size. Outcome::needed_entries
/// gives the true number. If the estimate is too small, the task fails; the field is never wrong. Errors: usage (grid,
/// thickness).
STANDOFF_API std::int64_t likely_entries(std::int64_t triangles, const Grid& grid, double thickness,
                                         Method method = Method::tiles);

/// Bytes of device memory that enqueue needs as workspace for a mesh of at most `triangles` used triangles and
/// `entries` list entries, for a field without a sign.
STANDOFF_API std::int64_t workspace_bytes(std::int64_t triangles, const Grid& grid, double thickness, Method method,
                                          std::int64_t entries);

/// The same for a task, whose mesh and sign count; the sizes of its arrays are read, not the arrays.
STANDOFF_API std::int64_t workspace_bytes(const Task& task, std::int64_t entries);

/// Puts the computation on the stream and returns. `workspace` (device memory, 256-byte aligned) is in use until the
/// work is done. Its previous content does not matter, and its content afterwards is undefined. Mesh and output must
/// not be changed until the work is done. The field has the same bits as that of compute(). Errors: usage (a grid that
/// is not valid, or a window that does not begin at multiples of 16 samples; thickness; null pointers; a workspace that
/// is too small, the message gives the size needed; sidecars without nearest triangles; a sign that is decided on the
/// CPU alone; a sign of sparse output by another method than tiles and thesis, or with a thickness below the largest
/// spacing), device.
STANDOFF_API void enqueue(const Task& task, void* workspace, std::int64_t bytes, Stream stream);

/// Several fields, one after the other on the stream, in one workspace that is large enough for each of them. If a task
/// is invalid, none is put on the stream. Errors: as above.
STANDOFF_API void enqueue(std::span<const Task> tasks, void* workspace, std::int64_t bytes, Stream stream);

/// Throws if the task failed. `outcome` is a copy in host memory. Error{input}: a bad triangle, or the mesh changed
/// during the work; or the outcome has doubts about the sign. Error{limit}: too few list entries or slots.
STANDOFF_API void check(const Outcome& outcome, const Task& task);

/// A GPU.
struct DeviceInfo {
  std::string name;
  int major = 0, minor = 0;  ///< compute capability
  std::int64_t memory_bytes = 0;
};

/// The GPUs, in CUDA's order. The name of a GPU that is too old for this build says so. Empty if there is no driver, no
/// GPU that standoff can use, or no CUDA in this build.
STANDOFF_API std::vector<DeviceInfo> devices();
/// A sentence that says why devices() is empty; empty if it is not.
STANDOFF_API std::string why_no_device();

}  // namespace standoff::cuda
