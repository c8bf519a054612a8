// SPDX-License-Identifier: Apache-2.0
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <optional>
#include <string>
#include <tuple>

#include "core/guarded.h"
#include "core/memory.h"
#include "core/number_text.h"
#include "core/progress.h"
#include "core/threads.h"
#include "sign/flood/lattice.h"
#include "sign/normal/pseudonormals.h"
#include "sign/oriented_mesh.h"
#include "sign/outer/outer.h"
#include "sign/plan.h"
#include "standoff/crossings.h"
#include "standoff/error.h"

namespace standoff {
namespace {

// The predicates are exact for coordinates up to this.
constexpr double kMostExact = 1e100;

void check(const EdgeCrossingOptions& options) {
  validate("crossings", options.execution, Runs::on_the_cpu);
  validate(options.sign);
  if (options.sign.method == SignMethod::shell)
    throw Error(ErrorCode::usage,
                "crossings: the surface of a shell is not the mesh, so its crossings are none of the mesh's; take "
                "another sign method, or none");
}

void check_crossing_coordinates(const Box& box) {
  if (!(std::max(max_norm(box.min), max_norm(box.max)) <= kMostExact))
    throw Error(ErrorCode::limit,
                "crossings: mesh or grid reach beyond " + number_text(kMostExact) + "; scale them down");
}

// The crossings that a thread has found.
class FoundCrossings {
 public:
  FoundCrossings(MemoryBudget& budget, ProgressMeter& progress) : budget_(&budget), check_(progress, 1 << 14) {}

  void add(const EdgeCrossing& crossing) {
    check_.add(1);
    if (all_.size() == all_.capacity()) grow();
    all_.push_back(crossing);
  }
  const std::vector<EdgeCrossing>& all() const { return all_; }

 private:
  void grow() {
    constexpr std::size_t kFirst = 256;
    const std::size_t before = all_.capacity(), after = std::max(kFirst, 2 * before);
    budget_->take(after * sizeof(EdgeCrossing));
    all_.reserve(after);
    budget_->give_back(before * sizeof(EdgeCrossing));
  }

  MemoryBudget* budget_;
  WorkCheck check_;
  std::vector<EdgeCrossing> all_;
};

// The place where the edge crosses the triangle's plane, by the determinants at its ends. The ends are on different
// sides, so the difference of the determinants loses nothing.
double place_between(const Vec3& from, const Vec3& to, const std::array<Vec3, 3>& t) {
  const double before = std::abs(determinant3d(t[0], t[1], t[2], from)),
               after = std::abs(determinant3d(t[0], t[1], t[2], to));
  const double sum = before + after;
  return sum > 0 ? std::clamp(before / sum, 0.0, 1.0) : 0.0;  // no sum: the two samples are one
}

class Scan {
 public:
  Scan(const OrientedMesh& mesh, const Grid& grid, bool invert)
      : mesh_(mesh),
        grid_(grid),
        invert_(invert),
        axes_{LatticeAxis(axis_of(grid, 0), {}), LatticeAxis(axis_of(grid, 1), {}), LatticeAxis(axis_of(grid, 2), {})} {
  }

  void add_crossings_of(std::size_t triangle, FoundCrossings& found) const {
    if (mesh_.use_of(triangle) == 0) return;
    std::array<Vec3, 3> t = mesh_.corners(triangle);
    if (invert_) std::swap(t[1], t[2]);
    std::optional<Vec3> normal;
    for_each_edge_hit(t, axes_, [&](std::size_t axis, const std::array<std::int64_t, 3>& sample, const EdgeHit& hit) {
      if (!normal) normal = exact_normal(t).unit;
      std::array<std::int64_t, 3> next = sample;
      ++next[axis];
      found.add({.sample = sample,
                 .place = place_between(position(sample), position(next), t),
                 .normal = *normal,
                 .triangle = static_cast<std::uint32_t>(triangle),
                 .axis = static_cast<std::uint8_t>(axis),
                 .enters = hit.crossing < 0});
    });
  }

 private:
  Vec3 position(const std::array<std::int64_t, 3>& sample) const {
    return grid_.position(sample[0], sample[1], sample[2]);
  }

  OrientedMesh mesh_;
  Grid grid_;
  bool invert_;
  std::array<LatticeAxis, 3> axes_;
};

// The orientation of the triangles; `outer` leaves out the internal ones.
std::vector<std::int8_t> use_of(const SignPlan& plan, std::size_t triangles) {
  if (plan.exposed.empty()) return plan.use;
  std::vector<std::int8_t> use(triangles);
  for (const std::uint32_t t : plan.exposed) use[t] = plan.use.empty() ? std::int8_t{1} : plan.use[t];
  return use;
}

void sort(std::vector<EdgeCrossing>& crossings) {
  tbb::parallel_sort(crossings.begin(), crossings.end(), [](const EdgeCrossing& a, const EdgeCrossing& b) {
    const auto key = [](const EdgeCrossing& c) {
      return std::tuple(c.sample[2], c.sample[1], c.sample[0], c.axis, c.place, c.triangle);
    };
    return key(a) < key(b);
  });
}

}  // namespace

std::vector<EdgeCrossing> edge_crossings(MeshView mesh, const Grid& grid, const EdgeCrossingOptions& options) try {
  check(options);
  validate(grid);
  validate(mesh);
  check_crossing_coordinates(bounds(mesh));
  check_crossing_coordinates(grid.bounds());
  std::vector<EdgeCrossing> crossings;
  ProgressMeter progress(options.progress);
  Threads(options.execution.threads).run([&] {
    constexpr std::size_t kGrain = 256;
    progress.stage("sign", 1, 0, 0.1);
    SignPlan plan = plan_sign(mesh, options.sign, progress);
    if (options.sign.outer) plan_outer(mesh, options.sign, plan, progress);
    const std::vector<std::int8_t> use = use_of(plan, mesh.triangles.size());
    const Scan scan({mesh, use}, grid, options.sign.invert);

    MemoryBudget budget("crossings", memory_limit_of(options.memory_limit), "take fewer samples, or allow more memory");
    PerThread<FoundCrossings> found([&] { return FoundCrossings(budget, progress); });
    progress.stage("crossings", static_cast<std::int64_t>(mesh.triangles.size()), 0.1, 0.8);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.triangles.size(), kGrain), [&](const auto& range) {
      FoundCrossings& mine = found.local();
      for (std::size_t first = range.begin(); first < range.end(); first += kGrain) {
        const std::size_t past = std::min(first + kGrain, range.end());
        for (std::size_t t = first; t != past; ++t) scan.add_crossings_of(t, mine);
        progress.advance(static_cast<std::int64_t>(past - first));
      }
    });

    std::size_t count = 0;
    found.for_each([&](const FoundCrossings& some) { count += some.all().size(); });
    budget.take(count * sizeof(EdgeCrossing));
    crossings.reserve(count);
    found.for_each(
        [&](const FoundCrossings& some) { crossings.insert(crossings.end(), some.all().begin(), some.all().end()); });
    progress.stage("sorting", 1, 0.8, 1);
    sort(crossings);
  });
  progress.stage("done", 1, 1, 1);
  return crossings;
} catch (...) {
  throw_as_error("crossings", "take fewer samples, or provide more memory");
}

}  // namespace standoff
