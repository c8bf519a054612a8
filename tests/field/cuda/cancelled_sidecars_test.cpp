// SPDX-License-Identifier: Apache-2.0
// Sidecars asked for by a task of TBB that is cancelled: loops in that task's arena would end at once, and look as if
// they were done. So the orientation of the mesh is found in threads of its own. A file of its own, as the thread
// sanitizer's TBB has no task_group.
#include <gtest/gtest.h>
#include <tbb/task_group.h>

#include <vector>

#include "standoff/cuda_compute.h"
#include "tests/field/cuda/on_stream.h"
#include "tests/sign/shapes.h"
#include "tests/support/fields.h"

namespace standoff {
namespace {

TEST(CudaSidecars, AreThoseOfTheWholeMeshInACancelledTask) {
  const Mesh mesh =
      testing::with_flipped(testing::joined(testing::box(), testing::moved(testing::sphere(40), {5, 0, 0})), 2);
  const Grid grid{{17, 17, 17}, {-0.25, -0.25, -0.25}, {0.125, 0.125, 0.125}};
  const auto samples = static_cast<std::size_t>(grid.sample_count());
  const auto gradients = [&] {
    std::vector<float> values(samples), gradient(3 * samples);
    std::vector<std::uint32_t> nearest(samples);
    cuda::FieldRequest request{mesh, grid, 0.3, values.data()};
    request.sign = {};
    request.nearest = nearest.data();
    request.sidecars.gradient = gradient.data();
    cuda::value_or_throw(cuda::compute_each({&request, 1}, kEmulated)[0]);
    return gradient;
  };
  std::vector<float> cancelled;
  tbb::task_group group;
  group.run([&] {
    group.cancel();
    cancelled = gradients();
  });
  group.wait();
  EXPECT_TRUE(testing::bits_of(cancelled) == testing::bits_of(gradients()));
}

}  // namespace
}  // namespace standoff
