// SPDX-License-Identifier: Apache-2.0
// OpenVDB's volumeToMesh of the same signed field that standoff makes a surface of.
#include <openvdb/tools/VolumeToMesh.h>
#include <openvdb/version.h>
#include <tbb/global_control.h>

#include "iso_driver.h"
#include "measure.h"
#include "openvdb_field.h"
#include "raw.h"
#include "signed_field.h"

namespace {

using namespace standoff;
using bench::Workload;

nlohmann::json run(const Workload& work, const bench::IsoSettings& settings) {
  tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(work.threads));
  openvdb::initialize();
  const auto grid = bench::openvdb_field(work, bench::signed_field(work));
  nlohmann::json line = work.describe();
  line["driver"] = "openvdb";
  line["version"] = OPENVDB_LIBRARY_VERSION_STRING;
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  bench::measure_calls(work.repeats, "iso", line,
                       [&] { openvdb::tools::volumeToMesh(*grid, points, quads, settings.at * work.grid.spacing.x); });
  line["surface_triangles"] = 2 * quads.size();
  if (settings.save.empty()) return line;
  Mesh mesh;
  for (const auto& p : points) mesh.vertices.push_back({p.x(), p.y(), p.z()});
  for (const auto& q : quads) {
    mesh.triangles.push_back({q[0], q[1], q[2]});
    mesh.triangles.push_back({q[0], q[2], q[3]});
  }
  bench::save_mesh(settings.save, mesh);
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  return bench::run_iso_driver("OpenVDB's volumeToMesh of a signed field", "peer_openvdb_iso", argc, argv, run);
}
