// SPDX-License-Identifier: Apache-2.0
// Collision queries on GPUs as the table of devices sees them (src/backends/collision.cpp): on CUDA, and emulated on
// the CPU.
#pragma once

#include "collision/device.h"

namespace standoff::cuda {
void collide(const collision::CollideJob& job);
void sweep(const collision::SweepJob& job);
}  // namespace standoff::cuda

namespace standoff::emulated {
void collide(const collision::CollideJob& job);
void sweep(const collision::SweepJob& job);
}  // namespace standoff::emulated
