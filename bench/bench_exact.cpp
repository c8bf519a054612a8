// SPDX-License-Identifier: Apache-2.0
// Distances and sides of a mesh in double precision, by code that standoff's methods share nothing with. With --truth,
// those of some samples: what `script/bench methods` compares all methods with. Otherwise brute force as a method:
// every sample with every triangle.
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <random>

#include "compare.h"
#include "driver.h"
#include "measure.h"
#include "raw.h"
#include "workload.h"

namespace {

using standoff::Box;
using standoff::Vec3;
using standoff::bench::Workload;

struct Corners {
  Vec3 a, b, c;
};

double squared(Vec3 v) { return dot(v, v); }

double segment_distance_sq(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 along = b - a;
  const double length_sq = squared(along);
  const double t = length_sq > 0 ? std::clamp(dot(p - a, along) / length_sq, 0.0, 1.0) : 0;
  return squared(p - (a + t * along));
}

/// From the edges, and from the plane where p is above the inside.
double distance_sq(Vec3 p, const Corners& t) {
  double least =
      std::min({segment_distance_sq(p, t.a, t.b), segment_distance_sq(p, t.b, t.c), segment_distance_sq(p, t.c, t.a)});
  const Vec3 normal = cross(t.b - t.a, t.c - t.a);
  const double square = squared(normal);
  if (square > 0 && dot(cross(t.b - t.a, p - t.a), normal) >= 0 && dot(cross(t.c - t.b, p - t.b), normal) >= 0 &&
      dot(cross(t.a - t.c, p - t.c), normal) >= 0) {
    const double above = dot(p - t.a, normal);
    least = std::min(least, above * above / square);
  }
  return least;
}

std::vector<Corners> corners_of(const standoff::Mesh& mesh) {
  std::vector<Corners> all;
  all.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) all.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
  return all;
}

// ---- Truth ----

double box_distance_sq(Vec3 p, const Box& box) {
  const auto off = [](double x, double low, double high) { return std::max({low - x, x - high, 0.0}); };
  return squared({off(p.x, box.min.x, box.max.x), off(p.y, box.min.y, box.max.y), off(p.z, box.min.z, box.max.z)});
}

/// A binary tree of boxes over the triangles, halved at the median.
class Tree {
 public:
  explicit Tree(std::vector<Corners> triangles) : triangles_(std::move(triangles)) {
    nodes_.reserve(triangles_.size());
    split(0, triangles_.size());
  }

  double distance_sq(Vec3 p) const {
    double best = std::numeric_limits<double>::infinity();
    nearest(0, p, best);
    return best;
  }

  /// The winding number: the sum of the signed crossings of a ray from p. Nothing if the ray comes so close to an edge
  /// that rounding may decide on which side it passes.
  std::optional<int> crossings(Vec3 p, Vec3 direction) const {
    int sum = 0;
    return cross_node(0, p, direction, sum) ? std::optional(sum) : std::nullopt;
  }

 private:
  static constexpr std::size_t kLeaf = 8;
  struct Node {
    Box box;
    std::size_t begin, end;  ///< triangles
    std::size_t right;       ///< the second child; the first follows its parent; 0: a leaf
  };

