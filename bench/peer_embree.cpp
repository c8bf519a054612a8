// SPDX-License-Identifier: Apache-2.0
// Embree's point query at the samples of a dense grid: exact, one walk of its tree per sample.
#include <tbb/blocked_range3d.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <limits>
#include <memory>

#include "compare.h"
#include "driver.h"
#include "embree_mesh.h"
#include "measure.h"
#include "workload.h"

namespace {

using namespace standoff::bench;

constexpr std::int64_t kBrick = 16;

/// Queries the samples of a brick along a snake, so that each sample is a step away from the one before it: the
/// triangle found there bounds the search. `thickness` bounds every search too.
class BrickWalk {
 public:
  BrickWalk(RTCScene scene, const FloatMesh& mesh, const standoff::Grid& grid, double thickness, float* out, bool cull)
      : scene_(scene),
        mesh_(mesh),
        grid_(grid),
        thickness_(static_cast<float>(thickness)),
        out_(out),
        cull_(cull && std::isfinite(thickness)) {
    rtcInitPointQueryContext(&context_);
  }

  void run(std::int64_t bx, std::int64_t by, std::int64_t bz) {
    const auto& n = grid_.size;
    const std::int64_t x0 = bx * kBrick, x1 = std::min(x0 + kBrick, n.x), y0 = by * kBrick,
                       y1 = std::min(y0 + kBrick, n.y), z0 = bz * kBrick, z1 = std::min(z0 + kBrick, n.z);
    known_ = kNothing;
    if (cull_ && out_of_reach({x0, y0, z0}, {x1, y1, z1})) return;
    bool left = true, down = true;
    for (std::int64_t k = z0; k < z1; ++k, down = !down) {
      for (std::int64_t row = y0; row < y1; ++row, left = !left) {
        const std::int64_t j = down ? row : y1 - 1 - (row - y0);
        for (std::int64_t column = x0; column < x1; ++column) {
          const std::int64_t i = left ? column : x1 - 1 - (column - x0);
          out_[grid_.index(i, j, k)] = query(grid_.position(i, j, k));
        }
      }
    }
  }

 private:
  static constexpr unsigned kNothing = std::numeric_limits<unsigned>::max();

  /// Whether a single query shows that no triangle is within the thickness of any sample of the brick.
  bool out_of_reach(standoff::Size3 first, standoff::Size3 end) {
    const standoff::Vec3 a = grid_.position(first.x, first.y, first.z);
    const standoff::Vec3 b = grid_.position(end.x - 1, end.y - 1, end.z - 1), center = 0.5 * (a + b);
    const Float3 p{float(center.x), float(center.y), float(center.z)};
    const float reach = (thickness_ + float(0.5 * length(b - a))) * 1.0001f;
    Search search{&mesh_, reach * reach, kNothing};
    RTCPointQuery query{p.x, p.y, p.z, 0, reach};
    rtcPointQuery(scene_, &query, &context_, visit, &search);
    if (search.triangle != kNothing) return false;
    for (std::int64_t k = first.z; k < end.z; ++k)
      for (std::int64_t j = first.y; j < end.y; ++j)
        std::fill_n(out_ + grid_.index(first.x, j, k), end.x - first.x, thickness_);
    return true;
  }

  float query(standoff::Vec3 at) {
    const Float3 p{float(at.x), float(at.y), float(at.z)};
    Search search{&mesh_, thickness_ * thickness_, kNothing};
    if (known_ != kNothing) {
      const float distance_sq = mesh_.distance_sq(p, known_);
      if (distance_sq < search.distance_sq) search = {&mesh_, distance_sq, known_};
    }
    RTCPointQuery query{p.x, p.y, p.z, 0, std::sqrt(search.distance_sq)};
    rtcPointQuery(scene_, &query, &context_, visit, &search);
    known_ = search.triangle;
    return std::sqrt(search.distance_sq);
  }

  RTCScene scene_;
  const FloatMesh& mesh_;
  const standoff::Grid& grid_;
  float thickness_;
  float* out_;
  bool cull_;
  unsigned known_ = kNothing;
  RTCPointQueryContext context_;
};

void query_all(RTCScene scene, const FloatMesh& mesh, const Workload& work, float* out, bool cull) {
  const auto& n = work.grid.size;
  const auto bricks = [](std::int64_t count) { return (count + kBrick - 1) / kBrick; };
  tbb::parallel_for(tbb::blocked_range3d<std::int64_t>(0, bricks(n.z), 1, 0, bricks(n.y), 1, 0, bricks(n.x), 1),
                    [&](const auto& range) {
                      BrickWalk walk(scene, mesh, work.grid, work.thickness, out, cull);
                      for (auto z = range.pages().begin(); z < range.pages().end(); ++z)
                        for (auto y = range.rows().begin(); y < range.rows().end(); ++y)
                          for (auto x = range.cols().begin(); x < range.cols().end(); ++x) walk.run(x, y, z);
                    });
}

struct Settings {
  std::string quality = "medium";
  bool cull = true;
};

nlohmann::json run(const Workload& work, const Settings& settings) {
  const RTCBuildQuality quality = settings.quality == "low"    ? RTC_BUILD_QUALITY_LOW
                                  : settings.quality == "high" ? RTC_BUILD_QUALITY_HIGH
                                                               : RTC_BUILD_QUALITY_MEDIUM;
  tbb::global_control limit(tbb::global_control::max_allowed_parallelism, work.threads);
  const RTCDevice device = rtcNewDevice(("threads=" + std::to_string(work.threads) + ",set_affinity=0").c_str());
  const FloatMesh mesh(work.mesh);
  const auto samples = static_cast<std::size_t>(work.grid.sample_count());
  const std::unique_ptr<float[]> values(new float[samples]);  // untouched: the first call writes fresh memory

  std::vector<double> build_seconds;
  standoff::bench::Measured measured;
  standoff::bench::measure(
      work.repeats, measured,
      [&] {
        const auto start = std::chrono::steady_clock::now();
        const RTCScene scene = build(device, mesh, quality);
        build_seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        query_all(scene, mesh, work, values.get(), settings.cull);
        rtcReleaseScene(scene);
        return 0;
      },
      work.enough);
  rtcReleaseDevice(device);

  nlohmann::json line = work.describe();
  line["driver"] = "embree";
  line["version"] = RTC_VERSION_STRING;
  line["output"] = "dense";
  line["output_bytes"] = samples * sizeof(float);
  line["build_s"] = standoff::bench::median(build_seconds);
  measured.write(line);
  standoff::bench::save_values(work, {values.get(), samples});
  if (work.check) line["check"] = standoff::bench::compare_with_exact(work, {values.get(), samples});
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Embree's point query at every sample of a workload", "peer_embree");
  const standoff::bench::WorkloadOptions options(app);
  Settings settings;
  app.add_option("--quality", settings.quality, "of the tree: low, medium, high")
      ->check(CLI::IsMember({"low", "medium", "high"}));
  app.add_flag("!--every-sample", settings.cull,
               "bands: do not ask once per brick of samples whether anything is near");
  return run_driver(app, options, argc, argv, [&](const Workload& work) { return run(work, settings); });
}
