// SPDX-License-Identifier: Apache-2.0
// surface.h with arguments that make no sense.
#include "standoff/surface.h"
#include "tests/api/misuse.h"

namespace standoff {
namespace {

using namespace testing;

const Grid kSurfaceGrid{{9, 9, 9}, {-1, -1, -1}, {0.4, 0.4, 0.4}};

DistanceField some_field() {
  ComputeOptions options;
  options.execution.backend = Backend::cpu;
  return compute(one_triangle(), kSurfaceGrid, kFullField, options).field;
}

TEST(Misuse, Surfaces) {
  const DistanceField field = some_field();
  for (const IsoMethod method : {IsoMethod::marching_cubes, IsoMethod::dual}) {
    for (const double x : kNumbers) {
      expect_answer_or_error(named("at", x), [&] { isosurface(field, {.at = x, .method = method}); });
      expect_answer_or_error(named("wall", x), [&] { isosurface(field, {.at = 1, .wall = x, .method = method}); });
      expect_answer_or_error(named("at", x),
                             [&] { isosurface(one_triangle(), kSurfaceGrid, {}, {.at = x, .method = method}); });
    }
    for (const Mesh& mesh : odd_meshes())
      expect_answer_or_error("mesh", [&] { isosurface(mesh, kSurfaceGrid, {}, {.at = 0.3, .method = method}); });
  }
  for (const Grid& grid : odd_grids())
    expect_answer_or_error("grid", [&] { isosurface(one_triangle(), grid, {}, {.at = 0.3}); });
  for (const Mesh& mesh : unusable_meshes())
    expect_answer_or_error("mesh", [&] { isosurface(mesh, kSurfaceGrid, {SignMethod::automatic}); });
}

TEST(Misuse, OptionsOfSurfaces) {
  const DistanceField field = some_field();
  expect_usage("method", [&] { isosurface(field, {.at = 1, .method = none_of<IsoMethod>()}); });
  expect_usage("coordinates", [&] { isosurface(field, {.at = 1, .coordinates = none_of<Coordinates>()}); });
  expect_usage("memory", [&] { isosurface(field, {.at = 1, .memory_limit = -1}); });
  expect_usage("sign", [&] { isosurface(one_triangle(), kSurfaceGrid, {none_of<SignMethod>()}); });
  expect_usage("backend", [&] { isosurface(field, {.at = 1, .execution = {.backend = Backend::cuda}}); });
  for (const int threads : kThreads)
    expect_usage("threads", [&] { isosurface(field, {.at = 1, .execution = {.threads = threads}}); });
  IsoOptions options{.at = 0.5};
  options.progress = [](const Progress&) -> bool { throw 5; };
  EXPECT_THROW(isosurface(field, options), int);
  EXPECT_THROW(isosurface(one_triangle(), kSurfaceGrid, {}, options), int);
}

}  // namespace
}  // namespace standoff
