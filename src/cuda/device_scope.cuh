// The device that CUDA's calls are about.
#pragma once

#include "cuda/backend.h"
#include "cuda/platform_cuda.cuh"

namespace difi::cuda {

/// Makes a device the current one for as long as it lives.
class DeviceScope {
 public:
  explicit DeviceScope(int device) {
    const auto known = devices();
    if (known.empty()) throw Error(ErrorCode::device, why_not_available());
    if (device < 0 || device >= static_cast<int>(known.size()))
      throw Error(ErrorCode::device, "cuda: there is no GPU " + std::to_string(device) + ", only 0 to " +
                                         std::to_string(known.size() - 1) + "; see `difi devices`");
    check_call(cudaGetDevice(&before_), "cudaGetDevice");
    check_call(cudaSetDevice(device), "cudaSetDevice");
  }
  ~DeviceScope() { cudaSetDevice(before_); }
  DeviceScope(const DeviceScope&) = delete;
  DeviceScope& operator=(const DeviceScope&) = delete;

 private:
  int before_ = 0;
};

}  // namespace difi::cuda
