// SPDX-License-Identifier: Apache-2.0
// Writing a signed field with standoff: seconds, bytes and memory. The field is computed before; with --slabs it is
// computed while it is written, which is timed too.
#include <filesystem>

#include "driver.h"
#include "measure.h"
#include "signed_field.h"
#include "standoff/io.h"
#include "standoff/slabs.h"
#include "workload.h"

namespace {

using namespace standoff;
using bench::Workload;

// Adds the time, bytes and memory of a way of writing.
void measure(const Workload& work, const std::string& file, nlohmann::json& line, const std::function<void()>& write) {
  bench::forget_peak();
  line["memory_before"] = bench::process_bytes("VmRSS");
  bench::measure_calls(work.repeats, "write", line, write);
  line["memory_peak"] = bench::process_bytes("VmHWM");
  line["bytes"] = std::filesystem::file_size(file);
}

nlohmann::json run(const Workload& work, const std::string& file, bool in_slabs) {
  nlohmann::json line = work.describe();
  line["driver"] = "standoff";
  if (in_slabs) {
    measure(work, file, line, [&] {
      SlabComputation slabs(work.mesh, work.grid, work.thickness, bench::signed_options(work));
      write_field(file, slabs);
    });
    return line;
  }
  const DistanceField field = bench::signed_field(work);
  line["memory_field"] = field.memory_bytes();
  measure(work, file, line, [&] { write_field(file, field); });
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("standoff's writers of fields", "bench_files");
  const bench::WorkloadOptions options(app);
  std::string file;
  bool in_slabs = false;
  app.add_option("--to", file, "the file; its extension is the format")->required();
  app.add_flag("--slabs", in_slabs, "compute the field while it is written, slab by slab");
  return run_driver(app, options, argc, argv, [&](const Workload& work) { return run(work, file, in_slabs); });
}
