// SPDX-License-Identifier: Apache-2.0
// What is built before questions are asked can be stopped between its steps.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <utility>

#include "standoff/collision.h"
#include "standoff/mesh_report.h"
#include "standoff/points.h"
#include "tests/api/stop_everywhere.h"
#include "tests/collision/bodies.h"

namespace standoff::testing {
namespace {

// A sphere with a hole, whose sign needs a diagnosis.
Mesh open_ball() {
  Mesh mesh = ball_mesh(1, 3);
  mesh.triangles.pop_back();
  return mesh;
}

TEST(Interrupted, Report) {
  EXPECT_GE(stop_everywhere([](const ProgressCallback& progress) {
              EXPECT_EQ(report(open_ball(), {.execution = {.threads = 1}, .progress = progress}).boundary_edges, 3);
            }),
            8);
}

TEST(Interrupted, BuildingAQuery) {
  EXPECT_GE(stop_everywhere([](const ProgressCallback& progress) {
              const MeshQuery query(open_ball(), {{SignMethod::automatic}, {.threads = 1}, progress});
              EXPECT_EQ(query.sign().boundary_edges, 3);
            }),
            5);
}

// The steps of large meshes report often: a report is where work can be stopped.
TEST(Interrupted, LongStepsReportOften) {
  const Mesh mesh = ball_mesh(1, 64);
  std::map<std::string, int> reports;
  const ProgressCallback count = [&](const Progress& now) {
    ++reports[std::string(now.stage)];
    return true;
  };
  const MeshQuery query(mesh, {{SignMethod::none}, {.threads = 1}, count});
  EXPECT_GE(reports["search tree"], 20);
  reports.clear();
  const Body model(mesh, {.execution = {.threads = 1}, .progress = count});
  EXPECT_GE(reports["search tree"], 10);
  EXPECT_GE(reports["components"], 8);
  Mesh turned = mesh;  // which needs a diagnosis
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  reports.clear();
  const MeshQuery signed_query(turned, {{SignMethod::automatic}, {.threads = 1}, count});
  EXPECT_GE(reports["sign"], 20);
}

TEST(Interrupted, BuildingAModel) {
  EXPECT_GE(stop_everywhere([](const ProgressCallback& progress) {
              const Body model(open_ball(), {.execution = {.threads = 1}, .progress = progress});
              EXPECT_FALSE(model.has_inside());
            }),
            5);
}

// What a callback throws comes out as it is, also through the computations within.
TEST(Interrupted, ByAnExceptionOfTheCallback) {
  struct Stop {};
  EXPECT_THROW(Body(open_ball(), {.progress = [](const Progress&) -> bool { throw Stop{}; }}), Stop);
  EXPECT_THROW(report(open_ball(), {.progress = [](const Progress&) -> bool { throw Stop{}; }}), Stop);
}

}  // namespace
}  // namespace standoff::testing
