// SPDX-License-Identifier: Apache-2.0
#include "sign/outer/mesh_cuts.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <limits>

#include "core/progress.h"
#include "core/threads.h"
#include "geometry/predicates.h"
#include "geometry/triangle_pair.h"
#include "sign/outer/triangle_cut.h"

namespace standoff {
namespace {

constexpr std::int64_t kPairsBetweenChecks = 1 << 14;

class CutSearch {
 public:
  CutSearch(const OrientedMesh& mesh, MeshCuts& found) : mesh_(mesh), found_(found) {}

  void compare(std::uint32_t first, std::uint32_t second, TrianglePairs& touched) const {
    const Corners p = mesh_.mesh.corners(first), q = mesh_.mesh.corners(second);
    const bool first_flat = found_.flat[first] != 0, second_flat = found_.flat[second] != 0;
    if (first_flat || second_flat) {
      // A triangle without an area has no sides, and cuts nothing.
      if (first_flat != second_flat && triangles_intersect(p, q))
        touched.push_back(first_flat ? std::pair(first, second) : std::pair(second, first));
      return;
    }
    const bool first_used = mesh_.use_of(first) != 0, second_used = mesh_.use_of(second) != 0;
    const Cuts cuts = cuts_between(p, q);
    if (cuts.first && second_used) mark(first);
    if (cuts.second && first_used) mark(second);
  }

 private:
  void mark(std::uint32_t triangle) const { std::atomic_ref(found_.cut[triangle]).store(1, std::memory_order_relaxed); }

  OrientedMesh mesh_;
  MeshCuts& found_;
};

}  // namespace

std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs_of(const TrianglePairs& pairs, std::uint32_t triangle) {
  const auto found = std::ranges::equal_range(pairs, triangle, {}, &TrianglePairs::value_type::first);
  return {found.begin(), found.end()};
}

MeshCuts find_cuts(const OrientedMesh& mesh, const Bvh& bvh, ProgressMeter& progress) {
  const std::size_t triangles = mesh.mesh.triangles.size();
  MeshCuts found;
  found.flat.resize(triangles);
  found.cut.resize(triangles);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles, 4096), [&](const auto& range) {
    for (std::size_t t = range.begin(); t != range.end(); ++t) {
      const Corners corners = mesh.mesh.corners(t);
      found.flat[t] = upright_axis(corners[0], corners[1], corners[2]) < 0;
    }
  });
  const CutSearch search(mesh, found);
  PerThread<TrianglePairs> touched;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles, 64), [&](const auto& range) {
    TrianglePairs& mine = touched.local();
    WorkCheck check(progress, kPairsBetweenChecks);
    for (std::size_t n = range.begin(); n != range.end(); ++n) {
      std::int64_t boxes = std::numeric_limits<std::int64_t>::max();
      for_each_later_overlap(bvh, static_cast<std::uint32_t>(n), boxes, [&](std::uint32_t other) {
        search.compare(bvh.order()[n], bvh.order()[other], mine);
        check.add(1);
        return true;
      });
    }
  });
  touched.for_each(
      [&](const TrianglePairs& part) { found.touched.insert(found.touched.end(), part.begin(), part.end()); });
  std::ranges::sort(found.touched);
  return found;
}

}  // namespace standoff
