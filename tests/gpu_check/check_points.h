// SPDX-License-Identifier: Apache-2.0
// gpu-check, points: nearest triangles and distances found by this machine's GPU against the CPU's, bit by bit.
#pragma once

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "scenes/scenes.h"
#include "standoff/points.h"
#include "tests/support/random_mesh.h"

namespace standoff {

/// Prints a line per mesh; returns how many were wrong of how many.
inline std::pair<int, int> check_points(bool quick, Backend backend, int points_each) {
  std::vector<std::pair<std::string, Mesh>> meshes{{"soup", testing::random_soup(91, 2000, 1, 0.1)},
                                                   {"on a lattice", testing::nasty_soup(92, 60, 2)}};
  if (!quick) {
    meshes.emplace_back("far away", testing::random_soup(93, 500, 1, 0.2, {1e9, -3e8, 7}));
    meshes.emplace_back("labyrinth", scenes::make("labyrinth", 20000));
    meshes.emplace_back("fly", scenes::make("fly"));
  }
  int wrong = 0;
  for (const auto& [name, mesh] : meshes) {
    const MeshQuery query(mesh, {.sign = {SignMethod::none}});
    const Box box = bounds(mesh);
    testing::Random random(94);
    std::vector<Vec3> points;
    for (int n = 0; n < points_each; ++n)
      points.push_back(n % 4 == 0 ? mesh.vertices[random.below(static_cast<std::uint32_t>(mesh.vertices.size()))]
                                  : box.center() + box.extent() * random.in_cube(0.75));
    std::vector<ClosestPoint> found(points.size()), expected(points.size());
    query.closest(points, found, {.execution = {.backend = backend}});
    query.closest(points, expected, {.execution = {.backend = Backend::cpu}});
    int differ = 0;
    for (std::size_t n = 0; n < points.size(); ++n)
      differ += found[n].distance != expected[n].distance || found[n].triangle != expected[n].triangle ||
                !(found[n].point == expected[n].point);
    std::printf("%-6s points  %-18s %d of %zu differ\n", differ == 0 ? "ok" : "WRONG", name.c_str(), differ,
                points.size());
    std::fflush(stdout);
    wrong += differ != 0;
  }
  return {wrong, static_cast<int>(meshes.size())};
}

}  // namespace standoff
