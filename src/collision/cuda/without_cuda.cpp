// SPDX-License-Identifier: Apache-2.0
// What stands for collision queries on CUDA where standoff is built without a CUDA compiler: it says so.
#include "collision/device.h"
#include "gpu/devices.h"
#include "standoff/error.h"

namespace standoff::cuda {

void collide(const collision::CollideJob&) { throw Error(ErrorCode::device, why_not_available()); }
void sweep(const collision::SweepJob&) { throw Error(ErrorCode::device, why_not_available()); }

}  // namespace standoff::cuda
