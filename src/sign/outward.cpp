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
  double volume = 0, volume_magnitude = 0;
  Vec3 normal;  // as long as the area
  double normal_magnitude = 0;

  void add(const Sums& other) {
    volume += other.volume;
    volume_magnitude += other.volume_magnitude;
    normal = normal + other.normal;
    normal_magnitude += other.normal_magnitude;
  }
  // Normals of a closed set have the sum 0, and only then its volume does not depend on where it is measured from.
  bool faces_outwards() const {
    constexpr double kRounding = 1e-12;
    return max_norm(normal) <= kRounding * normal_magnitude &&
           (volume_magnitude == 0 || volume > kRounding * volume_magnitude);
  }
};

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
      const Vec3 normal = cross(b - a, c - a);
      const double volume = dot(a - origin, normal);
      sums.add({volume, std::abs(volume), normal, max_norm(normal)});
    }
  });
  std::vector<Sums> of_set(mesh.vertices.size());
  for (const auto& chunk : parts)
    for (const Part& part : chunk) of_set[part.set].add(part.sums);
  return std::ranges::all_of(of_set, &Sums::faces_outwards);
}

}  // namespace standoff
