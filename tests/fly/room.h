// SPDX-License-Identifier: Apache-2.0
// A small labyrinth, and flies in it.
#pragma once

#include <algorithm>
#include <mutex>

#include "fly/world.h"
#include "tests/collision/bodies.h"

namespace standoff::testing {

/// A room of thin walls with a wall through the middle that has a hole.
inline Mesh room() {
  Mesh mesh;
  const auto quad = [&](Vec3 a, Vec3 u, Vec3 v) {
    add_triangle(mesh, a, a + u, a + u + v);
    add_triangle(mesh, a, a + u + v, a + v);
  };
  const Vec3 x{10, 0, 0}, y{0, 4, 0}, z{0, 0, 6};
  quad({0, 0, 0}, x, y), quad({0, 0, 6}, x, y);
  quad({0, 0, 0}, x, z), quad({0, 4, 0}, x, z);
  quad({0, 0, 0}, y, z), quad({10, 0, 0}, y, z);
  quad({5, 0, 0}, y, {0, 0, 4});
  return mesh;
}

struct Flown {
  std::vector<fly::Flier> fliers;
  std::vector<fly::PathPoint> path;
};

inline Flown flown(fly::FlightOptions options, std::int64_t steps, int count) {
  const Body walls(room()), body(ball_mesh(0.3, 3));
  fly::World world(body, options);
  world.add(walls);
  for (int n = 0; n < count; ++n) world.add_flier({{0.5, 0.5, 0.5}, {9.5, 3.5, 5.5}});
  Flown all;
  std::mutex adding;
  world.run(steps, [&](std::size_t n, std::int64_t step, const Pose& pose) {
    const std::lock_guard lock(adding);
    all.path.push_back({static_cast<std::int64_t>(n), step, pose.translation});
  });
  // Threads take the fliers in any order; those of one keep theirs.
  std::ranges::stable_sort(all.path, {}, &fly::PathPoint::flier);
  all.fliers.assign(world.fliers().begin(), world.fliers().end());
  return all;
}

}  // namespace standoff::testing