  void split(std::size_t begin, std::size_t end) {
    const std::size_t self = nodes_.size();
    Box box = standoff::Box{triangles_[begin].a, triangles_[begin].a};
    const auto grow = [&](Vec3 v) {
      box.min = {std::min(box.min.x, v.x), std::min(box.min.y, v.y), std::min(box.min.z, v.z)};
      box.max = {std::max(box.max.x, v.x), std::max(box.max.y, v.y), std::max(box.max.z, v.z)};
    };
    for (std::size_t n = begin; n < end; ++n)
      for (Vec3 v : {triangles_[n].a, triangles_[n].b, triangles_[n].c}) grow(v);
    nodes_.push_back({box, begin, end, 0});
    if (end - begin <= kLeaf) return;
    const Vec3 e = box.extent();
    const auto key = [&](const Corners& t) {
      const Vec3 sum = t.a + t.b + t.c;
      return e.x >= e.y && e.x >= e.z ? sum.x : e.y >= e.z ? sum.y : sum.z;
    };
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t n) { return triangles_.begin() + static_cast<std::ptrdiff_t>(n); };
    std::nth_element(at(begin), at(middle), at(end), [&](const auto& a, const auto& b) { return key(a) < key(b); });
    split(begin, middle);
    nodes_[self].right = nodes_.size();
    split(middle, end);
  }

  void nearest(std::size_t index, Vec3 p, double& best) const {
    const Node& node = nodes_[index];
    if (!node.right) {
      for (std::size_t n = node.begin; n < node.end; ++n) best = std::min(best, ::distance_sq(p, triangles_[n]));
      return;
    }
    std::array<std::size_t, 2> children{index + 1, node.right};
    std::array<double, 2> off{box_distance_sq(p, nodes_[children[0]].box), box_distance_sq(p, nodes_[children[1]].box)};
    if (off[1] < off[0]) std::swap(children[0], children[1]), std::swap(off[0], off[1]);
    // The margin is far above the rounding of either distance.
    for (int n = 0; n < 2; ++n)
      if (off[n] * (1 - 1e-12) <= best) nearest(children[n], p, best);
  }

  static bool meets(Vec3 p, Vec3 u, const Box& box) {
    double from = 0, to = std::numeric_limits<double>::infinity();
    const auto clip = [&](double x, double d, double low, double high) {
      const double margin = 1e-9 * (high - low + std::abs(low) + std::abs(high));
      const double one = (low - margin - x) / d, two = (high + margin - x) / d;  // no component of u is 0
      from = std::max(from, std::min(one, two));
      to = std::min(to, std::max(one, two));
    };
    clip(p.x, u.x, box.min.x, box.max.x);
    clip(p.y, u.y, box.min.y, box.max.y);
    clip(p.z, u.z, box.min.z, box.max.z);
    return from <= to;
  }

  bool cross_node(std::size_t index, Vec3 p, Vec3 u, int& sum) const {
    const Node& node = nodes_[index];
    if (!meets(p, u, node.box)) return true;
    if (node.right) return cross_node(index + 1, p, u, sum) && cross_node(node.right, p, u, sum);
    for (std::size_t n = node.begin; n < node.end; ++n)
      if (!cross_triangle(triangles_[n], p, u, sum)) return false;
    return true;
  }

  static bool cross_triangle(const Corners& t, Vec3 p, Vec3 u, int& sum) {
    const Vec3 a = t.a - p, b = t.b - p, c = t.c - p;
    const double sides[] = {dot(u, cross(a, b)), dot(u, cross(b, c)), dot(u, cross(c, a))};
    const double doubt = 1e-12 * std::max({squared(a), squared(b), squared(c)});
    const bool left = sides[0] > -doubt && sides[1] > -doubt && sides[2] > -doubt;
    const bool right = sides[0] < doubt && sides[1] < doubt && sides[2] < doubt;
    if (!left && !right) return true;
    // Near an edge: which of two neighbours is crossed is rounding. Behind p that does not matter.
    const double along = std::max({dot(a, u), dot(b, u), dot(c, u)});
    if (along < 0) return true;
    if (std::abs(sides[0]) < doubt || std::abs(sides[1]) < doubt || std::abs(sides[2]) < doubt) return false;
    const Vec3 normal = cross(t.b - t.a, t.c - t.a);
    if (dot(normal, a) / dot(normal, u) <= 0) return true;
    sum += dot(normal, u) > 0 ? 1 : -1;
    return true;
  }

  std::vector<Corners> triangles_;
  std::vector<Node> nodes_;
};

constexpr std::int8_t kUnclear = 127;

/// The winding number on which two rays in unrelated directions agree.
std::int8_t winding_number(const Tree& tree, Vec3 p, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::optional<int> before;
  for (int tries = 0; tries < 6; ++tries) {
    Vec3 u{normal(random), normal(random), normal(random)};
    u = u * (1 / std::sqrt(squared(u)));
    const std::optional<int> found = tree.crossings(p, u);
    if (!found) continue;
    if (before) return *before == *found && std::abs(*found) < kUnclear ? static_cast<std::int8_t>(*found) : kUnclear;
    before = found;
  }
  return kUnclear;
}

/// Half of the samples anywhere, and half at most `reach` steps per axis from points that are even over the surface.
std::vector<std::int64_t> chosen_samples(const Workload& work, std::int64_t count, double reach) {
  std::mt19937_64 random(1);
  const auto corners = corners_of(work.mesh);
  std::vector<double> area(corners.size());
  for (std::size_t n = 0; n < corners.size(); ++n)
    area[n] = std::sqrt(squared(cross(corners[n].b - corners[n].a, corners[n].c - corners[n].a)));
  std::partial_sum(area.begin(), area.end(), area.begin());
  const auto draw = [&] { return std::uniform_real_distribution<double>()(random); };
  const auto& n = work.grid.size;
  const auto nearest = [&](double at, std::int64_t size) {
    return std::clamp<std::int64_t>(std::llround(at + reach * (2 * draw() - 1)), 0, size - 1);
  };
  std::vector<std::int64_t> samples;
  for (std::int64_t i = 0; i < count; ++i) {
    if (i % 2) {
      samples.push_back(static_cast<std::int64_t>(draw() * double(n.count())));
      continue;
    }
    const auto triangle =
        static_cast<std::size_t>(std::upper_bound(area.begin(), area.end() - 1, draw() * area.back()) - area.begin());
    const double s = std::sqrt(draw()), t = draw();
    const Corners& c = corners[triangle];
    const Vec3 p = (1 - s) * c.a + s * (1 - t) * c.b + s * t * c.c, at = (p - work.grid.origin) / work.grid.spacing;
    samples.push_back(work.grid.index(nearest(at.x, n.x), nearest(at.y, n.y), nearest(at.z, n.z)));
  }
  std::sort(samples.begin(), samples.end());
  samples.erase(std::unique(samples.begin(), samples.end()), samples.end());
  return samples;
}

