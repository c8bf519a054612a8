// SPDX-License-Identifier: Apache-2.0
#include "sign/outward.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/position_hash.h"

namespace standoff {
namespace {

// Sets of vertices that many threads join at once. A link always leads to a lower vertex, so that a set's
// representative is its lowest one in the end, whatever the threads do.
class VertexSets {
 public:
  explicit VertexSets(std::size_t vertices) : link_(vertices) {
    for (std::uint32_t v = 0; v < vertices; ++v) link_[v] = v;
  }

  std::uint32_t find(std::uint32_t v) {
    for (;;) {
      const std::uint32_t up = at(v).load(std::memory_order_relaxed);
      if (up == v) return v;
      const std::uint32_t above = at(up).load(std::memory_order_relaxed);
      if (above != up) at(v).store(above, std::memory_order_relaxed);  // halves the path
      v = above;
    }
  }

  void join(std::uint32_t a, std::uint32_t b) {
    for (;;) {
      a = find(a);
      b = find(b);
      if (a == b) return;
      if (a < b) std::swap(a, b);
      std::uint32_t expected = a;
      if (at(a).compare_exchange_strong(expected, b, std::memory_order_relaxed)) return;
    }
  }

 private:
  std::atomic_ref<std::uint32_t> at(std::uint32_t v) { return std::atomic_ref(link_[v]); }

  std::vector<std::uint32_t> link_;
};

struct Sums {
  double volume = 0, magnitude = 0;
  std::uint64_t edges = 0;  // of hashes of directed edges, opposite ones with opposite signs: 0 if they cancel
};

std::uint64_t edge_hash(std::uint32_t from, std::uint32_t to) {
  const bool forward = from < to;
  const std::uint64_t both = forward ? std::uint64_t{from} << 32 | to : std::uint64_t{to} << 32 | from;
  const std::uint64_t hash = folded_product(both ^ 0x243f6a8885a308d3u, 0x9e3779b97f4a7c15u);
  return from == to ? 0 : forward ? hash : -hash;
}

}  // namespace

bool faces_outwards(MeshView mesh) {
  constexpr std::size_t kChunk = 4096;
  const std::size_t triangles = mesh.triangles.size();
  VertexSets sets(mesh.vertices.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles, kChunk), [&](const auto& range) {
    for (std::size_t t = range.begin(); t != range.end(); ++t) {
      const Triangle v = mesh.triangles[t];
      sets.join(v[0], v[1]);
      sets.join(v[1], v[2]);
    }
  });

  // Chunks add up by themselves, and then in their order: the sums have the same bits on any number of threads. Within
  // a chunk most neighbours belong to one set.
  struct Part {
    std::uint32_t set;
    Sums sums;
  };
  std::vector<std::vector<Part>> parts((triangles + kChunk - 1) / kChunk);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t chunk) {
    std::vector<Part>& mine = parts[chunk];
    for (std::size_t t = chunk * kChunk; t < std::min(triangles, (chunk + 1) * kChunk); ++t) {
      const Triangle v = mesh.triangles[t];
      const std::uint32_t set = sets.find(v[0]);
      if (mine.empty() || mine.back().set != set) mine.push_back({set, {}});
      const Vec3 origin = mesh.vertices[set];  // one of the set's own, so that a small part far away loses nothing
      const auto [a, b, c] = mesh.corners(t);
      Sums& sums = mine.back().sums;
      const double volume = dot(a - origin, cross(b - origin, c - origin));
      sums.volume += volume;
      sums.magnitude += std::abs(volume);
      sums.edges += edge_hash(v[0], v[1]) + edge_hash(v[1], v[2]) + edge_hash(v[2], v[0]);
    }
  });
  std::vector<Sums> of_set(mesh.vertices.size());
  for (const auto& chunk : parts)
    for (const Part& part : chunk) {
      of_set[part.set].volume += part.sums.volume;
      of_set[part.set].magnitude += part.sums.magnitude;
      of_set[part.set].edges += part.sums.edges;
    }
  constexpr double kRounding = 1e-12;  // of the magnitude; a volume of 0 is less, and counts as none
  return std::ranges::all_of(of_set, [](const Sums& sums) {
    return sums.edges == 0 && (sums.magnitude == 0 || sums.volume > kRounding * sums.magnitude);
  });
}

}  // namespace standoff
