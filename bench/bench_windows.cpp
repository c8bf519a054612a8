// SPDX-License-Identifier: Apache-2.0
// A signed field in windows beside the whole field: seconds of both, taken by turns in one process.
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "driver.h"
#include "measure.h"
#include "signed_field.h"
#include "standoff/windows.h"
#include "workload.h"

namespace {

using namespace standoff;
using bench::Workload;

// Calls use(first, size) for `per_axis` windows along each axis, of whole bricks, x fastest.
template <class Use>
void for_each_window(const Grid& grid, std::int64_t per_axis, const Use& use) {
  Size3 side;
  for (std::size_t axis = 0; axis < 3; ++axis) side[axis] = (grid.size[axis] / per_axis + 15) / 16 * 16;
  Size3 at;
  for (at.z = 0; at.z < grid.size.z; at.z += side.z)
    for (at.y = 0; at.y < grid.size.y; at.y += side.y)
      for (at.x = 0; at.x < grid.size.x; at.x += side.x) {
        Size3 size;
        for (std::size_t axis = 0; axis < 3; ++axis) size[axis] = std::min(side[axis], grid.size[axis] - at[axis]);
        use(at, size);
      }
}

// Seconds of the wall clock and of all processors, of each turn.
struct Times {
  std::vector<double> wall, processor;

  template <class Work>
  void add(const Work& work) {
    const bench::Clock clock;
    work();
    wall.push_back(clock.wall());
    processor.push_back(clock.processor());
  }
  void write(const std::string& name, nlohmann::json& line) const {
    line[name + "_s"] = bench::median(wall);
    line[name + "_cpu_s"] = bench::median(processor);
  }
};

nlohmann::json run(const Workload& work, std::int64_t per_axis) {
  nlohmann::json line = work.describe();
  line["driver"] = "standoff";
  const ComputeOptions options = bench::signed_options(work);
  Size3 largest;
  std::int64_t count = 0;
  for_each_window(work.grid, per_axis, [&](const Size3&, const Size3& size) {
    for (std::size_t axis = 0; axis < 3; ++axis) largest[axis] = std::max(largest[axis], size[axis]);
    ++count;
  });
  Times whole, prepare, windows;
  DistanceField field, part;
  for (int turn = 0; turn < work.repeats; ++turn) {
    whole.add([&] { compute_into(work.mesh, work.grid, work.thickness, field, options); });
    std::optional<WindowComputation> computation;
    windows.add([&] {
      prepare.add([&] { computation.emplace(work.mesh, work.grid, work.thickness, largest, options); });
      for_each_window(work.grid, per_axis,
                      [&](const Size3& first, const Size3& size) { computation->compute(first, size, part); });
    });
  }
  whole.write("whole", line);
  prepare.write("prepare", line);
  windows.write("windows", line);
  line["windows"] = count;
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("a field in windows beside the whole field", "bench_windows");
  const bench::WorkloadOptions options(app);
  std::int64_t per_axis = 4;
  app.add_option("--per-axis", per_axis, "windows along each axis")->check(CLI::PositiveNumber);
  return run_driver(app, options, argc, argv, [&](const Workload& work) { return run(work, per_axis); });
}
