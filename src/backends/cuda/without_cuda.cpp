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
std::int64_t scratch_bytes(Method, const MeshLoad&, const Grid& grid, double) { return host_scratch_bytes(grid); }

std::vector<OrError<Box>> bounds_on_stream(std::span<const MeshView>, const OnStream&) { fail(); }
std::vector<OrError<FieldOutcome>> compute_on_stream(std::span<const FieldRequest>, const OnStream&) { fail(); }
void copy_from_stream(const float*, std::span<float>, const OnStream&) { fail(); }

std::int64_t workspace_bytes(std::int64_t, const Grid&, double, Method, std::int64_t) { fail(); }
std::int64_t workspace_bytes(const Task&, std::int64_t) { fail(); }
void enqueue(const Task&, void*, std::int64_t, Stream) { fail(); }
void enqueue(std::span<const Task>, void*, std::int64_t, Stream) { fail(); }
std::int64_t workspace_bytes(const BatchTask&, std::int64_t) { fail(); }
void enqueue(const BatchTask&, void*, std::int64_t, Stream) { fail(); }

const thesis::Algorithm2Functions kAlgorithm2{
    [](DistanceField, int) -> std::shared_ptr<const thesis::HeldField> { fail(); },
    [](const Mesh&, const thesis::MinimumRule&, const Execution&) -> std::unique_ptr<thesis::MovingField> { fail(); },
    [](const thesis::Algorithm2Job&, double) -> std::int64_t { fail(); },
    [](const thesis::Algorithm2Job&) -> double { fail(); }};

}  // namespace standoff::cuda
