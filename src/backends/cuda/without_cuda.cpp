// SPDX-License-Identifier: Apache-2.0
// Replaces the .cu files beside it in a build without a CUDA compiler: fields on CUDA throw an error that says so.
#include "backends/cuda/fields.h"
#include "core/guarded.h"
#include "field/cuda/capacity.h"
#include "gpu/devices.h"
#include "standoff/cuda.h"
#include "thesis/algorithm_2.h"

namespace standoff::cuda {
namespace {

[[noreturn]] void fail() try { throw Error(ErrorCode::device, why_not_available()); } catch (...) {
  throw_as_error("cuda");
}

}  // namespace

Counts run(Method, const Job&, Sink&) { fail(); }
std::int64_t scratch_bytes(Method, std::int64_t, const Grid& grid, double) { return host_scratch_bytes(grid); }

std::vector<OrError<Box>> bounds_on_stream(std::span<const MeshView>, const OnStream&) { fail(); }
std::vector<OrError<Outcome>> compute_on_stream(std::span<const FieldRequest>, const OnStream&) { fail(); }
void copy_from_stream(const float*, std::span<float>, const OnStream&) { fail(); }

std::int64_t workspace_bytes(std::int64_t, const Grid&, double, Method, std::int64_t) { fail(); }
void enqueue(const Task&, void*, std::int64_t, Stream) { fail(); }
void enqueue(std::span<const Task>, void*, std::int64_t, Stream) { fail(); }

std::shared_ptr<const thesis::HeldField> hold_field(DistanceField, int) { fail(); }
std::unique_ptr<thesis::MovingField> moving_field(const Mesh&, const thesis::MinimumRule&, const Execution&) { fail(); }
std::int64_t first_below(const thesis::Algorithm2Job&, double) { fail(); }
double least_sum(const thesis::Algorithm2Job&) { fail(); }

}  // namespace standoff::cuda
