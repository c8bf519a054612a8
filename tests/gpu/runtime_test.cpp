// SPDX-License-Identifier: Apache-2.0
// What standoff asks of the CUDA runtime, on a GPU that is pretended: work in device memory allocates nothing and waits
// for nothing; a call that fails is named, nothing is kept, and the next field is computed.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "standoff/compute.h"
#include "standoff/cuda.h"
#include "standoff/cuda_batch.h"
#include "standoff/cuda_compute.h"
#include "standoff/error.h"
#include "tests/gpu/runtime/pretend.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

using pretend::gpu;

class CudaRuntime : public ::testing::Test {
 protected:
  CudaRuntime() { gpu = {}; }
};

const Grid kGrid{{21, 18, 13}, {-4, -4, -3}, {0.5, 0.5, 0.5}};
const Mesh kMesh = testing::random_soup(95, 120, 4, 1.2);

ComputeOptions on_gpu(Method method = Method::tiles) {
  ComputeOptions options{.sign = {SignMethod::none}};
  options.execution.backend = Backend::cuda;
  options.method = method;
  return options;
}

struct Failure {
  ErrorCode code;
  std::string what;
};
Failure failure_of(const ComputeOptions& options) {
  try {
    compute(kMesh, kGrid, 1, options);
  } catch (const Error& error) {
    return {error.code(), error.what()};
  }
  return {ErrorCode::internal, "no error"};
}

// The calls so far allocated nothing and waited for nothing; returns how many launches there are on the stream.
int launches_alone(cudaStream_t on) {
  const std::set<std::string> allowed{"a launch",
                                      "cudaMemsetAsync",
                                      "cudaGetDevice",
                                      "cudaDeviceGetAttribute",
                                      "cudaFuncGetAttributes",
                                      "cudaOccupancyMaxActiveBlocksPerMultiprocessorWithFlags"};
  int launches = 0;
  for (const pretend::Call& call : gpu.calls) {
    EXPECT_TRUE(allowed.contains(call.name)) << call.name;
    if (call.name != "a launch" && call.name != "cudaMemsetAsync") continue;
    EXPECT_EQ(call.stream, on) << call.name;
    ++launches;
  }
  return launches;
}

// A workspace on a GPU that is pretended.
struct Workspace {
  explicit Workspace(std::int64_t size) : bytes(size), memory(static_cast<std::size_t>(size) + 256) {}
  void* at() { return memory.data() + (256 - reinterpret_cast<std::uintptr_t>(memory.data()) % 256) % 256; }
  std::int64_t bytes;
  std::vector<char> memory;
};

TEST_F(CudaRuntime, WorkInDeviceMemoryOnlyLaunchesOnTheCallersStream) {
  int stream = 0;  // its address is all that is looked at
  const auto on = reinterpret_cast<cudaStream_t>(&stream);
  float values[1];
  std::int32_t slots[1];
  cuda::Outcome outcome[1];
  for (const Method method : {Method::tiles, Method::thesis})
    for (const double thickness : {1.0, 5.0})
      for (const bool sparse : {false, true}) {
        cuda::Task task;
        task.mesh = {&kMesh.vertices.data()->x, static_cast<std::int64_t>(kMesh.vertices.size()),
                     kMesh.triangles.data()->data(), static_cast<std::int64_t>(kMesh.triangles.size())};
        task.grid = kGrid;
        task.thickness = thickness;
        task.method = method;
        task.output = {values, nullptr, sparse ? slots : nullptr, 18};
        task.outcome = outcome;
        Workspace workspace(cuda::workspace_bytes(task.mesh.triangle_count, kGrid, thickness, method, 1000));
        gpu.calls.clear();
        cuda::enqueue(task, workspace.at(), workspace.bytes, on);
        EXPECT_GE(launches_alone(on), 4);
      }
}

// As many launches for a thousand meshes as for one.
TEST_F(CudaRuntime, ManyMeshesTakeAsManyLaunchesAsOne) {
  int stream = 0;
  const auto on = reinterpret_cast<cudaStream_t>(&stream);
  const cuda::BatchPlace place[1]{};
  float values[1];
  cuda::Outcome outcome[1];
  const std::int64_t offsets[1]{};
  std::set<int> launches;
  for (const std::int64_t count : {1, 1000}) {
    cuda::BatchTask task;
    task.count = count;
    task.size = kGrid.size;
    task.first_vertex = task.first_triangle = offsets;
    task.places = place;
    task.values = values;
    task.outcomes = task.total = outcome;
    Workspace workspace(cuda::workspace_bytes(task, 1000));
    gpu.calls.clear();
    cuda::enqueue(task, workspace.at(), workspace.bytes, on);
    launches.insert(launches_alone(on));
  }
  EXPECT_EQ(launches.size(), 1u);
  EXPECT_GE(*launches.begin(), 10);
}

