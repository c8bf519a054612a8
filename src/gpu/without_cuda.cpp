// SPDX-License-Identifier: Apache-2.0
// Replaces devices.cu in a build without a CUDA compiler: there are no GPUs.
#include "core/guarded.h"
#include "gpu/devices.h"
#include "standoff/cuda.h"

namespace standoff::cuda {
namespace {

constexpr const char* kWhyNot = "this build of standoff has no CUDA backend (it was built without nvcc)";

}  // namespace

bool available() { return false; }
std::string why_no_device() try { return kWhyNot; } catch (...) {
  throw_as_error("cuda");
}
std::string why_not_available() {
  return std::string("cuda: ") + kWhyNot + "; use the CPU, or build it where nvcc is (docs/cuda.md)";
}
std::string device_name(int) { return "no device"; }
std::vector<DeviceInfo> devices() { return {}; }
void check_usable(int) { throw Error(ErrorCode::device, why_not_available()); }

}  // namespace standoff::cuda
