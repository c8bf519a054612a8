// SPDX-License-Identifier: Apache-2.0
// Which GPUs there are, and why there is none: of this build (devices.cu, or without_cuda.cpp) and of this machine.
#pragma once

#include <string>

namespace standoff::cuda {

bool available();
/// Why it is not, in a sentence with what to do.
std::string why_not_available();
std::string device_name(int device);
/// Throws Error{device} that says why a GPU cannot be used: it is not there, or older than the kernels.
void check_usable(int device);

}  // namespace standoff::cuda
