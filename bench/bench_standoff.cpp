// SPDX-License-Identifier: Apache-2.0
// standoff's compute_into on a workload, through the public API.
#include <map>
#include <memory>

#include "compare.h"
#include "driver.h"
#include "measure.h"
#include "standoff/version.h"
#include "workload.h"

namespace {

using namespace standoff;
using bench::Workload;

/// The output of compute_into.
enum class Output {
  sparse,  ///< compute_into: the same field for each call, empty before the first
  dense,   ///< compute_into: the same memory for each call, untouched before the first
};

struct Settings {
  Output output = Output::sparse;
  Method method = Method::tiles;
  SignMethod sign = SignMethod::none;
  SkipRule skip;
  Simd simd = Simd::automatic;
};

class Job {
 public:
  Job(const Workload& work, const Settings& settings) : work_(work), output_(settings.output) {
    options_.method = settings.method;
    options_.sign = {settings.sign};
    options_.skip = settings.skip;
    options_.execution.threads = work.threads;
    options_.execution.simd = settings.simd;
    if (output_ == Output::dense) buffer_.reset(new float[samples()]);
  }

  ComputeReport operator()() {
    if (output_ == Output::sparse) return compute_into(work_.mesh, work_.grid, work_.thickness, field_, options_);
    return compute_into(work_.mesh, work_.grid, work_.thickness, values(), options_);
  }

  std::vector<float> to_dense() const {
    if (output_ == Output::sparse) return field_.to_dense();
    return {values().begin(), values().end()};
  }

  std::int64_t output_bytes() const {
    return output_ == Output::sparse ? field_.memory_bytes() : static_cast<std::int64_t>(values().size_bytes());
  }

 private:
  std::size_t samples() const { return static_cast<std::size_t>(work_.grid.sample_count()); }
  std::span<float> values() const { return {buffer_.get(), samples()}; }

  const Workload& work_;
  Output output_;
  ComputeOptions options_;
  DistanceField field_;
  std::unique_ptr<float[]> buffer_;
};

nlohmann::json run(const Workload& work, const Settings& settings) {
  Job job(work, settings);
  bench::Measured measured;
  const ComputeReport report = bench::measure(
      work.repeats, measured, [&] { return job(); }, work.enough);

  nlohmann::json line = work.describe();
  line["driver"] = "standoff";
  line["version"] = version();
  line["method"] = report.method;
  line["device"] = report.device;
  line["output"] = settings.output == Output::sparse ? "sparse" : "dense";
  line["output_bytes"] = job.output_bytes();
  line["mesh_bytes"] = work.mesh.vertices.size() * sizeof(Vec3) + work.mesh.triangles.size() * sizeof(Triangle);
  line["sign"] = name_of(report.sign.method);
  line["skipped"] = report.skipped;
  line["samples_examined"] = report.samples_examined;
  line["samples_band"] = report.samples_band;
  line["prepare_s"] = report.seconds.prepare;
  line["compute_s"] = report.seconds.compute;
  measured.write(line);
  if (!work.values.empty()) bench::save_values(work, job.to_dense());
  if (work.check) line["check"] = bench::compare_with_exact(work, job.to_dense());
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("standoff's compute on a workload", "bench_standoff");
  const bench::WorkloadOptions options(app);
  Settings settings;
  std::map<std::string, Method> methods;
  for (const MethodInfo& info : kComputeMethods) methods[info.name] = info.method;
  std::map<std::string, SignMethod> signs;
  for (const SignMethodInfo& info : kSignMethods)
    if (info.method != SignMethod::shell) signs[info.name] = info.method;
  const std::map<std::string, Simd> simds{
      {"automatic", Simd::automatic}, {"portable", Simd::portable}, {"avx2", Simd::avx2}, {"avx512", Simd::avx512}};
  const std::map<std::string, Output> outputs{{"sparse", Output::sparse}, {"dense", Output::dense}};
  const std::map<std::string, SkipRule::Kind> skips{{"automatic", SkipRule::Kind::automatic},
                                                    {"none", SkipRule::Kind::none},
                                                    {"neighbour", SkipRule::Kind::neighbour},
                                                    {"exact", SkipRule::Kind::exact}};
  app.add_option("--output", settings.output, "sparse or dense, into the same memory at each call")
      ->transform(CLI::CheckedTransformer(outputs));
  app.add_option("--skip", settings.skip.kind, "skip rule")->transform(CLI::CheckedTransformer(skips));
  app.add_option("--method", settings.method, "of standoff/compute.h")->transform(CLI::CheckedTransformer(methods));
  app.add_option("--sign", settings.sign, "of standoff/sign.h (default: none)")
      ->transform(CLI::CheckedTransformer(signs));
  app.add_option("--simd", settings.simd, "instruction set")->transform(CLI::CheckedTransformer(simds));
  return run_driver(app, options, argc, argv, [&](const Workload& work) { return run(work, settings); });
}
