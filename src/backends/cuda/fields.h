// SPDX-License-Identifier: Apache-2.0
// Fields on a GPU, by CUDA and by its emulation on the CPU: the functions of the table of backends, and for tests.
#pragma once

#include <new>

#include "field/backend.h"
#include "standoff/cuda.h"
#include "standoff/cuda_batch.h"
#include "standoff/cuda_compute.h"

namespace standoff::cuda {

// The functions of the table of backends (src/backends/fields.cpp).

/// Requires a method that has a pipeline (pipelines.cuh).
Counts run(Method method, const Job& job, Sink& sink);
/// Bytes of host memory beside the output; the GPU's own memory is not counted.
std::int64_t scratch_bytes(Method method, const MeshLoad& mesh, const Grid& grid, double thickness);

}  // namespace standoff::cuda

namespace standoff::emulated {

Counts run(Method method, const Job& job, Sink& sink);
/// The same, plus the memory that emulates the GPU's.
std::int64_t scratch_bytes(Method method, const MeshLoad& mesh, const Grid& grid, double thickness);

}  // namespace standoff::emulated

namespace standoff::cuda {

// The functions behind standoff/cuda_compute.h (src/backends/streams.cpp), by CUDA and by its emulation. Errors of
// single meshes are among the answers. Errors of the device are thrown, and so is gpu::OutOfMemory if the meshes do not
// all fit at once.

/// Runs `work` for a mesh. An error in its input becomes its answer, and so does a lack of host memory; an error of the
/// device ends the call.
template <class Answer, class Work>
void answer_with(OrError<Answer>& answer, const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    if (error.code() == ErrorCode::device) throw;
    answer = error;
  } catch (const std::bad_alloc&) {
    answer = Error(ErrorCode::limit, "cuda: the host has no memory for this mesh; provide more, or take a smaller one");
  }
}

/// What became of a field.
struct FieldOutcome {
  Outcome outcome;
  SignReport sign;
};

std::vector<OrError<Box>> bounds_on_stream(std::span<const MeshView> meshes, const OnStream& on);
std::vector<OrError<FieldOutcome>> compute_on_stream(std::span<const FieldRequest> requests, const OnStream& on);
void copy_from_stream(const float* values, std::span<float> to, const OnStream& on);

}  // namespace standoff::cuda

namespace standoff::emulated {

std::vector<cuda::OrError<Box>> bounds_on_stream(std::span<const MeshView> meshes, const cuda::OnStream& on);
std::vector<cuda::OrError<cuda::FieldOutcome>> compute_on_stream(std::span<const cuda::FieldRequest> requests,
                                                                 const cuda::OnStream& on);
void copy_from_stream(const float* values, std::span<float> to, const cuda::OnStream& on);

// The functions of standoff/cuda.h and standoff/cuda_batch.h in plain memory, by the emulation: for tests.

std::int64_t workspace_bytes(std::int64_t triangles, const Grid& grid, double thickness, Method method,
                             std::int64_t entries);
std::int64_t workspace_bytes(const cuda::Task& task, std::int64_t entries);
void enqueue(const cuda::Task& task, void* workspace, std::int64_t bytes, cuda::Stream stream = nullptr);
void enqueue(std::span<const cuda::Task> tasks, void* workspace, std::int64_t bytes, cuda::Stream stream = nullptr);
std::int64_t workspace_bytes(const cuda::BatchTask& task, std::int64_t entries);
void enqueue(const cuda::BatchTask& task, void* workspace, std::int64_t bytes, cuda::Stream stream = nullptr);

}  // namespace standoff::emulated
