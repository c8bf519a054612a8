// SPDX-License-Identifier: Apache-2.0
// surface.h with arguments that make no sense.
#include "standoff/surface.h"
#include "tests/api/misuse.h"

namespace standoff {
namespace {

using namespace testing;

const Grid kSurfaceGrid{{9, 9, 9}, {-1, -1, -1}, {0.4, 0.4, 0.4}};

DistanceField some_field() {
  ComputeOptions options{.sign = {SignMethod::none}, .execution = {.backend = Backend::cpu}};
  return compute(one_triangle(), kSurfaceGrid, kFullField, options).field;
}

TEST(Misuse, Surfaces) {
  const DistanceField field = some_field();
  for (const SurfaceMethod method : {SurfaceMethod::marching_cubes, SurfaceMethod::dual}) {
    for (const double x : kNumbers) {
      expect_answer_or_error(named("at", x), [&] { surface(field, {.at = x, .method = method}); });
      expect_answer_or_error(named("wall", x), [&] { surface(field, {.at = 1, .wall = x, .method = method}); });
      expect_answer_or_error(named("at", x), [&] {
        surface(one_triangle(), kSurfaceGrid, {.at = x, .method = method, .sign = {SignMethod::none}});
      });
    }
    for (const Mesh& mesh : odd_meshes())
      expect_answer_or_error(
          "mesh", [&] { surface(mesh, kSurfaceGrid, {.at = 0.3, .method = method, .sign = {SignMethod::none}}); });
  }
  for (const Grid& grid : odd_grids())
    expect_answer_or_error("grid", [&] { surface(one_triangle(), grid, {.at = 0.3, .sign = {SignMethod::none}}); });
  for (const Mesh& mesh : unusable_meshes())
    expect_answer_or_error("mesh", [&] { surface(mesh, kSurfaceGrid, {.sign = {SignMethod::automatic}}); });
}

TEST(Misuse, OptionsOfSurfaces) {
  const DistanceField field = some_field();
  expect_usage("method", [&] { surface(field, {.at = 1, .method = none_of<SurfaceMethod>()}); });
  expect_usage("coordinates", [&] { surface(field, {.at = 1, .coordinates = none_of<Coordinates>()}); });
  expect_usage("sign", [&] { surface(one_triangle(), kSurfaceGrid, {.sign = {none_of<SignMethod>()}}); });
  expect_usage("backend", [&] { surface(field, {.at = 1, .execution = {.backend = Backend::cuda}}); });
  for (const int threads : kThreads)
    expect_usage("threads", [&] { surface(field, {.at = 1, .execution = {.threads = threads}}); });
  SurfaceOptions options{.at = 0.5};
  options.progress = [](const Progress&) -> bool { throw 5; };
  EXPECT_THROW(surface(field, options), int);
  EXPECT_THROW(surface(one_triangle(), kSurfaceGrid, options), int);
}

}  // namespace
}  // namespace standoff
