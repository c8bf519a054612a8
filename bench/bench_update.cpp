// SPDX-License-Identifier: Apache-2.0
// An update of a field after a part of its mesh moved, by passes over the mesh and by a LiveField, beside computing the
// field anew: seconds of all, taken by turns in one process.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "driver.h"
#include "measure.h"
#include "signed_field.h"
#include "standoff/update.h"
#include "workload.h"

namespace {

using namespace standoff;
using bench::Workload;

// The triangles nearest to the first vertex's place, a share of all, moved outwards by a bump of this height.
Mesh moved(const Mesh& mesh, double share, double height) {
  const Vec3 at = mesh.vertices[mesh.triangles[mesh.triangles.size() / 3][0]];
  std::vector<double> away(mesh.triangles.size());
  for (std::size_t t = 0; t < away.size(); ++t) {
    away[t] = 0;
    for (const std::uint32_t v : mesh.triangles[t]) away[t] = std::max(away[t], length(mesh.vertices[v] - at));
  }
  const auto nth = away.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(away.size()));
  std::nth_element(away.begin(), nth, away.end());
  const double radius = *nth;
  Mesh after = mesh;
  for (Vec3& v : after.vertices) {
    const double near = 1 - length(v - at) / radius;
    if (near > 0) v = v + Vec3{0.3, 0.5, 0.8} * (height * near);
  }
  return after;
}

bool same(const DistanceField& a, const DistanceField& b) {
  const std::vector<float> one = a.to_dense(), other = b.to_dense();
  return std::equal(one.begin(), one.end(), other.begin(), other.end(), [](float x, float y) {
    return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y);
  });
}

nlohmann::json run(const Workload& work, double share, double height, const std::string& sign) {
  nlohmann::json line = work.describe();
  line["driver"] = "standoff";
  ComputeOptions options = bench::signed_options(work);
  if (sign == "none") options.sign.method = SignMethod::none;
  options.sign.as_oriented = sign == "as-oriented";
  const Mesh other = moved(work.mesh, share, height * work.grid.max_spacing());
  const Mesh* meshes[] = {&work.mesh, &other};
  std::vector<double> anew, update, find, live_move, read, anew_cpu, update_cpu, live_cpu;
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t v = 0; v < other.vertices.size(); ++v)
    if (!(other.vertices[v] == work.mesh.vertices[v])) vertices.push_back(v);
  const bench::Clock make_clock;
  LiveField live(work.mesh, work.grid, work.thickness, options);
  line["make_live_s"] = make_clock.wall();
  DistanceField whole, field = compute(work.mesh, work.grid, work.thickness, options).field;
  compute_into(work.mesh, work.grid, work.thickness, whole, options);
  UpdateReport report, live_report;
  for (int turn = 0; turn < work.repeats; ++turn) {
    const Mesh &before = *meshes[turn % 2], &after = *meshes[(turn + 1) % 2];
    const bench::Clock compute_clock;
    compute_into(after, work.grid, work.thickness, whole, options);
    anew.push_back(compute_clock.wall());
    anew_cpu.push_back(compute_clock.processor());
    const bench::Clock find_clock;
    const std::vector<std::uint32_t> changed = changed_triangles(before, after);
    find.push_back(find_clock.wall());
    const bench::Clock update_clock;
    report = update_field(before, after, changed, field, options);
    update.push_back(update_clock.wall());
    update_cpu.push_back(update_clock.processor());
    std::vector<Vec3> positions;
    for (const std::uint32_t v : vertices) positions.push_back(after.vertices[v]);
    const bench::Clock move_clock;
    live_report = live.move(vertices, positions);
    live_move.push_back(move_clock.wall());
    live_cpu.push_back(move_clock.processor());
    const bench::Clock read_clock;
    live.field();
    read.push_back(read_clock.wall());
  }
  if (!same(field, whole) || !same(live.field(), whole))
    throw Error(ErrorCode::internal, "update: the updated field differs from the field anew");
  line["anew_s"] = bench::median(anew);
  line["update_s"] = bench::median(update);
  line["anew_cpu_s"] = bench::median(anew_cpu);
  line["update_cpu_s"] = bench::median(update_cpu);
  line["live_s"] = bench::median(live_move);
  line["live_cpu_s"] = bench::median(live_cpu);
  line["field_s"] = bench::median(read);
  line["live_tiles_computed"] = live_report.tiles_computed;
  line["live_seconds"] = {live_report.seconds.prepare, live_report.seconds.compute, live_report.seconds.sign,
                          live_report.seconds.merge};
  line["find_s"] = bench::median(find);
  line["changed"] = report.triangles_changed;
  line["windows"] = report.windows;
  line["tiles_computed"] = report.tiles_computed;
  line["tiles_changed"] = report.tiles_changed;
  line["why_anew"] = report.why;
  line["seconds"] = {report.seconds.prepare, report.seconds.compute, report.seconds.sign, report.seconds.merge};
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("an update of a field beside computing it anew", "bench_update");
  const bench::WorkloadOptions options(app);
  double share = 0.01, height = 3;
  std::string sign = "none";
  app.add_option("--share", share, "of the triangles, which move")->check(CLI::Range(0.0, 1.0));
  app.add_option("--height", height, "of the bump, in samples");
  app.add_option("--sign", sign, "by the winding number, of the mesh as it is oriented or not, or none")
      ->check(CLI::IsMember({"none", "winding", "as-oriented"}));
  return run_driver(app, options, argc, argv, [&](const Workload& work) { return run(work, share, height, sign); });
}
