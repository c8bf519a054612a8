// SPDX-License-Identifier: Apache-2.0
// standoff's isosurface of a signed field. With --save it hands the field and its surface to others.
#include <filesystem>

#include "measure.h"
#include "raw.h"
#include "signed_field.h"
#include "standoff/surface.h"
#include "workload.h"

namespace {

using namespace standoff;
using bench::Workload;

struct Settings {
  double at = 0;  ///< samples
  std::string save;
};

nlohmann::json run(const Workload& work, const Settings& settings) {
  const DistanceField field = bench::signed_field(work);
  IsoOptions options;
  options.at = settings.at * work.grid.spacing.x;
  options.execution.threads = work.threads;
  nlohmann::json line = work.describe();
  line["driver"] = "standoff";
  IsoResult result;
  bench::measure_calls(work.repeats, "iso", line, [&] { result = isosurface(field, options); });
  line["surface_triangles"] = result.mesh.triangles.size();
  if (settings.save.empty()) return line;
  const std::filesystem::path folder = settings.save;
  bench::save_mesh(folder, result.mesh);
  const std::vector<float> values = field.to_dense();
  bench::write_raw(folder / "field.f32", values.data(), values.size());
  const Grid& grid = work.grid;
  const nlohmann::json about = {{"size", {grid.size.x, grid.size.y, grid.size.z}},
                                {"origin", {grid.origin.x, grid.origin.y, grid.origin.z}},
                                {"spacing", grid.spacing.x},
                                {"at", options.at}};
  std::ofstream(folder / "grid.json") << about.dump();
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("standoff's isosurface of a signed field", "bench_iso");
  const bench::WorkloadOptions options(app);
  Settings settings;
  app.add_option("--at", settings.at, "the value on the surface, in samples");
  app.add_option("--save", settings.save, "write the field and the surface into this folder");
  return run_driver(app, options, argc, argv, [&](const Workload& work) { return run(work, settings); });
}
