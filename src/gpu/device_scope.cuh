// SPDX-License-Identifier: Apache-2.0
// The device that calls of the platform are about.
#pragma once

#include "gpu/platform.cuh"

#ifdef __CUDACC__

#include "gpu/devices.h"

namespace standoff::cuda {

/// Makes a device the current one for as long as it lives. Only where it must: setting one starts CUDA on it.
class DeviceScope {
 public:
  explicit DeviceScope(int device) {
    check_usable(device);
    check_call(cudaGetDevice(&before_), "cudaGetDevice");
    if (device == before_) return;
    check_call(cudaSetDevice(device), "cudaSetDevice");
    changed_ = true;
  }
  ~DeviceScope() {
    if (changed_) cudaSetDevice(before_);
  }
  DeviceScope(const DeviceScope&) = delete;
  DeviceScope& operator=(const DeviceScope&) = delete;

 private:
  int before_ = 0;
  bool changed_ = false;
};

}  // namespace standoff::cuda

#else

namespace standoff::emulated {

/// There is one.
struct DeviceScope {
  explicit DeviceScope(int) {}
};

}  // namespace standoff::emulated

#endif
