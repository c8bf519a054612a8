// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/outward.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

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

struct ChunkSums {
  double volume = 0, volume_magnitude = 0;
  Vec3 normal;  // as long as the area
  double normal_magnitude = 0;

  void add(const ChunkSums& other) {
    volume += other.volume;
    volume_magnitude += other.volume_magnitude;
    normal = normal + other.normal;
    normal_magnitude += other.normal_magnitude;
  }
  // Normals of a closed set have the sum 0, and only then its volume does not depend on where it is measured from.
  bool faces_outwards() const {
    constexpr double kRounding = 1e-12;
    return max_norm(normal) <= kRounding * normal_magnitude && (!has_area() || volume > kRounding * volume_magnitude);
  }
  bool has_area() const { return normal_magnitude > 0; }
};

struct OutwardPart {
  std::uint32_t set;
  ChunkSums sums;
};
constexpr std::size_t kOutwardChunk = 1024, kOutwardChunks = 64;

}  // namespace

bool faces_outwards(MeshView mesh) {
  const std::size_t triangles = mesh.triangles.size(), vertices = mesh.vertices.size();
  VertexSets sets(vertices);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles, 4096), [&](const auto& range) {
    for (std::size_t t = range.begin(); t != range.end(); ++t) {
      const Triangle v = mesh.triangles[t];
      sets.join(v[0], v[1]);
      sets.join(v[1], v[2]);
    }
  });
  std::vector<std::uint32_t> number(vertices);  // of the sets, at their lowest vertices
  std::uint32_t count = 0;
  for (std::uint32_t v = 0; v < vertices; ++v)
    if (sets.find(v) == v) number[v] = count++;

  // Chunks add up by themselves, some at a time, and then in their order: the sums have the same bits on any number of
  // threads. Within a chunk most neighbours belong to one set.
  std::vector<ChunkSums> of_set(count);
  std::array<std::vector<OutwardPart>, kOutwardChunks> parts;
  for (std::size_t first = 0; first < triangles; first += kOutwardChunks * kOutwardChunk) {
    tbb::parallel_for(std::size_t{0}, kOutwardChunks, [&](std::size_t chunk) {
      std::vector<OutwardPart>& mine = parts[chunk];
      mine.clear();
      const std::size_t begin = first + chunk * kOutwardChunk, end = std::min(triangles, begin + kOutwardChunk);
      for (std::size_t t = begin; t < end; ++t) {
        const std::uint32_t set = sets.find(mesh.triangles[t][0]);
        if (mine.empty() || mine.back().set != set) mine.push_back({set, {}});
        const Vec3 origin = mesh.vertices[set];  // one of the set's own, so that a small part far away loses nothing
        const auto [a, b, c] = mesh.corners(t);
        const Vec3 normal = cross(b - a, c - a);
        const double volume = dot(a - origin, normal);
        mine.back().sums.add({volume, std::abs(volume), normal, max_norm(normal)});
      }
    });
    for (const auto& chunk : parts)
      for (const OutwardPart& part : chunk) of_set[number[part.set]].add(part.sums);
  }
  return std::ranges::any_of(of_set, &ChunkSums::has_area) && std::ranges::all_of(of_set, &ChunkSums::faces_outwards);
}

std::int64_t outward_bytes(std::int64_t triangles) {
  constexpr std::int64_t kMostParts = kOutwardChunks * kOutwardChunk;
  // Two numbers for each vertex, the sums of each set, and parts in vectors that double.
  return triangles * static_cast<std::int64_t>(3 * 8 + sizeof(ChunkSums)) +
         2 * std::min(triangles, kMostParts) * static_cast<std::int64_t>(sizeof(OutwardPart));
}

}  // namespace standoff
