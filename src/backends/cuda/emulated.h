// SPDX-License-Identifier: Apache-2.0
// The functions of standoff/cuda.h over plain memory, emulated on the CPU: for tests.
#pragma once

#include "standoff/cuda.h"

namespace standoff::emulated {

std::int64_t workspace_bytes(std::int64_t triangles, const Grid& grid, double thickness, Method method,
                             std::int64_t entries);
void enqueue(const cuda::Task& task, void* workspace, std::int64_t bytes, cuda::Stream stream = nullptr);
void enqueue(std::span<const cuda::Task> tasks, void* workspace, std::int64_t bytes, cuda::Stream stream = nullptr);

}  // namespace standoff::emulated
