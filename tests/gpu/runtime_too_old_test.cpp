// SPDX-License-Identifier: Apache-2.0
// All GPUs of the process are older than the kernels. A program of its own, as a process asks once what its GPUs are.
#include <gtest/gtest.h>

#include <string>

#include "standoff/compute.h"
#include "standoff/cuda.h"
#include "standoff/error.h"
#include "tests/gpu/runtime/pretend.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

ComputeResult compute_on(Backend backend, std::int64_t side) {
  ComputeOptions options{.sign = {SignMethod::none}};
  options.execution.backend = backend;
  return compute(testing::random_soup(95, 120, 4, 1.2), {{side, side, side}, {-4, -4, -4}, {0.1, 0.1, 0.1}}, 1,
                 options);
}

TEST(CudaRuntimeTooOld, GpusAreNamedAndNotTaken) {
  pretend::gpu.capabilities = {61};
  EXPECT_TRUE(cuda::devices().empty());
  const std::string why = "GPU 0, Pretended, is too old: it has compute capability 6.1, this build of standoff ";
  EXPECT_EQ(cuda::why_no_device().find(why), 0u);
  try {
    compute_on(Backend::cuda, 20);
    ADD_FAILURE() << "it computed";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::device);
    EXPECT_NE(std::string(error.what()).find(why), std::string::npos);
  }
  EXPECT_EQ(compute_on(Backend::automatic, 170).report.backend, "cpu");  // so large that it would be "cuda"
}

}  // namespace
}  // namespace standoff
