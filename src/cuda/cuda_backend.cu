// The GPU backend on CUDA.
#include "cuda/backend.h"
#include "cuda/device_scope.cuh"
#include "cuda/driver.cuh"

namespace difi::cuda {
std::vector<DeviceInfo> devices() {
  std::vector<DeviceInfo> all;
  int count = 0;  // left untouched where there is no driver
  if (cudaGetDeviceCount(&count) != cudaSuccess) {
    cudaGetLastError();
    return all;
  }
  for (int n = 0; n < count; ++n) {
    cudaDeviceProp properties{};
    check_call(cudaGetDeviceProperties(&properties, n), "cudaGetDeviceProperties");
    all.push_back(
        {properties.name, properties.major, properties.minor, static_cast<std::int64_t>(properties.totalGlobalMem)});
  }
  return all;
}

std::string why_no_device() {
  int count = 0, driver = 0;
  const cudaError_t result = cudaGetDeviceCount(&count);
  cudaGetLastError();
  if (result == cudaSuccess && count > 0) return "";
  cudaDriverGetVersion(&driver);
  cudaGetLastError();
  const auto version = [](int v) { return std::to_string(v / 1000) + "." + std::to_string(v % 1000 / 10); };
  if (driver == 0) return "no NVIDIA driver is installed";
  if (driver < CUDART_VERSION && result == cudaErrorInsufficientDriver)
    return "the NVIDIA driver is too old: it knows CUDA " + version(driver) + ", difi was built with " +
           version(CUDART_VERSION);
  return std::string("the NVIDIA driver finds no GPU (") + cudaGetErrorString(result) + ")";
}

bool available() { return !devices().empty(); }

std::string why_not_available() {
  return "cuda: " + why_no_device() + "; use the CPU (--device cpu), or install a GPU and its driver";
}

std::string device_name(int device) {
  const auto all = devices();
  return device >= 0 && device < static_cast<int>(all.size()) ? all[device].name : "no device";
}

Counts run_tiles(const Job& job, Sink& sink) {
  const DeviceScope scope(job.device);
  return run(job, sink, Method::tiles);
}

Counts run_thesis(const Job& job, Sink& sink) {
  const DeviceScope scope(job.device);
  return run(job, sink, Method::thesis);
}

}  // namespace difi::cuda
