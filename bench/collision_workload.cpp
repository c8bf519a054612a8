// SPDX-License-Identifier: Apache-2.0
#include "collision_workload.h"

#include <CLI/CLI.hpp>

namespace standoff::bench {

void add_options(CLI::App& app, CollisionSettings& settings) {
  app.add_option("--a", settings.a.name,
                 "what rests: a scene, a body of bench/conforming.h, or a mesh file (with a slash in its name)");
  app.add_option("--b", settings.b.name, "what is placed");
  app.add_option("--triangles-a", settings.a.triangles, "of a scene; a file is split until it has so many");
  app.add_option("--triangles-b", settings.b.triangles);
  app.add_option("--size-a", settings.a.size,
                 "longest side, world units, the middle at the origin (default: as it is)");
  app.add_option("--size-b", settings.b.size);
  app.add_option("--poses", settings.poses);
  app.add_option("--hits", settings.hits, "the share of poses that collide");
  app.add_option("--way", settings.way, "length of a sweep, world units");
  app.add_option("--direction", settings.direction, "of all sweeps, a unit vector, instead of random ones")
      ->expected(3);
  app.add_option("--tolerance", settings.tolerance, "of a sweep");
}

}  // namespace standoff::bench
