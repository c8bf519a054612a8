// SPDX-License-Identifier: Apache-2.0
// Embree's point query at single points, in three forms: in the given order, in Morton order, and in Morton order with
// each search bounded by the triangle that was nearest to the point before.
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include "driver.h"
#include "embree_mesh.h"
#include "measure.h"
#include "point_workload.h"

namespace {

using namespace standoff::bench;
using standoff::Vec3;

constexpr unsigned kNothing = std::numeric_limits<unsigned>::max();

std::uint64_t spread(std::uint64_t bits) {
  bits &= 0x1fffff;
  bits = (bits | bits << 32) & 0x1f00000000ffff;
  bits = (bits | bits << 16) & 0x1f0000ff0000ff;
  bits = (bits | bits << 8) & 0x100f00f00f00f00f;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
  return (bits | bits << 2) & 0x1249249249249249;
}

/// The points' order along the Morton curve through their box.
std::vector<std::uint32_t> morton_order(const std::vector<Float3>& points) {
  Float3 low = points.front(), high = low;
  for (Float3 p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const float widest = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  const float scale = widest > 0 ? 1048575.f / widest : 0;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(points.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t n) {
    const Float3 p = scale * (points[n] - low);
    keys[n] = {spread(static_cast<std::uint64_t>(p.x)) | spread(static_cast<std::uint64_t>(p.y)) << 1 |
                   spread(static_cast<std::uint64_t>(p.z)) << 2,
               static_cast<std::uint32_t>(n)};
  });
  tbb::parallel_sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order(points.size());
  for (std::size_t n = 0; n < order.size(); ++n) order[n] = keys[n].second;
  return order;
}

/// Queries all points, in the order of `order` or as they come; `bounded`: each search begins with the triangle of the
/// point before.
void query_all(RTCScene scene, const FloatMesh& mesh, const std::vector<Float3>& points,
               const std::vector<std::uint32_t>* order, bool bounded, std::vector<float>& out) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 256), [&](const auto& range) {
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    unsigned known = kNothing;
    for (std::size_t n = range.begin(); n < range.end(); ++n) {
      const std::size_t at = order ? (*order)[n] : n;
      const Float3 p = points[at];
      Search search{&mesh, std::numeric_limits<float>::infinity(), kNothing};
      if (bounded && known != kNothing) search = {&mesh, mesh.distance_sq(p, known), known};
      RTCPointQuery query{p.x, p.y, p.z, 0, std::sqrt(search.distance_sq)};
      rtcPointQuery(scene, &query, &context, visit, &search);
      known = search.triangle;
      out[at] = std::sqrt(search.distance_sq);
    }
  });
}

struct Settings {
  std::string quality = "medium";
  std::vector<std::string> forms{"given", "morton", "bounded"};
};

nlohmann::json run(const PointWorkload& work, const Settings& settings) {
  const RTCBuildQuality quality = settings.quality == "low"    ? RTC_BUILD_QUALITY_LOW
                                  : settings.quality == "high" ? RTC_BUILD_QUALITY_HIGH
                                                               : RTC_BUILD_QUALITY_MEDIUM;
  tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(work.threads));
  const RTCDevice device = rtcNewDevice(("threads=" + std::to_string(work.threads) + ",set_affinity=0").c_str());
  const FloatMesh mesh(work.mesh);
  std::vector<Float3> points;
  for (Vec3 p : work.points) points.push_back({float(p.x), float(p.y), float(p.z)});
  std::vector<float> out(points.size());

  nlohmann::json line = work.describe();
  line["driver"] = "embree";
  line["version"] = RTC_VERSION_STRING;
  RTCScene scene = nullptr;
  measure_calls(work.repeats, "build", line, [&] {
    if (scene) rtcReleaseScene(scene);
    scene = build(device, mesh, quality);
  });
  std::vector<std::uint32_t> order;
  measure_calls(work.repeats, "sort", line, [&] { order = morton_order(points); });
  for (const std::string& form : settings.forms)
    measure_calls(work.repeats, form, line,
                  [&] { query_all(scene, mesh, points, form == "given" ? nullptr : &order, form == "bounded", out); });
  rtcReleaseScene(scene);
  rtcReleaseDevice(device);
  work.save_answers(std::vector<double>(out.begin(), out.end()));
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Embree's point query at many points", "peer_embree_points");
  const PointOptions options(app);
  Settings settings;
  app.add_option("--quality", settings.quality, "of the tree: low, medium, high")
      ->check(CLI::IsMember({"low", "medium", "high"}));
  app.add_option("--forms", settings.forms,
                 "given: points as they come; morton; bounded: Morton with a bound on each search")
      ->delimiter(',')
      ->check(CLI::IsMember({"given", "morton", "bounded"}));
  return run_driver(app, options, argc, argv, [&](const PointWorkload& work) { return run(work, settings); });
}
