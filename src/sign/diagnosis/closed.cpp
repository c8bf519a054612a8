// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/closed.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "core/hashes.h"

namespace standoff {

// Whether a mesh is closed. Each position is put at a random place (x, y) of a plane, numbers modulo 2^64. Twice the
// signed area of a triangle, (b - a) x (c - a), is the sum of a x b over its sides. So the sum of all areas depends on
// the edges alone, and an edge that is used equally often in both directions cancels. Where some do not, the sum is
// x^T C y: C(a, b) = -C(b, a) is the number of uses from a to b less the number of uses from b to a. Let 2^s be the
// largest power of two that divides all of C, and C(a, b) be 2^s times an odd number. Then elements a and b of C y are
// 2^s times independent random numbers: only the first depends on y(b), only the second on y(a). With a probability of
// at most 4^-n all elements have a factor 2^(s + n), and then the sum is 0 with a probability of at most 2^(s + n -
// 64): altogether at most 2^(s - 63).

namespace {

using TriangleRange = tbb::blocked_range<std::size_t>;
constexpr std::size_t kClosedGrain = 8192;

struct Place {
  std::uint64_t x, y;
};

Place place_of(const Vec3& v) {
  const std::uint64_t x = position_hash(v);
  return {x, splitmix64(x)};
}

// The sum of use(a, b, c) over all triangles, for the places of their corners.
template <class Sum, class Plus, class Places, class Use>
Sum sum_over(MeshView mesh, const Plus& plus, const Places& places, const Use& use) {
  return tbb::parallel_reduce(
      TriangleRange(0, mesh.triangles.size(), kClosedGrain), Sum(),
      [&](const TriangleRange& range, Sum sum) {
        for (std::size_t t = range.begin(); t != range.end(); ++t) {
          const auto [a, b, c] = mesh.triangles[t];
          sum = plus(sum, use(places(a), places(b), places(c)));
        }
        return sum;
      },
      plus);
}

std::uint64_t twice_area(const Place& a, const Place& b, const Place& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// 128 random bits for each edge, the same in both directions; 0 for an edge of length 0.
struct EdgeHash {
  std::uint64_t a = 0, b = 0;
  friend EdgeHash operator^(const EdgeHash& l, const EdgeHash& r) { return {l.a ^ r.a, l.b ^ r.b}; }
};
EdgeHash hash_of_edge(const Place& from, const Place& to) {
  if (from.x == to.x) return {};
  const auto& [low, high] = std::minmax(from, to, [](const Place& l, const Place& r) { return l.x < r.x; });
  return {folded_product(low.x ^ 0xeb44accab455d165, high.x ^ 0x9ddfea08eb382d69),
          folded_product(low.y + 0xc2b2ae3d27d4eb4f, high.y + 0x165667b19e3779f9)};
}
EdgeHash hash_of_sides(const Place& a, const Place& b, const Place& c) {
  return hash_of_edge(a, b) ^ hash_of_edge(b, c) ^ hash_of_edge(c, a);
}

template <class Places>
Closed is_closed(MeshView mesh, const Places& places) {
  // An edge that is used equally often in both directions is used an even number of times.
  if (sum_over<std::uint64_t>(mesh, std::plus<>(), places, twice_area) == 0) return {true, true};
  const EdgeHash odd = sum_over<EdgeHash>(mesh, std::bit_xor<>(), places, hash_of_sides);
  return {false, (odd.a | odd.b) == 0};
}

}  // namespace

Closed is_closed(MeshView mesh) {
  const std::size_t vertices = mesh.vertices.size();
  // A welded mesh reads each vertex six times. Where it is read once or never, its place is not worth memory.
  if (vertices > mesh.triangles.size())
    return is_closed(mesh, [&](std::uint32_t vertex) { return place_of(mesh.vertices[vertex]); });
  const auto places = std::make_unique_for_overwrite<Place[]>(vertices);
  tbb::parallel_for(TriangleRange(0, vertices, kClosedGrain), [&](const TriangleRange& range) {
    for (std::size_t v = range.begin(); v != range.end(); ++v) places[v] = place_of(mesh.vertices[v]);
  });
  return is_closed(mesh, [&](std::uint32_t vertex) { return places[vertex]; });
}

// The sums over all triangles that decide are sums in groups: those of a part can be exchanged.
Closed same_edges(MeshView a, std::span<const std::uint32_t> of_a, MeshView b, std::span<const std::uint32_t> of_b) {
  std::uint64_t area = 0;
  EdgeHash odd;
  const auto each = [](MeshView mesh, std::span<const std::uint32_t> triangles, const auto& use) {
    for (const std::uint32_t triangle : triangles) {
      const auto [p, q, r] = mesh.corners(triangle);
      use(place_of(p), place_of(q), place_of(r));
    }
  };
  each(a, of_a, [&](const Place& p, const Place& q, const Place& r) {
    area -= twice_area(p, q, r);
    odd = odd ^ hash_of_sides(p, q, r);
  });
  each(b, of_b, [&](const Place& p, const Place& q, const Place& r) {
    area += twice_area(p, q, r);
    odd = odd ^ hash_of_sides(p, q, r);
  });
  return {area == 0, (odd.a | odd.b) == 0};
}

// Whether a closed mesh faces outwards.

namespace {

// Disjoint sets of vertices that many threads join at once. A link always leads to a lower vertex, so the lowest vertex
// represents its set in the end, whatever the threads do.
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
  Vec3 normal;  // its length is the area
  double normal_magnitude = 0;

