// SPDX-License-Identifier: Apache-2.0
// What standoff/cuda_compute.h runs (src/backends/streams.cpp): on CUDA, and emulated on the CPU. Errors of single
// meshes are among the answers; those of the device, and gpu::OutOfMemory where all do not fit at once, are thrown.
#pragma once

#include "standoff/cuda_compute.h"

namespace standoff::cuda {

/// Runs `work`; an error in the input of one mesh becomes its answer, one of the device ends the call.
template <class Answer, class Work>
void answer_with(OrError<Answer>& answer, const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    if (error.code() == ErrorCode::device) throw;
    answer = error;
  }
}

std::vector<OrError<Box>> bounds_on_stream(std::span<const MeshView> meshes, const OnStream& on);
std::vector<OrError<Outcome>> compute_on_stream(std::span<const FieldRequest> requests, const OnStream& on);
void copy_from_stream(const float* values, std::span<float> to, const OnStream& on);

}  // namespace standoff::cuda

namespace standoff::emulated {

std::vector<cuda::OrError<Box>> bounds_on_stream(std::span<const MeshView> meshes, const cuda::OnStream& on);
std::vector<cuda::OrError<cuda::Outcome>> compute_on_stream(std::span<const cuda::FieldRequest> requests,
                                                            const cuda::OnStream& on);
void copy_from_stream(const float* values, std::span<float> to, const cuda::OnStream& on);

}  // namespace standoff::emulated
