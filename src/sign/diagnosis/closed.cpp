// SPDX-License-Identifier: Apache-2.0
// Each position is put at a random place (x, y) of a plane, numbers modulo 2^64. Twice the signed area of a triangle,
// (b - a) x (c - a), is the sum of a x b over its sides; so the sum of all areas depends on the edges alone, and those
// used equally often in both directions cancel. Where some do not, the sum is x^T C y, with C(a, b) = -C(b, a) how
// often the edge is used from a to b more than from b to a. Let 2^s be the largest power of two that divides all of C,
// and C(a, b) be 2^s times an odd number. Then elements a and b of C y are 2^s times random numbers, independent ones:
// only the first depends on y(b), only the second on y(a). With a probability of at most 4^-n all elements have a
// factor 2^(s + n), and then the sum is 0 with a probability of at most 2^(s + n - 64): altogether at most 2^(s - 63).
#include "sign/diagnosis/closed.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <utility>

#include "core/hashes.h"

namespace standoff {
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

// Calls use(a, b, c) with the places of each triangle's corners, and returns the sum of what it returns.
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

// A number of 128 random bits for each edge, the same in both directions; 0 for those of length 0.
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
  // Used as often in one direction as in the other, an edge is used an even number of times.
  if (sum_over<std::uint64_t>(mesh, std::plus<>(), places, twice_area) == 0) return {true, true};
  const EdgeHash odd = sum_over<EdgeHash>(mesh, std::bit_xor<>(), places, hash_of_sides);
  return {false, (odd.a | odd.b) == 0};
}

}  // namespace

Closed is_closed(MeshView mesh) {
  const std::size_t vertices = mesh.vertices.size();
  // A vertex is read six times in a welded mesh; where each is read once or never, its place is not worth memory.
  if (vertices > mesh.triangles.size())
    return is_closed(mesh, [&](std::uint32_t vertex) { return place_of(mesh.vertices[vertex]); });
  const auto places = std::make_unique_for_overwrite<Place[]>(vertices);
  tbb::parallel_for(TriangleRange(0, vertices, kClosedGrain), [&](const TriangleRange& range) {
    for (std::size_t v = range.begin(); v != range.end(); ++v) places[v] = place_of(mesh.vertices[v]);
  });
  return is_closed(mesh, [&](std::uint32_t vertex) { return places[vertex]; });
}

}  // namespace standoff