  void add(const ChunkSums& other) {
    volume += other.volume;
    volume_magnitude += other.volume_magnitude;
    normal = normal + other.normal;
    normal_magnitude += other.normal_magnitude;
  }
  // The normals of a closed set add up to 0, and only then its volume does not depend on the origin.
  bool faces_outwards() const {
    constexpr double kRounding = 1e-12;
    return max_norm(normal) <= kRounding * normal_magnitude && (!has_area() || volume > kRounding * volume_magnitude);
  }
  bool has_area() const { return normal_magnitude > 0; }
};

struct ChunkPart {
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
  std::vector<std::uint32_t> number(vertices);  // of each set, at its lowest vertex
  std::uint32_t count = 0;
  for (std::uint32_t v = 0; v < vertices; ++v)
    if (sets.find(v) == v) number[v] = count++;

  // Sum up chunks side by side, then in their order, so that the bits do not depend on the number of threads. Most
  // neighbours in a chunk belong to one set.
  std::vector<ChunkSums> of_set(count);
  std::array<std::vector<ChunkPart>, kOutwardChunks> parts;
  for (std::size_t first = 0; first < triangles; first += kOutwardChunks * kOutwardChunk) {
    tbb::parallel_for(std::size_t{0}, kOutwardChunks, [&](std::size_t chunk) {
      std::vector<ChunkPart>& mine = parts[chunk];
      mine.clear();
      const std::size_t begin = first + chunk * kOutwardChunk, end = std::min(triangles, begin + kOutwardChunk);
      for (std::size_t t = begin; t < end; ++t) {
        const std::uint32_t set = sets.find(mesh.triangles[t][0]);
        if (mine.empty() || mine.back().set != set) mine.push_back({set, {}});
        const Vec3 origin = mesh.vertices[set];  // belongs to the set, so that a small part far away loses nothing
        const auto [a, b, c] = mesh.corners(t);
        const Vec3 normal = cross(b - a, c - a);
        const double volume = dot(a - origin, normal);
        mine.back().sums.add({volume, std::abs(volume), normal, max_norm(normal)});
      }
    });
    for (const auto& chunk : parts)
      for (const ChunkPart& part : chunk) of_set[number[part.set]].add(part.sums);
  }
  return std::ranges::any_of(of_set, &ChunkSums::has_area) && std::ranges::all_of(of_set, &ChunkSums::faces_outwards);
}

std::int64_t outward_bytes(std::int64_t triangles) {
  constexpr std::int64_t kMostParts = kOutwardChunks * kOutwardChunk;
  // There are two numbers for each vertex, the sums of each set, and parts in vectors that double.
  return triangles * static_cast<std::int64_t>(3 * 8 + sizeof(ChunkSums)) +
         2 * std::min(triangles, kMostParts) * static_cast<std::int64_t>(sizeof(ChunkPart));
}

}  // namespace standoff
