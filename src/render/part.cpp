// SPDX-License-Identifier: Apache-2.0
// Meshes as parts of a picture.
#include "render/part.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/parallel_sort.h>

#include <array>
#include <atomic>
#include <tuple>
#include <unordered_map>

#include "render/image.h"

namespace standoff {
namespace {

using PartRange = tbb::blocked_range<std::size_t>;
constexpr std::size_t kPartGrain = 1 << 14;  // vertices or triangles

template <class Work>
void for_all(std::size_t count, const Work& work) {
  tbb::parallel_for(PartRange(0, count, kPartGrain), [&](const PartRange& range) {
    for (std::size_t n = range.begin(); n < range.end(); ++n) work(n);
  });
}

Float3 doubled_area(const DrawnPart& part, const Triangle& t) {
  const Float3 &a = part.places[t[0]], &b = part.places[t[1]], &c = part.places[t[2]];
  return cross(b - a, c - a);
}

}  // namespace

std::vector<char> unused_vertices(MeshView mesh) {
  std::vector<char> unused(mesh.vertices.size(), 1);
  for_all(mesh.triangles.size(), [&](std::size_t t) {
    for (const std::uint32_t v : mesh.triangles[t]) {
      // Read before it is written: most were marked by another triangle, and stay in the caches of all cores.
      const std::atomic_ref<char> mark(unused[v]);
      if (mark.load(std::memory_order_relaxed)) mark.store(0, std::memory_order_relaxed);
    }
  });
  if (std::ranges::count(unused, 1) == 0) unused = {};
  return unused;
}

Box bounds_of_used(MeshView mesh, const std::vector<char>& unused) {
  return tbb::parallel_reduce(
      PartRange(0, mesh.vertices.size(), kPartGrain), Box{},
      [&](const PartRange& range, Box box) {
        for (std::size_t v = range.begin(); v < range.end(); ++v)
          if (unused.empty() || !unused[v]) box.include(mesh.vertices[v]);
        return box;
      },
      [](Box a, const Box& b) {
        a.min = min(a.min, b.min);
        a.max = max(a.max, b.max);
        return a;
      });
}

DrawnPart part_of(const MeshLayer& layer, const UnitSpace& space, std::vector<char> unused) {
  DrawnPart part;
  part.unused = std::move(unused);
  part.triangles = layer.mesh.triangles;
  part.color = linear_of(layer.color);
  part.opacity = static_cast<float>(layer.opacity);
  const std::size_t vertices = layer.mesh.vertices.size();
  part.places.resize(vertices);
  part.normals.resize(layer.normals.size());
  part.values.resize(layer.values.size());
  for_all(vertices, [&](std::size_t v) {
    if (!part.is_used(v)) return;
    part.places[v] = space.placed(layer.mesh.vertices[v]);
    if (!layer.values.empty()) part.values[v] = static_cast<float>(layer.values[v]);
    if (layer.normals.empty() || !is_finite(layer.normals[v])) return;
    const Vec3 n = layer.normals[v];
    part.normals[v] = {static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)};
  });
  return part;
}

void smooth(DrawnPart& part) {
  // Sums of integers do not depend on the order in which threads add. In the unit sphere no area exceeds 4: 2^12 such
  // triangles fit around a vertex, and triangles that are 2^-23 long still have eight bits.
  constexpr float kOne = 0x1p48F;
  std::vector<std::array<std::int64_t, 3>> sums(part.places.size());
  for_all(part.triangles.size(), [&](std::size_t n) {
    const Triangle t = part.triangles[n];
    const Float3 area = doubled_area(part, t);
    const std::array<std::int64_t, 3> share{static_cast<std::int64_t>(area.x * kOne),
                                            static_cast<std::int64_t>(area.y * kOne),
                                            static_cast<std::int64_t>(area.z * kOne)};
    for (const std::uint32_t v : t)
      for (std::size_t axis = 0; axis < 3; ++axis)
        std::atomic_ref(sums[v][axis]).fetch_add(share[axis], std::memory_order_relaxed);
  });
  part.normals.resize(part.places.size());
  for_all(part.places.size(), [&](std::size_t v) {
    const auto& s = sums[v];
    part.normals[v] = unit_or({static_cast<float>(s[0]), static_cast<float>(s[1]), static_cast<float>(s[2])}, {});
  });
}

