// SPDX-License-Identifier: Apache-2.0
#include "tests/gpu/runtime/pretend.h"

#include <cstdlib>
#include <cstring>
#include <utility>

#include "standoff/cuda.h"

namespace standoff::pretend {

Gpu gpu;

namespace {

cudaError_t called(const char* name, cudaStream_t stream = nullptr) {
  gpu.calls.push_back({name, stream});
  if (static_cast<long>(gpu.calls.size()) - 1 != gpu.fails_at) return cudaSuccess;
  return gpu.last = gpu.failure;
}

std::int64_t taken() {
  std::int64_t sum = 0;
  for (const auto& [at, bytes] : gpu.allocated) sum += bytes;
  return sum;
}

}  // namespace
}  // namespace standoff::pretend

using standoff::pretend::called;
using standoff::pretend::gpu;

// What the linker makes of a call of cudaName: __wrap_cudaName.
#define PRETEND(name) extern "C" cudaError_t __wrap_##name

PRETEND(cudaGetDeviceCount)(int* count) {
  if (const cudaError_t error = called("cudaGetDeviceCount")) return error;
  if (gpu.no_gpu == cudaSuccess) *count = static_cast<int>(gpu.capabilities.size());
  return gpu.no_gpu;
}
PRETEND(cudaGetDeviceProperties)(cudaDeviceProp* properties, int device) {
  *properties = {};
  std::strcpy(properties->name, "Pretended");
  properties->major = gpu.capabilities.at(static_cast<std::size_t>(device)) / 10;
  properties->minor = gpu.capabilities.at(static_cast<std::size_t>(device)) % 10;
  properties->totalGlobalMem = static_cast<std::size_t>(gpu.memory);
  return called("cudaGetDeviceProperties");
}
PRETEND(cudaGetDeviceProperties_v2)(cudaDeviceProp* properties, int device) {
  return __wrap_cudaGetDeviceProperties(properties, device);
}
PRETEND(cudaDriverGetVersion)(int* version) {
  *version = gpu.driver;
  return called("cudaDriverGetVersion");
}
PRETEND(cudaGetDevice)(int* device) {
  *device = gpu.current;
  return called("cudaGetDevice");
}
PRETEND(cudaSetDevice)(int device) {
  const cudaError_t error = called("cudaSetDevice");
  if (error == cudaSuccess) gpu.current = device;
  return error;
}
PRETEND(cudaDeviceGetAttribute)(int* value, cudaDeviceAttr attribute, int) {
  *value = attribute == cudaDevAttrComputeCapabilityMajor ? 9 : attribute == cudaDevAttrComputeCapabilityMinor ? 0 : 64;
  return called("cudaDeviceGetAttribute");
}
PRETEND(cudaFuncGetAttributes)(cudaFuncAttributes* attributes, const void*) {
  *attributes = {};
  attributes->ptxVersion = attributes->binaryVersion = 90;
  return called("cudaFuncGetAttributes");
}
PRETEND(cudaOccupancyMaxActiveBlocksPerMultiprocessorWithFlags)(int* blocks, const void*, int, std::size_t, unsigned) {
  *blocks = 2;
  return called("cudaOccupancyMaxActiveBlocksPerMultiprocessorWithFlags");
}
PRETEND(cudaGetLastError)() { return std::exchange(gpu.last, cudaSuccess); }
PRETEND(cudaPeekAtLastError)() { return gpu.last; }

PRETEND(cudaMalloc)(void** at, std::size_t bytes) {
  if (const cudaError_t error = called("cudaMalloc")) return error;
  if (standoff::pretend::taken() + static_cast<std::int64_t>(bytes) > gpu.memory) return cudaErrorMemoryAllocation;
  *at = std::aligned_alloc(256, (bytes + 255) / 256 * 256);
  std::memset(*at, 0xff, bytes);
  gpu.allocated[*at] = static_cast<std::int64_t>(bytes);
  return cudaSuccess;
}
PRETEND(cudaFree)(void* at) {
  gpu.allocated.erase(at);
  std::free(at);
  return called("cudaFree");
}
PRETEND(cudaHostAlloc)(void** at, std::size_t bytes, unsigned) {
  if (const cudaError_t error = called("cudaHostAlloc")) return error;
  *at = std::malloc(bytes);
  return cudaSuccess;
}
PRETEND(cudaFreeHost)(void* at) {
  std::free(at);
  return called("cudaFreeHost");
}
PRETEND(cudaMemGetInfo)(std::size_t* free, std::size_t* total) {
  *total = static_cast<std::size_t>(gpu.memory);
  *free = static_cast<std::size_t>(gpu.memory - standoff::pretend::taken());
  return called("cudaMemGetInfo");
}
PRETEND(cudaMemcpy)(void* to, const void* from, std::size_t bytes, cudaMemcpyKind kind) {
  // No kernel has run: all went well, and no tile is stored.
  if (kind == cudaMemcpyDeviceToHost && bytes == sizeof(standoff::cuda::Outcome))
    std::memset(to, 0, bytes);
  else
    std::memcpy(to, from, bytes);
  return called("cudaMemcpy");
}
PRETEND(cudaMemcpyAsync)(void* to, const void* from, std::size_t bytes, cudaMemcpyKind, cudaStream_t stream) {
  std::memcpy(to, from, bytes);
  return called("cudaMemcpyAsync", stream);
}
PRETEND(cudaMemsetAsync)(void* at, int value, std::size_t bytes, cudaStream_t stream) {
  std::memset(at, value, bytes);
  return called("cudaMemsetAsync", stream);
}
PRETEND(cudaEventCreateWithFlags)(cudaEvent_t* event, unsigned) {
  *event = nullptr;
  return called("cudaEventCreateWithFlags");
}
PRETEND(cudaEventRecord)(cudaEvent_t, cudaStream_t stream) { return called("cudaEventRecord", stream); }
PRETEND(cudaEventDestroy)(cudaEvent_t) { return called("cudaEventDestroy"); }
PRETEND(cudaLaunchKernelExC)(const cudaLaunchConfig_t* config, const void*, void**) {
  return called("a launch", config->stream);
}
PRETEND(cudaLaunchKernel)(const void*, dim3, dim3, void**, std::size_t, cudaStream_t stream) {
  return called("a launch", stream);
}
PRETEND(__cudaLaunchKernel)(cudaKernel_t, dim3, dim3, void**, std::size_t, cudaStream_t stream) {
  return called("a launch", stream);
}
PRETEND(__cudaGetKernel)(cudaKernel_t* kernel, const void*) {
  *kernel = nullptr;
  return cudaSuccess;
}

// What work on a stream must not do.
PRETEND(cudaDeviceSynchronize)() { return called("cudaDeviceSynchronize"); }
PRETEND(cudaStreamSynchronize)(cudaStream_t stream) { return called("cudaStreamSynchronize", stream); }
PRETEND(cudaEventSynchronize)(cudaEvent_t) { return called("cudaEventSynchronize"); }
PRETEND(cudaMallocAsync)(void**, std::size_t, cudaStream_t stream) { return called("cudaMallocAsync", stream); }
PRETEND(cudaFreeAsync)(void*, cudaStream_t stream) { return called("cudaFreeAsync", stream); }
