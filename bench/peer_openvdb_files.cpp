// SPDX-License-Identifier: Apache-2.0
// Writing the same field with OpenVDB's and NanoVDB's own writers: seconds, bytes and memory.
#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#include <openvdb/io/File.h>
#include <openvdb/version.h>
#include <tbb/global_control.h>

#include <filesystem>

#include "driver.h"
#include "measure.h"
#include "openvdb_field.h"
#include "signed_field.h"

namespace {

using namespace standoff;
using bench::Workload;

struct Settings {
  std::string file;
  std::string codec = "default";
};

void write_vdb(const openvdb::FloatGrid::Ptr& grid, const Settings& settings) {
  openvdb::io::File file(settings.file);
  if (settings.codec == "none") file.setCompression(openvdb::io::COMPRESS_ACTIVE_MASK);
  if (settings.codec == "zip") file.setCompression(openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK);
  if (settings.codec == "blosc") file.setCompression(openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK);
  file.write({grid});
  file.close();
}

/// NanoVDB's grid is made from OpenVDB's, then written without compression, which is a choice of its build.
void write_nvdb(const openvdb::FloatGrid::Ptr& grid, const Settings& settings) {
  const auto handle = nanovdb::openToNanoVDB(grid);
  nanovdb::io::writeGrid(settings.file, handle, nanovdb::io::Codec::NONE);
}

nlohmann::json run(const Workload& work, const Settings& settings) {
  tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(work.threads));
  openvdb::initialize();
  const auto grid = bench::openvdb_field(work, bench::signed_field(work));
  const bool nano = std::filesystem::path(settings.file).extension() == ".nvdb";
  nlohmann::json line = work.describe();
  line["driver"] = nano ? "nanovdb" : "openvdb";
  line["version"] = OPENVDB_LIBRARY_VERSION_STRING;
  line["codec"] = settings.codec;
  bench::forget_peak();
  line["memory_before"] = bench::process_bytes("VmRSS");
  bench::measure_calls(work.repeats, "write", line,
                       [&] { nano ? write_nvdb(grid, settings) : write_vdb(grid, settings); });
  line["memory_peak"] = bench::process_bytes("VmHWM");
  line["bytes"] = std::filesystem::file_size(settings.file);
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("OpenVDB's and NanoVDB's writers", "peer_openvdb_files");
  const bench::WorkloadOptions options(app);
  Settings settings;
  app.add_option("--to", settings.file, "the file: .vdb or .nvdb")->required();
  app.add_option("--codec", settings.codec, "of .vdb files; default: that of the library")
      ->check(CLI::IsMember({"default", "none", "zip", "blosc"}));
  return run_driver(app, options, argc, argv, [&](const Workload& work) { return run(work, settings); });
}
