// SPDX-License-Identifier: Apache-2.0
// Embree's point query at the samples of a dense grid: exact, one walk of its tree per sample.
#include <embree3/rtcore.h>
#include <tbb/blocked_range3d.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <limits>
#include <memory>

#include "compare.h"
#include "measure.h"
#include "workload.h"

namespace {

using standoff::bench::Workload;

struct Float3 {
  float x, y, z;
};
inline Float3 operator+(Float3 a, Float3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Float3 operator-(Float3 a, Float3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Float3 operator*(float s, Float3 a) { return {s * a.x, s * a.y, s * a.z}; }
inline float dot(Float3 a, Float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// Squared distance of p to triangle abc by Voronoi regions (Ericson, Real-Time Collision Detection, 5.1.5).
inline float triangle_distance_sq(Float3 p, Float3 a, Float3 b, Float3 c) {
  const Float3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const auto to = [&](Float3 q) { return dot(p - q, p - q); };
  const float d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return to(a);
  const float d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return to(b);
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return to(a + (d1 / (d1 - d3)) * ab);
  const float d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return to(c);
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return to(a + (d2 / (d2 - d6)) * ac);
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return to(b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b));
  const float scale = 1 / (va + vb + vc);
  return to(a + (vb * scale) * ab + (vc * scale) * ac);
}

/// The mesh in single precision. Made before the timing.
struct FloatMesh {
  std::vector<Float3> vertices;
  std::vector<standoff::Triangle> triangles;

  explicit FloatMesh(const Workload& work) : triangles(work.mesh.triangles) {
    vertices.reserve(work.mesh.vertices.size() + 1);
    for (standoff::Vec3 v : work.mesh.vertices) vertices.push_back({float(v.x), float(v.y), float(v.z)});
    vertices.push_back({0, 0, 0});  // Embree reads 16 bytes at the last vertex.
  }
  float distance_sq(Float3 p, unsigned triangle) const {
    const auto& t = triangles[triangle];
    return triangle_distance_sq(p, vertices[t[0]], vertices[t[1]], vertices[t[2]]);
  }
};

struct Search {
  const FloatMesh* mesh;
  float distance_sq;
  unsigned triangle;
};

bool visit(RTCPointQueryFunctionArguments* arguments) {
  auto& search = *static_cast<Search*>(arguments->userPtr);
  RTCPointQuery& query = *arguments->query;
  const float distance_sq = search.mesh->distance_sq({query.x, query.y, query.z}, arguments->primID);
  if (distance_sq >= search.distance_sq) return false;
  search.distance_sq = distance_sq;
  search.triangle = arguments->primID;
  query.radius = std::sqrt(distance_sq);
  return true;
}

RTCScene build(RTCDevice device, const FloatMesh& mesh, RTCBuildQuality quality) {
  const RTCScene scene = rtcNewScene(device);
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.vertices.data(), 0,
                             sizeof(Float3), mesh.vertices.size() - 1);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                             sizeof(standoff::Triangle), mesh.triangles.size());
  rtcSetGeometryBuildQuality(geometry, quality);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcSetSceneBuildQuality(scene, quality);
  rtcCommitScene(scene);
  return scene;
}

constexpr std::int64_t kBrick = 16;

/// Queries the samples of one brick in a snake, so that each sample is one step away from the one before it: its
/// nearest triangle is no further than the triangle found there. `thickness` bounds every search.
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

  /// One query for the whole brick: nothing within the thickness of any of its samples? Then it is all thickness.
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
  const FloatMesh mesh(work);
  const auto samples = static_cast<std::size_t>(work.grid.sample_count());
  const std::unique_ptr<float[]> values(new float[samples]);  // untouched: the first call writes fresh memory

  std::vector<double> build_seconds;
  standoff::bench::Measured measured;
  standoff::bench::measure(work.repeats, measured, [&] {
    const auto start = std::chrono::steady_clock::now();
    const RTCScene scene = build(device, mesh, quality);
    build_seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    query_all(scene, mesh, work, values.get(), settings.cull);
    rtcReleaseScene(scene);
    return 0;
  });
  rtcReleaseDevice(device);

  nlohmann::json line = work.describe();
  line["driver"] = "embree";
  line["version"] = RTC_VERSION_STRING;
  line["output"] = "dense";
  line["output_bytes"] = samples * sizeof(float);
  line["build_s"] = standoff::bench::median(build_seconds);
  measured.write(line);
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
