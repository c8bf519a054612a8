// SPDX-License-Identifier: Apache-2.0
// Distance fields of meshes in device memory, in any layout, computed into device memory on the caller's CUDA stream.
//
// These functions allocate what they need beside the meshes and the fields, wait for the stream, and try again where
// triangle lists did not fit. enqueue() of standoff/cuda.h does none of this.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <variant>
#include <vector>

#include "standoff/compute.h"
#include "standoff/cuda.h"
#include "standoff/error.h"
#include "standoff/execution.h"
#include "standoff/export.h"
#include "standoff/grid.h"
#include "standoff/mesh_view.h"

namespace standoff::cuda {

using AllocateCallback = std::function<void*(std::int64_t bytes)>;
using ReleaseCallback = std::function<void(void* memory)>;

/// Where a call takes the device memory that it needs beside the arrays: from a caller's pool, so that none lies beside
/// it. Both functions or none; none: cudaMalloc and cudaFree.
struct Allocator {
  /// Returns memory on the call's device, aligned to 256 bytes; null if there is none.
  AllocateCallback allocate = {};
  /// Takes it back; no work on it is left. Must not throw.
  ReleaseCallback release = {};
};

/// Whose memory the arrays of a call lie in, and which stream works on them.
struct OnStream {
  Backend backend = Backend::cuda;  ///< or testing::kEmulated, for which plain memory stands for the device's
  int device = 0;
  Stream stream = nullptr;             ///< null: the legacy default stream
  std::span<const Stream> after = {};  ///< other streams that write these arrays; they are waited for first
  Allocator memory = {};               ///< is asked on the thread of the call
};

/// The answer for one of several meshes, or the error that the same call with this mesh alone would give.
template <class Answer>
using OrError = std::variant<Answer, Error>;

/// The answer; throws the error that is in its place.
template <class Answer>
Answer value_or_throw(const OrError<Answer>& answer) {
  if (const Error* const error = std::get_if<Error>(&answer)) throw *error;
  return std::get<Answer>(answer);
}

/// The boxes around all triangles of meshes whose arrays lie in device memory, in their order. The pointers of the
/// views are device pointers; numbers must be aligned. It allocates once and waits once. Errors among the answers:
/// usage (alignment, no triangle), input (the first triangle with an index out of range or a corner that is not
/// finite), limit (device memory). Errors thrown: usage (a backend that is not a GPU's), device.
STANDOFF_API std::vector<OrError<Box>> bounds_of_each(std::span<const MeshView> meshes, const OnStream& on = {});

/// A field to compute of a mesh in device memory, into values there.
struct FieldRequest {
  MeshView mesh;
  Grid grid;
  double thickness = 0;     ///< world units, may be infinite
  float* values = nullptr;  ///< in device memory, one float per sample, x fastest
  Method method = Method::tiles;
  SignOptions sign = SignOptions{SignMethod::none};
  std::uint32_t* nearest = nullptr;  ///< in device memory, as long as values; null: not wanted
  DeviceSidecars sidecars = {};      ///< require `nearest`
};

/// compute_into() for meshes in device memory and values there; the reports are in their order. The values have the
/// same bits. The device decides the sign of a mesh that is closed and whose parts all face outwards; any other mesh is
/// copied to the host, which decides the sign as occupancy() does, and sends a bit for each sample. Method::thesis
/// leaves out no triangle, as its skip rule works on the CPU. It returns when they are written. Packed doubles and
/// packed indices of 32 bits are used where they lie, other layouts are copied on the device. The fields are computed
/// by one enqueue() of all. It waits twice, and again for those whose triangle lists did not fit, which are computed
/// anew, and for each whose sign the host decides. Copies of meshes lie in one piece of memory; the fields share one
/// workspace, as large as the largest of them needs. If that does not fit into device memory, halves of them are
/// computed one after the other. Errors among the answers: as bounds_of_each; usage also for the grid (a window must
/// begin at multiples of 16 samples), the thickness, values that are null, sidecars without nearest triangles, and
/// signs that need more than a bit for each sample: normal, facet, shell and `outer`; limit also for a mesh too far
/// from the grid (docs/tiles.md, Domain), input and doubt for its sign, after distances, nearest triangles and sidecars
/// may have been written; the other fields are computed. Errors thrown: as bounds_of_each; after one, anything may have
/// been written.
STANDOFF_API std::vector<OrError<ComputeReport>> compute_each(std::span<const FieldRequest> requests,
                                                              const OnStream& on = {});

/// Copies values out of device memory, once the stream's work so far is done. Errors: usage (a null pointer, a backend
/// that is not a GPU's), device.
STANDOFF_API void copy_to_host(const float* values, std::span<float> to, const OnStream& on = {});

}  // namespace standoff::cuda
