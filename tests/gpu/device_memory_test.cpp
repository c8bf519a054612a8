// SPDX-License-Identifier: Apache-2.0
// A GPU whose memory is too small, emulated: an error that says how much is needed, nothing kept, and all works
// afterwards.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "gpu/platform.cuh"
#include "standoff/collision.h"
#include "standoff/compute.h"
#include "standoff/error.h"
#include "standoff/testing/emulation.h"
#include "tests/collision/bodies.h"
#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

// A GPU with so many bytes, for as long as it lives.
class SmallGpu {
 public:
  explicit SmallGpu(std::int64_t bytes) : before_(emulated::memory_total) { emulated::memory_total = bytes; }
  ~SmallGpu() { emulated::memory_total = before_; }

 private:
  std::int64_t before_;
};

class CudaRoomOf : public ::testing::TestWithParam<Method> {};

TEST_P(CudaRoomOf, TooLittleIsSaidAndNothingIsKept) {
  const Mesh mesh = testing::random_soup(81, 200, 4, 1);
  const Grid grid{{21, 18, 13}, {-4, -4, -3}, {0.5, 0.5, 0.5}};
  ComputeOptions options{.sign = {SignMethod::none}};
  options.execution.backend = testing::kEmulated;
  options.method = GetParam();
  const DistanceField field = compute(mesh, grid, 3, options).field;
  bool fitted = false;
  for (std::int64_t bytes = 0; !fitted; bytes = bytes + bytes / 8 + 100) {
    ASSERT_LT(bytes, 1 << 30);
    const SmallGpu gpu(bytes);
    try {
      testing::expect_same_bits(compute(mesh, grid, 3, options).field, field);
      fitted = true;
    } catch (const Error& error) {
      const std::string what = error.what();
      EXPECT_EQ(error.code(), ErrorCode::limit) << what;
      EXPECT_NE(what.find("MiB more of the GPU's memory"), std::string::npos) << what;
      EXPECT_NE(what.find("take fewer samples"), std::string::npos) << what;
    }
    EXPECT_EQ(emulated::memory_taken, 0);
  }
  testing::expect_same_bits(compute(mesh, grid, 3, options).field, field);
}

// What is missing is told before anything is allocated: the sum of all that is known by then, not the piece that did
// not fit.
TEST(CudaRoom, TheWholeNeedIsTold) {
  const Mesh mesh = testing::random_soup(82, 10, 4, 1);
  const Grid grid{{256, 256, 256}, {-4, -4, -4}, {0.03, 0.03, 0.03}};
  ComputeOptions options{.sign = {SignMethod::none}};
  options.execution.backend = testing::kEmulated;
  options.method = Method::thesis;
  const SmallGpu gpu(std::int64_t{100} << 20);
  try {
    compute(mesh, grid, 0.03, options);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    // 8 bytes a sample and 16 a tile: more than 128 MiB. How many tiles must be stored has not been counted yet.
    EXPECT_NE(
        std::string(error.what()).find("needs at least 129 MiB more of the GPU's memory, 100 of 100 MiB are free"),
        std::string::npos)
        << error.what();
  }
}

// The platform's message spoke of fields to those who asked about bodies.
TEST(CudaRoom, ABatchOfPosesIsNotToldToTakeFewerSamples) {
  const Body ball(testing::ball_mesh(1, 4)), small(testing::ball_mesh(0.5, 3));
  testing::Random random(83);
  std::vector<Pose> poses;
  for (int n = 0; n < 50; ++n) poses.push_back(testing::random_pose(random, 1.5));
  const auto expected = collide_all(ball, {}, small, poses, {}, {.backend = Backend::cpu}).results;
  int refused = 0;
  bool fitted = false;
  for (std::int64_t bytes = 0; !fitted; bytes = 2 * bytes + 100) {
    ASSERT_LT(bytes, std::int64_t{1} << 32);
    const SmallGpu gpu(bytes);
    try {
      const auto found = collide_all(ball, {}, small, poses, {}, {.backend = testing::kEmulated}).results;
      for (std::size_t n = 0; n < poses.size(); ++n) EXPECT_EQ(found[n].verdict, expected[n].verdict) << "pose " << n;
      fitted = true;
    } catch (const Error& error) {
      const std::string what = error.what();
      EXPECT_EQ(error.code(), ErrorCode::limit) << what;
      EXPECT_NE(what.find("MiB more of the GPU's memory"), std::string::npos) << what;
      EXPECT_EQ(what.find("field"), std::string::npos) << what;
      EXPECT_EQ(what.find("samples"), std::string::npos) << what;
      ++refused;
    }
  }
  EXPECT_GT(refused, 3) << "a GPU that is too small for one model, for both, and for the queries";
}

INSTANTIATE_TEST_SUITE_P(Methods, CudaRoomOf, ::testing::Values(Method::tiles, Method::thesis));

}  // namespace
}  // namespace standoff
