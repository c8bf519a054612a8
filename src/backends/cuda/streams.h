// SPDX-License-Identifier: Apache-2.0
// What standoff/cuda_compute.h runs (src/backends/streams.cpp): on CUDA, and emulated on the CPU.
#pragma once

#include "standoff/cuda_compute.h"

namespace standoff::cuda {
Box bounds_on_stream(const MeshView& mesh, const OnStream& on);
/// The task lacks its mesh and its outcome.
Outcome compute_on_stream(const MeshView& mesh, Task task, const OnStream& on);
void copy_from_stream(const float* values, std::span<float> to, const OnStream& on);
}  // namespace standoff::cuda

namespace standoff::emulated {
Box bounds_on_stream(const MeshView& mesh, const cuda::OnStream& on);
cuda::Outcome compute_on_stream(const MeshView& mesh, cuda::Task task, const cuda::OnStream& on);
void copy_from_stream(const float* values, std::span<float> to, const cuda::OnStream& on);
}  // namespace standoff::emulated
