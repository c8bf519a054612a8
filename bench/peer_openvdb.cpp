// SPDX-License-Identifier: Apache-2.0
// OpenVDB's meshToVolume, unsigned or as a level set: a sparse band of approximate distances. With --sweep, its fast
// sweeping then extends a thin level set to all samples of the grid.
#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/FastSweeping.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/version.h>
#include <tbb/global_control.h>

#include "compare.h"
#include "driver.h"
#include "measure.h"
#include "workload.h"

namespace {

using standoff::Vec3;
using standoff::bench::Workload;

/// The mesh in the form that is fastest for meshToVolume: index space, single precision. Made before the timing.
struct IndexMesh {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;

  explicit IndexMesh(const Workload& work) {
    points.reserve(work.mesh.vertices.size());
    for (Vec3 v : work.mesh.vertices) {
      const Vec3 p = (v - work.grid.origin) / work.grid.spacing;
      points.emplace_back(static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z));
    }
    triangles.reserve(work.mesh.triangles.size());
    for (const auto& t : work.mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  }
};

std::vector<float> to_dense(const openvdb::FloatGrid& field, const Workload& work) {
  const auto& n = work.grid.size;
  std::vector<float> values(static_cast<std::size_t>(n.count()));
  const openvdb::CoordBBox box({0, 0, 0}, {int(n.x) - 1, int(n.y) - 1, int(n.z) - 1});
  openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ> dense(box, values.data());
  openvdb::tools::copyToDense(field, dense);
  return values;
}

/// All samples of the grid.
openvdb::MaskGrid whole_box(const Workload& work, const openvdb::math::Transform& transform) {
  const auto& n = work.grid.size;
  openvdb::MaskGrid mask;
  mask.setTransform(transform.copy());
  mask.tree().denseFill({{0, 0, 0}, {int(n.x) - 1, int(n.y) - 1, int(n.z) - 1}}, true, true);
  return mask;
}

/// The level set's half-width before a sweep, in samples: OpenVDB's usual one.
constexpr float kSweptWidth = 3;

nlohmann::json run(const Workload& work, bool is_signed, bool sweep) {
  const Vec3 h = work.grid.spacing;
  if (h.x != h.y || h.x != h.z) throw std::runtime_error("OpenVDB needs the same spacing on all axes");
  if (work.full() && !sweep) throw std::runtime_error("OpenVDB needs a thickness");
  tbb::global_control limit(tbb::global_control::max_allowed_parallelism, work.threads);
  openvdb::initialize();

  const IndexMesh mesh(work);
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> adapter(mesh.points, mesh.triangles);
  const auto transform = openvdb::math::Transform::createLinearTransform(h.x);
  transform->postTranslate({work.grid.origin.x, work.grid.origin.y, work.grid.origin.z});
  const float width = sweep ? kSweptWidth : static_cast<float>(work.thickness / h.x);

  standoff::bench::Measured measured;
  const auto field = standoff::bench::measure(
      work.repeats, measured,
      [&] {
        const auto band = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
            adapter, *transform, width, width, is_signed || sweep ? 0 : openvdb::tools::UNSIGNED_DISTANCE_FIELD);
        return sweep ? openvdb::tools::maskSdf(*band, whole_box(work, *transform)) : band;
      },
      work.enough);

  nlohmann::json line = work.describe();
  line["driver"] = sweep ? "openvdb_sweep" : "openvdb";
  line["version"] = OPENVDB_LIBRARY_VERSION_STRING;
  line["output"] = "sparse";
  line["output_bytes"] = field->memUsage();
  measured.write(line);
  if (!work.values.empty()) standoff::bench::save_values(work, to_dense(*field, work));
  if (!work.check) return line;
  std::vector<float> magnitudes = to_dense(*field, work);
  for (float& value : magnitudes) value = std::abs(value);
  line["check"] = standoff::bench::compare_with_exact(work, magnitudes);
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("OpenVDB meshToVolume (unsigned, sparse) on a workload", "peer_openvdb");
  const standoff::bench::WorkloadOptions options(app);
  bool is_signed = false, sweep = false;
  app.add_flag("--signed", is_signed, "a level set: negative inside, by OpenVDB's flood from outside");
  app.add_flag("--sweep", sweep, "a level set of all samples, by fast sweeping from a thin one");
  return run_driver(app, options, argc, argv, [&](const Workload& work) { return run(work, is_signed, sweep); });
}
