// SPDX-License-Identifier: Apache-2.0
// The cost of a sign: the same field without and with it, in turns, in one process.
#include <algorithm>
#include <map>
#include <random>

#include "driver.h"
#include "measure.h"
#include "scenes/scenes.h"
#include "standoff/compute.h"
#include "standoff/io.h"
#include "workload.h"

namespace {

using namespace standoff;
using bench::Workload;

struct Settings {
  SignMethod method = SignMethod::winding;
  double remove = 0;  ///< share of the triangles, chosen at random
  double cut = 0;     ///< share of the box's longest side, from its low end
  std::string save;   ///< the file for the damaged mesh, for other programs
  bool dense = false;
};

void damage(Mesh& mesh, const Settings& settings) {
  std::mt19937_64 random(1);
  const Box box = bounds(mesh);
  const Vec3 e = box.extent();
  const int axis = e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
  const auto along = [axis](const Vec3& v) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; };
  const double from = along(box.min) + settings.cut * along(e);
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    const bool removed = static_cast<double>(random() >> 11) * 0x1p-53 < settings.remove;
    const Vec3 middle = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / Vec3{3, 3, 3};
    return removed || (settings.cut > 0 && along(middle) < from);
  });
}

class Job {
 public:
  Job(const Workload& work, const Mesh& mesh, const Settings& settings)
      : work_(work), mesh_(mesh), dense_(settings.dense) {
    plain_.sign = {SignMethod::none};
    plain_.execution = {.threads = work.threads, .backend = Backend::cpu};
    signed_ = plain_;
    signed_.sign.method = settings.method;
    if (dense_) values_.resize(static_cast<std::size_t>(work.grid.sample_count()));
  }

  ComputeReport run(bool with_sign) {
    const ComputeOptions& options = with_sign ? signed_ : plain_;
    if (dense_) return compute_into(mesh_, work_.grid, work_.thickness, std::span<float>(values_), options);
    return compute_into(mesh_, work_.grid, work_.thickness, field_, options);
  }

 private:
  const Workload& work_;
  const Mesh& mesh_;
  bool dense_;
  ComputeOptions plain_, signed_;
  DistanceField field_;
  std::vector<float> values_;
};

nlohmann::json run(const Workload& work, const Settings& settings) {
  Mesh mesh = work.mesh;
  damage(mesh, settings);
  if (!settings.save.empty()) write_mesh(settings.save, mesh);
  Job job(work, mesh, settings);
  bench::Measured plain, with_sign;
  ComputeReport report;
  std::vector<double> sign_seconds;
  bench::measure(1, plain, [&] { return job.run(false); });
  bench::measure(1, with_sign, [&] { return report = job.run(true); });
  for (int n = 0; n < work.repeats; ++n)
    for (bench::Measured* one : {&plain, &with_sign}) {
      const auto start = std::chrono::steady_clock::now();
      const ComputeReport now = job.run(one == &with_sign);
      one->warm.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
      if (one == &with_sign) sign_seconds.push_back(now.seconds.sign);
    }
  nlohmann::json line = work.describe();
  line["triangles"] = mesh.triangles.size();
  line["method"] = name_of(report.sign.method);
  line["boundary_edges"] = report.sign.boundary_edges;
  line["unsigned_s"] = bench::median(plain.warm);
  line["signed_s"] = bench::median(with_sign.warm);
  line["sign_s"] = bench::median(sign_seconds);
  line["memory_unsigned"] = plain.bytes_peak;
  line["memory_signed"] = with_sign.bytes_peak;
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("what a sign adds to a field", "bench_sign");
  const bench::WorkloadOptions options(app);
  Settings settings;
  std::map<std::string, SignMethod> methods;
  for (const SignMethodInfo& info : kSignMethods)
    if (info.method != SignMethod::none && info.method != SignMethod::shell) methods[info.name] = info.method;
  app.add_option("--sign", settings.method, "method")->transform(CLI::CheckedTransformer(methods));
  app.add_option("--remove", settings.remove, "remove this share of the triangles, at random");
  app.add_option("--cut", settings.cut, "remove the triangles of this share of the longest side");
  app.add_option("--save", settings.save, "write the damaged mesh to this file");
  app.add_flag("--dense", settings.dense, "into dense memory");
  return run_driver(app, options, argc, argv, [&](const Workload& work) { return run(work, settings); });
}
