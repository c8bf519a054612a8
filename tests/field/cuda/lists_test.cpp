// SPDX-License-Identifier: Apache-2.0
// The lists of thin bands, whose length is counted in a pass of its own.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "field/cuda/pipeline.cuh"
#include "standoff/error.h"
#include "tests/support/random_mesh.h"

namespace standoff::emulated {
namespace {

// The first pass counts the lengths of lists. If the second one wrote more, it would write in front of them, and from
// there anywhere; if it wrote fewer, old memory would be taken for triangles.
TEST(CudaLists, AMeshThatChangesBetweenThePassesIsNoticed) {
  const Grid grid{{32, 32, 32}, {-8.25, -8.25, -8.25}, {0.5, 0.5, 0.5}};
  // Short triangles for one kernel, long ones for the other: first out of the grid, then in it.
  for (const auto& [longest, leaves] : {std::pair{0.5, false}, {20.0, false}, {0.5, true}, {20.0, true}}) {
    SCOPED_TRACE(leaves);
    Mesh mesh = testing::random_soup(104, 30, 4, longest, {100, 100, 100});
    Mesh here = testing::random_soup(104, 30, 4, longest);
    mesh.vertices[0] = mesh.vertices[1] = mesh.vertices[2] = {};  // one is counted, so that there are lists
    if (longest > 1) mesh.vertices[1] = {20, 0, 0};
    if (leaves) std::swap(mesh.vertices, here.vertices);  // first in the grid, then out of it
    const DeviceMesh view{&mesh.vertices.data()->x, static_cast<std::int64_t>(mesh.vertices.size()),
                          mesh.triangles.data()->data(), static_cast<std::int64_t>(mesh.triangles.size())};
    Outcome outcome{};
    Task task{view, grid, 1.0, Method::tiles, {}, &outcome};
    std::vector<float> values(static_cast<std::size_t>(grid.sample_count()), -77.0f);
    task.output.values = values.data();
    const Lattice l = make_lattice(grid, 1.0);
    const Memory memory(needed_bytes<ThinBand>(30, l, 10000));
    gpu::Workspace workspace(memory.as<void>());
    const ThinBand arrays(workspace, 30, l, 10000);
    arrays.count(l, task, nullptr);
    ASSERT_EQ(outcome.stopped, 0u);
    std::copy(here.vertices.begin(), here.vertices.end(), mesh.vertices.begin());
    // The long ones were listed in the first pass.
    if (!leaves) std::iota(arrays.long_ones.numbers, arrays.long_ones.numbers + 30, 0u);
    if (!leaves && longest > 1) *arrays.long_ones.count = 30;
    arrays.fill(l, task, nullptr);
    EXPECT_NE(outcome.stopped, 0u);
    EXPECT_TRUE(std::all_of(values.begin(), values.end(), [](float v) { return v == -77.0f; }));
    try {
      cuda::check(outcome, task);
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input);
      EXPECT_NE(std::string(error.what()).find("the mesh changed while"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace standoff::emulated
