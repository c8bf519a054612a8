// SPDX-License-Identifier: Apache-2.0
// The cost of each sidecar of a band: the band with and without nearest triangles, and the sidecars after it, in turns.
#include <array>

#include "driver.h"
#include "measure.h"
#include "signed_field.h"
#include "standoff/sidecars.h"
#include "workload.h"

namespace {

using namespace standoff;
using bench::Workload;

nlohmann::json run(const Workload& work) {
  const std::array kinds{SidecarKind::closest_point, SidecarKind::barycentric, SidecarKind::feature,
                         SidecarKind::gradient};
  ComputeOptions plain{.sign = {SignMethod::none}, .execution = {.threads = work.threads, .backend = Backend::cpu}};
  ComputeOptions with_nearest = plain;
  with_nearest.nearest = true;
  DistanceField bare, field;
  std::array<std::vector<Sidecar>, kinds.size()> memory;
  std::vector<double> seconds_bare, seconds_nearest;
  std::array<std::vector<double>, kinds.size()> seconds;
  std::vector<double> processor_bare, processor_nearest;
  std::array<std::vector<double>, kinds.size()> processor;
  const auto timed = [](std::vector<double>& wall, std::vector<double>& of_processors, const auto& job) {
    const bench::Clock clock;
    job();
    wall.push_back(clock.wall());
    of_processors.push_back(clock.processor());
  };
  for (int n = 0; n <= work.repeats; ++n) {
    timed(seconds_bare, processor_bare, [&] { compute_into(work.mesh, work.grid, work.thickness, bare, plain); });
    timed(seconds_nearest, processor_nearest,
          [&] { compute_into(work.mesh, work.grid, work.thickness, field, with_nearest); });
    for (std::size_t k = 0; k < kinds.size(); ++k)
      timed(seconds[k], processor[k], [&] {
        sidecars_into(work.mesh, field, std::span(&kinds[k], 1), memory[k], {.execution = plain.execution});
      });
  }
  const auto warm = [](const std::vector<double>& all) { return bench::median({all.begin() + 1, all.end()}); };
  nlohmann::json line = work.describe();
  line["driver"] = "standoff";
  line["band_s"] = warm(seconds_bare);
  line["band_cpu_s"] = warm(processor_bare);
  line["nearest_s"] = warm(seconds_nearest);
  line["nearest_cpu_s"] = warm(processor_nearest);
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    line[name_of(kinds[k]) + "_s"] = warm(seconds[k]);
    line[name_of(kinds[k]) + "_cpu_s"] = warm(processor[k]);
  }
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("what each sidecar adds to a band", "bench_sidecars");
  const bench::WorkloadOptions options(app);
  return run_driver(app, options, argc, argv, run);
}
