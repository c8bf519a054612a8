// SPDX-License-Identifier: Apache-2.0
// standoff's isosurface of a signed field. With --save it hands the field and its surface to others.
#include <filesystem>

#include "iso_driver.h"
#include "measure.h"
#include "raw.h"
#include "signed_field.h"
#include "standoff/surface.h"

namespace {

using namespace standoff;
using bench::Workload;

nlohmann::json run(const Workload& work, const bench::IsoSettings& settings) {
  const DistanceField field = bench::signed_field(work);
  SurfaceOptions options{.at = settings.at * work.grid.spacing.x, .execution = {.threads = work.threads}};
  nlohmann::json line = work.describe();
  line["driver"] = "standoff";
  SurfaceResult result;
  bench::measure_calls(work.repeats, "iso", line, [&] { result = surface(field, options); });
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
  return bench::run_iso_driver("standoff's isosurface of a signed field", "bench_iso", argc, argv, run);
}