// No kernel has run, so the meshes seem to have changed meanwhile, which is an error of their input.
TEST_F(CudaRuntime, ArraysOnADeviceAreWorkedOnByItsStreamAlone) {
  int streams[3];
  const auto on = reinterpret_cast<cudaStream_t>(&streams[0]);
  const cuda::Stream others[] = {reinterpret_cast<cudaStream_t>(&streams[1]),
                                 reinterpret_cast<cudaStream_t>(&streams[2])};
  std::vector<float> vertices(3 * kMesh.vertices.size());  // kernels make doubles of them
  float values[1];
  const std::vector<cuda::FieldRequest> two(
      2, {{{vertices.data(), kMesh.vertices.size()}, kMesh.triangles}, kGrid, 1, values});
  for (const auto& answer : cuda::compute_each(two, {.device = 1, .stream = on, .after = others})) {
    ASSERT_TRUE(std::holds_alternative<Error>(answer));
    EXPECT_EQ(std::get<Error>(answer).code(), ErrorCode::input);
  }
  EXPECT_EQ(gpu.current, 0);
  EXPECT_TRUE(gpu.allocated.empty());
  std::vector<cudaStream_t> waited;
  int launches = 0, allocations = 0;
  for (const pretend::Call& call : gpu.calls) {
    if (call.name == "cudaStreamSynchronize") waited.push_back(call.stream);
    allocations += call.name == "cudaMalloc";
    if (call.name != "a launch" && call.name != "cudaMemsetAsync") continue;
    EXPECT_EQ(call.stream, on) << call.name;
    EXPECT_EQ(waited.size(), 2u) << "the others were not waited for";
    ++launches;
  }
  EXPECT_EQ(waited, (std::vector<cudaStream_t>{others[0], others[1], on}));
  EXPECT_EQ(launches, 1 + 2 * 3);
  EXPECT_EQ(allocations, 1);
}

TEST_F(CudaRuntime, EveryCallThatFailsIsNamedAndNothingIsKept) {
  // These only look whether there is a GPU, or give back what was taken.
  const std::set<std::string> silent{"cudaGetDeviceCount", "cudaDriverGetVersion", "cudaFree",
                                     "cudaFreeHost",       "cudaEventDestroy",     "cudaSetDevice"};
  int named = 0;
  for (const Method method : {Method::tiles, Method::thesis}) {
    bool failed = true;
    for (long n = 0; failed; ++n) {
      ASSERT_LT(n, 1000);
      gpu = {};
      gpu.fails_at = n;
      const Failure failure = failure_of(on_gpu(method));
      failed = static_cast<long>(gpu.calls.size()) > n;
      EXPECT_TRUE(gpu.allocated.empty());
      if (!failed) continue;
      const std::string& call = gpu.calls[static_cast<std::size_t>(n)].name;
      if (silent.contains(call)) continue;
      ++named;
      SCOPED_TRACE(call + ": " + failure.what);
      EXPECT_EQ(failure.code, ErrorCode::device);
      EXPECT_NE(failure.what.find(" failed at "), std::string::npos);
      EXPECT_EQ(gpu.last, cudaSuccess) << "the error is left behind";
      const std::size_t place = failure.what.find("src/");
      ASSERT_NE(place, std::string::npos);
      EXPECT_NE(failure.what.find(':', place), std::string::npos);
      EXPECT_EQ(failure.what.find("platform_cuda.cuh"), std::string::npos) << "names the wrapper, not the place";
      gpu.fails_at = -1;
      gpu.calls.clear();
      EXPECT_EQ(failure_of(on_gpu(method)).what, "no error");
    }
  }
  EXPECT_GT(named, 40);
}

