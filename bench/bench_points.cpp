// SPDX-License-Identifier: Apache-2.0
// standoff's MeshQuery at many points: its build, and their distances, with a sign or without.

#include "driver.h"
#include "measure.h"
#include "point_workload.h"
#include "standoff/points.h"

namespace {

using namespace standoff;
using bench::PointWorkload;

struct Settings {
  bool with_sign = false, closest = false, winding = false;
};

nlohmann::json run(const PointWorkload& work, const Settings& settings) {
  MeshQueryOptions options{.execution = {.threads = work.threads, .backend = Backend::cpu}};
  // As the peers decide: by the winding number of the mesh as it is.
  options.sign = {.method = settings.with_sign ? SignMethod::winding : SignMethod::none,
                  .as_oriented = settings.with_sign};
  nlohmann::json line = work.describe();
  line["driver"] = "standoff";
  line["signed"] = settings.with_sign;
  std::optional<MeshQuery> query;
  bench::measure_calls(work.repeats, "build", line, [&] {
    query.reset();
    query.emplace(work.mesh, options);
  });
  line["memory_bytes"] = query->memory_bytes();
  line["sign"] = name_of(query->sign().method);
  const PointOptions asked{.execution = options.execution};
  std::vector<double> distances(work.points.size());
  bench::measure_calls(work.repeats, "given", line, [&] { query->distances(work.points, distances, asked); });
  work.save_answers(distances);
  if (settings.closest) {
    std::vector<ClosestPoint> closest(work.points.size());
    bench::measure_calls(work.repeats, "closest", line, [&] { query->closest(work.points, closest, asked); });
  }
  if (settings.winding) {
    std::vector<double> numbers(work.points.size());
    bench::measure_calls(work.repeats, "winding", line, [&] { query->winding_numbers(work.points, numbers, asked); });
  }
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("standoff's distances of many points", "bench_points");
  const bench::PointOptions options(app);
  Settings settings;
  app.add_flag("--signed", settings.with_sign, "negative inside, by the winding number of the mesh as it is oriented");
  app.add_flag("--closest", settings.closest, "measure closest points too");
  app.add_flag("--winding", settings.winding, "measure winding numbers too");
  return run_driver(app, options, argc, argv, [&](const PointWorkload& work) { return run(work, settings); });
}