/// Writes the mesh, the grid and the truth of some samples to a folder.
nlohmann::json tell_truth(const Workload& work, const std::filesystem::path& folder, std::int64_t count, double reach) {
  standoff::bench::save_mesh(folder, work.mesh);
  const auto& n = work.grid.size;
  const auto &o = work.grid.origin, &h = work.grid.spacing;
  nlohmann::json grid{{"shape", {n.x, n.y, n.z}},
                      {"origin", {o.x, o.y, o.z}},
                      {"spacing", {h.x, h.y, h.z}},
                      {"band", work.full() ? nlohmann::json() : nlohmann::json(work.thickness)}};
  std::ofstream(folder / "grid.json") << grid.dump();
  const Tree tree(corners_of(work.mesh));
  const auto samples = chosen_samples(work, count, reach);
  std::vector<double> distances(samples.size());
  std::vector<std::int8_t> windings(samples.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, samples.size(), 64), [&](const auto& range) {
    for (std::size_t s = range.begin(); s < range.end(); ++s) {
      const std::int64_t at = samples[s];
      const Vec3 p = work.grid.position(at % n.x, at / n.x % n.y, at / (n.x * n.y));
      std::mt19937_64 random(static_cast<std::uint64_t>(at));
      distances[s] = std::sqrt(tree.distance_sq(p));
      windings[s] = distances[s] > 1e-9 * length(o) ? winding_number(tree, p, random) : kUnclear;
    }
  });
  standoff::bench::write_raw(folder / "samples.i64", samples.data(), samples.size());
  standoff::bench::write_raw(folder / "distances.f64", distances.data(), distances.size());
  standoff::bench::write_raw(folder / "windings.i8", windings.data(), windings.size());
  nlohmann::json line = work.describe();
  line["checked"] = samples.size();
  return line;
}

// ---- Brute force ----

/// What is known of eight triangles before any sample, one number of all of them after the other: vector instructions
/// work on it as it lies. A place without a triangle is one that is infinitely far away.
struct Pack {
  enum { kLanes = 8, kStart = 0, kEdge = 9, kSide = 18, kInverse = 27, kNormal = 30, kFlat = 33, kCount = 34 };
  alignas(64) double of[kCount][kLanes] = {};

  Pack() {
    for (int lane = 0; lane < kLanes; ++lane) {
      of[kFlat][lane] = std::numeric_limits<double>::infinity();
      for (int n = 0; n < 9; ++n) of[kStart + n][lane] = 1e200;
    }
  }

  void put(int at, int lane, Vec3 v) { of[at][lane] = v.x, of[at + 1][lane] = v.y, of[at + 2][lane] = v.z; }

  void put(int lane, const Corners& t) {
    const Vec3 edges[] = {t.b - t.a, t.c - t.b, t.a - t.c}, starts[] = {t.a, t.b, t.c};
    const Vec3 normal = cross(edges[0], t.c - t.a);
    const double area_sq = squared(normal);
    for (int n = 0; n < 3; ++n) {
      const double length_sq = squared(edges[n]);
      put(kStart + 3 * n, lane, starts[n]);
      put(kEdge + 3 * n, lane, edges[n]);
      put(kSide + 3 * n, lane, cross(normal, edges[n]));
      of[kInverse + n][lane] = length_sq > 0 ? 1 / length_sq : 0;
    }
    if (area_sq > 0) put(kNormal, lane, normal * (1 / std::sqrt(area_sq))), of[kFlat][lane] = 0;
  }
};