TEST_F(CudaRuntime, TooLittleMemoryIsALimit) {
  gpu.memory = 1 << 13;
  const Failure failure = failure_of(on_gpu());
  EXPECT_EQ(failure.code, ErrorCode::limit);
  EXPECT_NE(failure.what.find("MiB more of the GPU's memory"), std::string::npos) << failure.what;
  EXPECT_EQ(std::count_if(gpu.calls.begin(), gpu.calls.end(), [](auto& call) { return call.name == "cudaMalloc"; }), 0);
  // Some of what seemed free is not: the allocation itself fails.
  gpu.memory = std::int64_t{1} << 32;
  gpu.calls.clear();
  gpu.failure = cudaErrorMemoryAllocation;
  EXPECT_EQ(failure_of(on_gpu()).what, "no error");
  const auto first = std::find_if(gpu.calls.begin(), gpu.calls.end(), [](auto& c) { return c.name == "cudaMalloc"; });
  gpu.fails_at = first - gpu.calls.begin() + 1;
  gpu.calls.clear();
  EXPECT_EQ(failure_of(on_gpu()).code, ErrorCode::limit);
  EXPECT_TRUE(gpu.allocated.empty());
}

TEST_F(CudaRuntime, AGpuThatIsTooOldIsNamedAndNotTaken) {
  ASSERT_EQ(cuda::devices().size(), 3u);
  EXPECT_EQ(cuda::devices()[1].name, "Pretended");
  EXPECT_NE(cuda::devices()[2].name.find("too old"), std::string::npos);
  EXPECT_EQ(failure_of(on_gpu()).what, "no error");
  ComputeOptions other = on_gpu();
  other.execution.device = 2;
  EXPECT_EQ(failure_of(other).code, ErrorCode::device);
  EXPECT_NE(failure_of(other).what.find("GPU 2 is too old"), std::string::npos);
  other.execution.device = 3;
  EXPECT_EQ(failure_of(other).code, ErrorCode::device);
  EXPECT_NE(failure_of(other).what.find("no GPU 3, only 0 to 2"), std::string::npos);
}

// Every mesh wants to know it several times.
TEST_F(CudaRuntime, WhatTheGpusAreIsAskedOnce) {
  ComputeOptions second = on_gpu();
  second.execution.device = 1;
  for (const ComputeOptions& options : {on_gpu(), second, on_gpu(), second})
    EXPECT_EQ(failure_of(options).what, "no error");
  EXPECT_EQ(cuda::devices().size(), 3u);
  const auto asked = std::count_if(gpu.calls.begin(), gpu.calls.end(),
                                   [](auto& call) { return call.name == "cudaGetDeviceProperties"; });
  EXPECT_LE(asked, 3);  // none, if an earlier test did
}

TEST_F(CudaRuntime, AutomaticTakesAGpuThatIsThereForLargeJobs) {
  const auto taken = [](std::int64_t side) {
    ComputeOptions options = on_gpu();
    options.execution.backend = Backend::automatic;
    return compute(kMesh, {{side, side, side}, {-4, -4, -4}, {0.1, 0.1, 0.1}}, 1, options).report.backend;
  };
  EXPECT_EQ(taken(20), "cpu");
  EXPECT_EQ(taken(170), "cuda");
  gpu.no_gpu = cudaErrorNoDevice;
  EXPECT_EQ(taken(170), "cpu");
}

TEST_F(CudaRuntime, TheCallersDeviceStaysCurrent) {
  ComputeOptions second = on_gpu();
  second.execution.device = 1;
  EXPECT_EQ(failure_of(second).what, "no error");
  EXPECT_EQ(gpu.current, 0);
  // Setting a device starts CUDA on it: never without need.
  gpu.calls.clear();
  EXPECT_EQ(failure_of(on_gpu()).what, "no error");
  EXPECT_EQ(std::count_if(gpu.calls.begin(), gpu.calls.end(), [](auto& c) { return c.name == "cudaSetDevice"; }), 0);
}

TEST_F(CudaRuntime, WhyThereIsNoGpu) {
  gpu.no_gpu = cudaErrorInsufficientDriver;
  gpu.driver = 11040;
  EXPECT_EQ(cuda::why_no_device().find("the NVIDIA driver is too old: it knows CUDA 11.4"), 0u);
  gpu.driver = 0;
  EXPECT_EQ(cuda::why_no_device(), "no NVIDIA driver is installed");
  gpu.no_gpu = cudaErrorNoDevice;
  gpu.driver = 13000;
  EXPECT_EQ(cuda::why_no_device().find("the NVIDIA driver finds no GPU"), 0u);
  EXPECT_TRUE(cuda::devices().empty());
  EXPECT_EQ(failure_of(on_gpu()).code, ErrorCode::device);
}

}  // namespace
}  // namespace standoff
