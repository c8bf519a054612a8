// SPDX-License-Identifier: Apache-2.0
// What stands for queries at points on CUDA where standoff is built without a CUDA compiler: it says so.
#include "gpu/devices.h"
#include "points/cuda/points.h"
#include "standoff/error.h"

namespace standoff::cuda {

void find_nearest(const NearestJob&) { throw Error(ErrorCode::device, why_not_available()); }

}  // namespace standoff::cuda
