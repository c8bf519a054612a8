// SPDX-License-Identifier: Apache-2.0
// Replaces points.cu in a build without a CUDA compiler: queries on CUDA throw an error that says so.
#include "gpu/devices.h"
#include "points/cuda/points.h"
#include "standoff/error.h"

namespace standoff::cuda {

void find_nearest(const NearestJob&) { throw Error(ErrorCode::device, why_not_available()); }

}  // namespace standoff::cuda
