// SPDX-License-Identifier: Apache-2.0
// Fields of meshes of which a part moves: which triangles changed, and updates by passes over the whole mesh.
#include "standoff/update.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "core/guarded.h"
#include "field/computation.h"
#include "field/field_update.h"
#include "field/prepare.h"

namespace standoff {

// Which triangles changed.

namespace {

// Whether each vertex has other bits in the other mesh.
std::vector<std::uint8_t> moved_vertices(const MeshView& before, const MeshView& after) {
  const auto [fewer, more] = std::minmax({before.vertices.size(), after.vertices.size()});
  std::vector<std::uint8_t> moved(more, 1);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, fewer, 16384), [&](const auto& range) {
    for (std::size_t v = range.begin(); v != range.end(); ++v) {
      const Vec3 a = before.vertices[v], b = after.vertices[v];
      moved[v] = std::memcmp(&a, &b, sizeof a) != 0;
    }
  });
  return moved;
}

}  // namespace

std::vector<std::uint32_t> changed_triangles(MeshView before, MeshView after) try {
  constexpr std::size_t kChunk = 16384;
  validate(before);
  validate(after);
  const auto [fewer, more] = std::minmax({before.triangles.size(), after.triangles.size()});
  const std::vector<std::uint8_t> moved = moved_vertices(before, after);
  std::vector<std::vector<std::uint32_t>> found((fewer + kChunk - 1) / kChunk);
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t chunk) {
    for (std::size_t t = kChunk * chunk; t < std::min(fewer, kChunk * (chunk + 1)); ++t) {
      const Triangle a = before.triangles[t], b = after.triangles[t];
      if (a == b && !(moved[a[0]] | moved[a[1]] | moved[a[2]])) continue;
      const auto one = before.corners(t), other = after.corners(t);
      if (std::memcmp(&one, &other, sizeof one) != 0) found[chunk].push_back(static_cast<std::uint32_t>(t));
    }
  });
  std::vector<std::uint32_t> all;
  for (const std::vector<std::uint32_t>& some : found) all.insert(all.end(), some.begin(), some.end());
  for (std::size_t t = fewer; t < more; ++t) all.push_back(static_cast<std::uint32_t>(t));
  return all;
} catch (...) {
  throw_as_error("update");
}

// The update.

namespace {

class FactsByPasses final : public MeshFacts {
 public:
  explicit FactsByPasses(MeshView after) : mesh_(after) {}

  void check(const MeshChange&, const Plan& plan) override {
    if (!scan_mesh(mesh_, plan, false).is_near) check_domain(mesh_, plan.grid);
  }
  // Whether the old mesh was closed is decided of the triangles alone that changed: the rest is common to both.
  Closed closed(const MeshChange& change) override {
    EdgeSums changes(change.after, change.in(change.after));
    changes -= EdgeSums(change.before, change.in(change.before));
    const Closed now = is_closed(mesh_), same = changes.closed();
    return {now.oriented && same.oriented, now.unoriented && same.unoriented};
  }
  bool faces_outwards(const MeshChange&) override { return standoff::faces_outwards(mesh_); }
  std::vector<WindowTriangles> triangles_of(const DirtyTiles& dirty, std::span<const Grid> windows, double reach,
                                            bool with_crossed, ProgressMeter& progress) override {
    return standoff::triangles_of(mesh_, dirty, windows, reach, with_crossed, progress);
  }

 private:
  MeshView mesh_;
};

}  // namespace

UpdateReport update_field(MeshView before, MeshView after, std::span<const std::uint32_t> changed, DistanceField& field,
                          const ComputeOptions& options) try {
  validate(field.thickness(), options);
  FactsByPasses facts(after);
  return FieldUpdate(before, after, facts, field, options).run(changed);
} catch (...) {
  throw_as_error("update", kWithLessMemory);
}

}  // namespace standoff
