// SPDX-License-Identifier: Apache-2.0
// Nearest triangles on CUDA, and on the emulated GPU.
#pragma once

#include "points/device.h"

namespace standoff::cuda {
void find_nearest(const NearestJob& job);
}  // namespace standoff::cuda

namespace standoff::emulated {
void find_nearest(const NearestJob& job);
}  // namespace standoff::emulated
