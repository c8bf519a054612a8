// SPDX-License-Identifier: Apache-2.0
// Replaces collision.cu in a build without a CUDA compiler: queries on CUDA throw an error that says so.
#include "collision/device.h"
#include "gpu/devices.h"
#include "standoff/error.h"

namespace standoff::cuda {

void collide(const collision::CollideJob&) { throw Error(ErrorCode::device, why_not_available()); }
void sweep(const collision::SweepJob&) { throw Error(ErrorCode::device, why_not_available()); }
void distance(const collision::DistanceJob&) { throw Error(ErrorCode::device, why_not_available()); }

}  // namespace standoff::cuda