void cut(DrawnPart& part, const HalfSpace& kept) {
  std::vector<float> beyond(part.places.size());
  for_all(part.places.size(), [&](std::size_t v) { beyond[v] = part.is_used(v) ? kept.beyond(part.places[v]) : 0; });
  std::vector<Triangle> left;
  std::unordered_map<std::uint64_t, std::uint32_t> on_edge;
  // The vertex where an edge crosses the plane: computed from the inner to the outer end, so that neighbours share it.
  const auto crossing = [&](std::uint32_t in, std::uint32_t out) {
    const auto [found, is_new] =
        on_edge.try_emplace(std::uint64_t{in} << 32 | out, static_cast<std::uint32_t>(part.places.size()));
    if (!is_new) return found->second;
    const float t = beyond[in] / (beyond[in] - beyond[out]);
    const auto mixed = [t](const auto& a, const auto& b) { return a * (1 - t) + b * t; };
    part.places.push_back(mixed(part.places[in], part.places[out]));
    if (!part.normals.empty()) part.normals.push_back(unit_or(mixed(part.normals[in], part.normals[out]), {}));
    if (!part.values.empty()) part.values.push_back(mixed(part.values[in], part.values[out]));
    return found->second;
  };
  for (const Triangle& t : part.triangles) {
    const int out = (beyond[t[0]] > 0) + (beyond[t[1]] > 0) + (beyond[t[2]] > 0);
    if (out == 3) continue;
    if (out == 0) {
      left.push_back(t);
      continue;
    }
    // Turned so that the corner that is alone on its side comes first.
    std::size_t alone = 0;
    while ((beyond[t[alone]] > 0) != (out == 1)) ++alone;
    const std::uint32_t a = t[alone], b = t[(alone + 1) % 3], c = t[(alone + 2) % 3];
    if (out == 2) {
      left.push_back({a, crossing(a, b), crossing(a, c)});
    } else {
      const std::uint32_t ab = crossing(b, a), ac = crossing(c, a);
      left.push_back({ab, b, c});
      left.push_back({ab, c, ac});
    }
  }
  part.own = std::move(left);
  part.use_own();
  part.unused.assign(part.places.size(), 1);
  for (const Triangle& t : part.own)
    for (const std::uint32_t v : t) part.unused[v] = 0;
}

std::vector<std::array<std::uint32_t, 2>> feature_edges(const DrawnPart& part) {
  struct Side {
    std::uint32_t low, high, triangle;
    bool operator<(const Side& s) const { return std::tie(low, high, triangle) < std::tie(s.low, s.high, s.triangle); }
  };
  std::vector<Side> sides(3 * part.triangles.size());
  for_all(part.triangles.size(), [&](std::size_t n) {
    const Triangle t = part.triangles[n];
    for (std::size_t e = 0; e < 3; ++e) {
      const auto [low, high] = std::minmax(t[e], t[(e + 1) % 3]);
      sides[3 * n + e] = {low, high, static_cast<std::uint32_t>(n)};
    }
  });
  tbb::parallel_sort(sides.begin(), sides.end());
  constexpr float kSharp = 0.866F;  // the cosine of 30 degrees
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (std::size_t n = 0; n < sides.size();) {
    std::size_t end = n + 1;
    while (end < sides.size() && sides[end].low == sides[n].low && sides[end].high == sides[n].high) ++end;
    const auto normal = [&](std::size_t side) {
      return unit_or(doubled_area(part, part.triangles[sides[side].triangle]), {});
    };
    const bool drawn = end - n != 2 || std::abs(dot(normal(n), normal(n + 1))) < kSharp;
    if (drawn && sides[n].low != sides[n].high) edges.push_back({sides[n].low, sides[n].high});
    n = end;
  }
  return edges;
}

}  // namespace standoff
