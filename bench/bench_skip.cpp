// SPDX-License-Identifier: Apache-2.0
// Skip rules before the thesis's Algorithm 1: what each drops, what it costs, how far the field is off. The rule `any`
// is not in the library: it drops a triangle whose grown box lies inside that of any other one, as the thesis wished.
#include <algorithm>
#include <limits>
#include <numeric>

#include "compare.h"
#include "driver.h"
#include "measure.h"
#include "workload.h"

namespace {

using namespace standoff;
using bench::Workload;

Box around(const Box& a, const Box& b) {
  return {{std::min(a.min.x, b.min.x), std::min(a.min.y, b.min.y), std::min(a.min.z, b.min.z)},
          {std::max(a.max.x, b.max.x), std::max(a.max.y, b.max.y), std::max(a.max.z, b.max.z)}};
}

bool inside(const Box& inner, const Box& outer) {
  return outer.min.x <= inner.min.x && outer.min.y <= inner.min.y && outer.min.z <= inner.min.z &&
         inner.max.x <= outer.max.x && inner.max.y <= outer.max.y && inner.max.z <= outer.max.z;
}

/// The triangles' boxes in a binary tree. They are not grown: grown boxes are nested exactly when these are.
class NestedBoxes {
 public:
  explicit NestedBoxes(MeshView mesh) : order_(mesh.triangles.size()) {
    for (std::size_t t = 0; t < order_.size(); ++t) {
      const auto [a, b, c] = mesh.corners(t);
      boxes_.push_back(around(around({a, a}, {b, b}), {c, c}));
    }
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::size_t leaves = 1;
    while (leaves * kLeaf < order_.size()) leaves *= 2;
    nodes_.resize(2 * leaves);
    build(1, 0, order_.size());
  }

  /// Whether the box lies inside another triangle's. Of equal boxes the first stays, so what stays does not depend on
  /// the order in which triangles are looked at.
  bool is_nested(std::size_t triangle) const { return find(1, 0, order_.size(), triangle); }

 private:
  static constexpr std::size_t kLeaf = 8;

  bool is_leaf(std::size_t node) const { return 2 * node >= nodes_.size(); }

  void build(std::size_t node, std::size_t begin, std::size_t end) {
    constexpr double kMost = std::numeric_limits<double>::infinity();
    nodes_[node] = {{kMost, kMost, kMost}, {-kMost, -kMost, -kMost}};
    for (std::size_t n = begin; n < end; ++n) nodes_[node] = around(nodes_[node], boxes_[order_[n]]);
    if (is_leaf(node)) return;
    const Vec3 size = nodes_[node].extent();
    const auto middle = begin + (end - begin) / 2;
    const auto halve = [&](double Vec3::*axis) {
      std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](auto a, auto b) {
        return boxes_[a].min.*axis + boxes_[a].max.*axis < boxes_[b].min.*axis + boxes_[b].max.*axis;
      });
    };
    halve(size.x >= size.y && size.x >= size.z ? &Vec3::x : size.y >= size.z ? &Vec3::y : &Vec3::z);
    build(2 * node, begin, middle);
    build(2 * node + 1, middle, end);
  }

  bool find(std::size_t node, std::size_t begin, std::size_t end, std::size_t triangle) const {
    const Box& box = boxes_[triangle];
    if (!inside(box, nodes_[node])) return false;
    if (!is_leaf(node)) {
      const auto middle = begin + (end - begin) / 2;
      return find(2 * node, begin, middle, triangle) || find(2 * node + 1, middle, end, triangle);
    }
    return std::any_of(order_.begin() + begin, order_.begin() + end, [&](std::size_t other) {
      return other != triangle && inside(box, boxes_[other]) && (other < triangle || !inside(boxes_[other], box));
    });
  }

  std::vector<Box> boxes_, nodes_;
  std::vector<std::size_t> order_;
};

std::vector<Triangle> kept_by_any(MeshView mesh) {
  const NestedBoxes boxes(mesh);
  std::vector<Triangle> kept;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (!boxes.is_nested(t)) kept.push_back(mesh.triangles[t]);
  return kept;
}

nlohmann::json measure(const Workload& work, const std::string& rule, SkipRule::Kind kind, Method method) {
  nlohmann::json line{{"method", method == Method::tiles ? "tiles" : "thesis"}, {"rule", rule}};
  ComputeOptions options{
      .method = method, .skip = {.kind = kind}, .sign = {SignMethod::none}, .execution = {.threads = work.threads}};
  Workload kept = work;
  if (rule == "any")
    bench::measure_calls(work.repeats, "rule", line, [&] { kept.mesh.triangles = kept_by_any(work.mesh); });
  std::vector<float> values(static_cast<std::size_t>(work.grid.sample_count()));
  ComputeReport report;
  bench::measure_calls(work.repeats, "compute", line,
                       [&] { report = compute_into(kept.mesh, work.grid, work.thickness, values, options); });
  line["skipped"] = static_cast<std::int64_t>(work.mesh.triangles.size() - kept.mesh.triangles.size()) + report.skipped;
  line["samples_examined"] = report.samples_examined;
  line.update(bench::compare_with_exact(work, values));
  return line;
}

nlohmann::json run(const Workload& work) {
  nlohmann::json line = work.describe();
  line["rules"] = {measure(work, "none", SkipRule::Kind::none, Method::thesis),
                   measure(work, "neighbour", SkipRule::Kind::neighbour, Method::thesis),
                   measure(work, "exact", SkipRule::Kind::exact, Method::thesis),
                   measure(work, "any", SkipRule::Kind::none, Method::thesis),
                   measure(work, "none", SkipRule::Kind::none, Method::tiles)};
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("skip rules before Algorithm 1, on a workload", "bench_skip");
  const bench::WorkloadOptions options(app);
  return run_driver(app, options, argc, argv, run);
}