/// The least of `least` and the squared distances of some packs.
__attribute__((target_clones("avx512f", "avx2", "default"))) double packs_distance_sq(const Pack* packs,
                                                                                      std::size_t count, Vec3 p,
                                                                                      double least) {
  double best[Pack::kLanes];
  std::fill(std::begin(best), std::end(best), least);
  for (const Pack* pack = packs; pack < packs + count; ++pack) {
    const auto& in = pack->of;
#pragma omp simd
    for (int t = 0; t < Pack::kLanes; ++t) {
      double edge_sq = std::numeric_limits<double>::infinity(), side = edge_sq;
      double x = 0, y = 0, z = 0;
      for (int n = 0; n < 3; ++n) {
        const int s = Pack::kStart + 3 * n, e = Pack::kEdge + 3 * n, o = Pack::kSide + 3 * n;
        x = p.x - in[s][t], y = p.y - in[s + 1][t], z = p.z - in[s + 2][t];
        double u = (x * in[e][t] + y * in[e + 1][t] + z * in[e + 2][t]) * in[Pack::kInverse + n][t];
        u = u < 0 ? 0 : u;
        u = u > 1 ? 1 : u;
        const double dx = x - u * in[e][t], dy = y - u * in[e + 1][t], dz = z - u * in[e + 2][t];
        const double sq = dx * dx + dy * dy + dz * dz;
        edge_sq = sq < edge_sq ? sq : edge_sq;
        const double inwards = x * in[o][t] + y * in[o + 1][t] + z * in[o + 2][t];
        side = inwards < side ? inwards : side;
      }
      const int m = Pack::kNormal;
      const double above = x * in[m][t] + y * in[m + 1][t] + z * in[m + 2][t];
      double plane_sq = above * above + in[Pack::kFlat][t];
      plane_sq = side < 0 ? edge_sq : plane_sq;
      const double sq = plane_sq < edge_sq ? plane_sq : edge_sq;
      best[t] = sq < best[t] ? sq : best[t];
    }
  }
  return *std::min_element(std::begin(best), std::end(best));
}

std::vector<Pack> packs_of(const std::vector<Corners>& triangles) {
  std::vector<Pack> packs((triangles.size() + Pack::kLanes - 1) / Pack::kLanes);
  for (std::size_t n = 0; n < triangles.size(); ++n)
    packs[n / Pack::kLanes].put(static_cast<int>(n % Pack::kLanes), triangles[n]);
  return packs;
}

/// Packs that stay in the processor's cache for a row of samples.
constexpr std::size_t kBlock = 16;

nlohmann::json brute_force(const Workload& work) {
  tbb::global_control limit(tbb::global_control::max_allowed_parallelism, work.threads);
  const auto& n = work.grid.size;
  const auto samples = static_cast<std::size_t>(n.count());
  const std::unique_ptr<float[]> values(new float[samples]);  // untouched: the first call writes fresh memory
  standoff::bench::Measured measured;
  const auto fill = [&] {
    const std::vector<Pack> packs = packs_of(corners_of(work.mesh));
    tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, n.z * n.y, 1), [&](const auto& rows) {
      std::vector<double> least(static_cast<std::size_t>(n.x));
      for (std::int64_t row = rows.begin(); row < rows.end(); ++row) {
        std::fill(least.begin(), least.end(), work.thickness * work.thickness);
        for (std::size_t begin = 0; begin < packs.size(); begin += kBlock)
          for (std::int64_t i = 0; i < n.x; ++i) {
            double& best = least[static_cast<std::size_t>(i)];
            const Vec3 p = work.grid.position(i, row % n.y, row / n.y);
            best = packs_distance_sq(&packs[begin], std::min(kBlock, packs.size() - begin), p, best);
          }
        for (std::int64_t i = 0; i < n.x; ++i)
          values[static_cast<std::size_t>(row * n.x + i)] =
              static_cast<float>(std::sqrt(least[static_cast<std::size_t>(i)]));
      }
    });
    return 0;
  };
  standoff::bench::measure(work.repeats, measured, fill, work.enough);
  nlohmann::json line = work.describe();
  line["driver"] = "brute force";
  line["output"] = "dense";
  measured.write(line);
  standoff::bench::save_values(work, {values.get(), samples});
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("distances in double precision by brute force, and the truth of some samples", "bench_exact");
  const standoff::bench::WorkloadOptions options(app);
  std::string truth;
  std::int64_t count = 20000;
  double reach = 4;
  app.add_option("--truth", truth, "write mesh, grid, samples, distances and winding numbers to this folder");
  app.add_option("--count", count, "of the samples");
  app.add_option("--reach", reach, "half of the samples are at most so many steps from the surface");
  return run_driver(app, options, argc, argv, [&](const Workload& work) {
    return truth.empty() ? brute_force(work) : tell_truth(work, truth, count, reach);
  });
}
