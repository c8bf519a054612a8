// SPDX-License-Identifier: Apache-2.0
// Which meshes need no diagnosis: closed ones whose parts all have a positive volume.
#include "sign/diagnosis/outward.h"

#include <gtest/gtest.h>

#include "standoff/compute.h"
#include "standoff/mesh_report.h"
#include "tests/sign/shapes.h"

namespace standoff {
namespace {

using testing::box;
using testing::joined;
using testing::moved;
using testing::reversed;
using testing::sphere;

Mesh flat(Mesh mesh) {
  for (Vec3& v : mesh.vertices) v.z = 0;
  return mesh;
}

TEST(Outward, AllPartsMustFaceOutwards) {
  EXPECT_TRUE(faces_outwards(box()));
  EXPECT_TRUE(faces_outwards(joined(box(), moved(sphere(), {1e6, 0, 0}, 1e-3))));
  EXPECT_FALSE(faces_outwards(reversed(box())));
  EXPECT_FALSE(faces_outwards(joined(box(), reversed(moved(sphere(), {1e6, 0, 0}, 1e-3)))));
  Mesh unused = box();
  unused.vertices.push_back({5, 5, 5});
  EXPECT_TRUE(faces_outwards(unused));
}

// Closed, all of them, and without an inside: what compute() takes by itself is what the report recommends.
TEST(Outward, ClosedMeshesWithoutAVolumeAreDiagnosed) {
  Mesh both{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}};
  const Mesh point{{{0, 0, 0}}, {{0, 0, 0}}};
  const Grid grid{{6, 6, 6}, {-1, -1, -1}, {0.5, 0.5, 0.5}};
  for (const Mesh& mesh : {both, point, flat(box())}) {
    EXPECT_FALSE(faces_outwards(mesh));
    const SignReport used = compute(mesh, grid, 1, {.sign = {SignMethod::automatic}}).report.sign;
    const MeshReport found = report(mesh);
    EXPECT_EQ(used.method, found.method) << used.why;
    EXPECT_EQ(used.sure, found.sure) << used.why;
  }
}

}  // namespace
}  // namespace standoff
