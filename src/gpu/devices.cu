// SPDX-License-Identifier: Apache-2.0
// The GPUs that CUDA sees.
#include "gpu/devices.h"

#include <algorithm>
#include <iterator>

#include "core/guarded.h"
#include "gpu/platform_cuda.cuh"
#include "standoff/cuda.h"

namespace standoff::cuda {
namespace {

/// The lowest compute capability of the compiled kernels, times ten.
int lowest_capability() {
  constexpr int all[] = {__CUDA_ARCH_LIST__};
  return *std::min_element(std::begin(all), std::end(all)) / 10;
}
std::string text(int capability) { return std::to_string(capability / 10) + "." + std::to_string(capability % 10); }

bool is_too_old(const DeviceInfo& device) { return device.major * 10 + device.minor < lowest_capability(); }
std::string age_of(const DeviceInfo& device) {
  return "it has compute capability " + text(device.major * 10 + device.minor) + ", this build of standoff needs " +
         text(lowest_capability());
}

std::vector<DeviceInfo> ask_for_devices(int count) {
  std::vector<DeviceInfo> all;
  for (int n = 0; n < count; ++n) {
    cudaDeviceProp properties{};
    check_call(cudaGetDeviceProperties(&properties, n), "cudaGetDeviceProperties");
    all.push_back(
        {properties.name, properties.major, properties.minor, static_cast<std::int64_t>(properties.totalGlobalMem)});
  }
  return all;
}

/// All GPUs that CUDA lists, in its order; none without a driver or a GPU. What they are is asked once, as it stays the
/// same while the process runs, and every mesh wants to know it. An error is not kept.
std::vector<DeviceInfo> all_devices() {
  int count = 0;
  if (cudaGetDeviceCount(&count) != cudaSuccess) {
    cudaGetLastError();
    return {};
  }
  static const std::vector<DeviceInfo> all = ask_for_devices(count);
  return all;
}

}  // namespace

void check_usable(int device) {
  const auto known = devices();
  if (known.empty()) throw Error(ErrorCode::device, why_not_available());
  if (device < 0 || device >= static_cast<int>(known.size()))
    throw Error(ErrorCode::device, "cuda: there is no GPU " + std::to_string(device) + ", only 0 to " +
                                       std::to_string(known.size() - 1) + "; take one of these");
  const DeviceInfo& wanted = known[static_cast<std::size_t>(device)];
  if (is_too_old(wanted))
    throw Error(ErrorCode::device, "cuda: GPU " + std::to_string(device) + " is too old: " + age_of(wanted) +
                                       "; take another one or the CPU");
}

std::vector<DeviceInfo> devices() try {
  std::vector<DeviceInfo> all = all_devices();
  if (std::all_of(all.begin(), all.end(), is_too_old)) return {};
  for (DeviceInfo& one : all)
    if (is_too_old(one)) one.name += " (too old: " + age_of(one) + ")";
  return all;
} catch (...) {
  throw_as_error("cuda");
}

std::string why_no_device() try {
  int count = 0, driver = 0;
  const cudaError_t result = cudaGetDeviceCount(&count);
  cudaGetLastError();
  if (result == cudaSuccess && count > 0) {
    const auto all = all_devices();
    const bool usable = !std::all_of(all.begin(), all.end(), is_too_old);
    return usable ? "" : "GPU 0, " + all[0].name + ", is too old: " + age_of(all[0]);
  }
  cudaDriverGetVersion(&driver);
  cudaGetLastError();
  const auto version = [](int v) { return std::to_string(v / 1000) + "." + std::to_string(v % 1000 / 10); };
  if (driver == 0) return "no NVIDIA driver is installed";
  if (driver < CUDART_VERSION && result == cudaErrorInsufficientDriver)
    return "the NVIDIA driver is too old: it knows CUDA " + version(driver) + ", standoff was built with " +
           version(CUDART_VERSION);
  return std::string("the NVIDIA driver finds no GPU (") + cudaGetErrorString(result) + ")";
} catch (...) {
  throw_as_error("cuda");
}

bool available() { return !devices().empty(); }

std::string why_not_available() {
  return "cuda: " + why_no_device() + "; use the CPU, or a machine with a GPU and its driver";
}

std::string device_name(int device) {
  const auto all = devices();
  return device >= 0 && device < static_cast<int>(all.size()) ? all[device].name : "no device";
}

}  // namespace standoff::cuda
