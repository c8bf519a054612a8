// SPDX-License-Identifier: Apache-2.0
// Writing a signed field with standoff: seconds, bytes and memory. The field is computed before.
#include <filesystem>

#include "driver.h"
#include "measure.h"
#include "signed_field.h"
#include "standoff/io.h"
#include "workload.h"

namespace {

using namespace standoff;
using bench::Workload;

nlohmann::json run(const Workload& work, const std::string& file) {
  const DistanceField field = bench::signed_field(work);
  nlohmann::json line = work.describe();
  line["driver"] = "standoff";
  line["memory_field"] = field.memory_bytes();
  bench::forget_peak();
  line["memory_before"] = bench::process_bytes("VmRSS");
  bench::measure_calls(work.repeats, "write", line, [&] { write_field(file, field); });
  line["memory_peak"] = bench::process_bytes("VmHWM");
  line["bytes"] = std::filesystem::file_size(file);
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("standoff's writers of fields", "bench_files");
  const bench::WorkloadOptions options(app);
  std::string file;
  app.add_option("--to", file, "the file; its extension is the format")->required();
  return run_driver(app, options, argc, argv, [&](const Workload& work) { return run(work, file); });
}
