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
#include <optional>
#include <utility>
#include <vector>

#include "core/hashes.h"
#include "sign/diagnosis/closed_terms.h"

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

// Calls use(triangles, vertices): spans where the mesh can be read in place, which is faster; else its views.
template <class Use>
auto with_arrays(MeshView mesh, const Use& use) {
  const auto triangles = mesh.triangles.as_span();
  const auto vertices = mesh.vertices.as_span();
  return triangles && vertices ? use(*triangles, *vertices) : use(mesh.triangles, mesh.vertices);
}

// The sum of use(a, b, c) over all triangles, for the places of their corners.
template <class Sum, class Plus, class Triangles, class Places, class Use>
Sum sum_over(const Triangles& triangles, const Plus& plus, const Places& places, const Use& use) {
  return tbb::parallel_reduce(
      TriangleRange(0, triangles.size(), kClosedGrain), Sum(),
      [&](const TriangleRange& range, Sum sum) {
        for (std::size_t t = range.begin(); t != range.end(); ++t) {
          const auto [a, b, c] = triangles[t];
          sum = plus(sum, use(places(a), places(b), places(c)));
        }
        return sum;
      },
      plus);
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

// A welded mesh reads each vertex six times. Where it is read once or never, its place is not worth memory.
bool keeps_places(MeshView mesh) { return mesh.vertices.size() <= mesh.triangles.size(); }

// Calls use(triangles, places), where a function has the place of each vertex.
template <class Use>
auto with_places(MeshView mesh, const Use& use) {
  return with_arrays(mesh, [&](const auto& triangles, const auto& vertices) {
    if (!keeps_places(mesh)) return use(triangles, [&](std::uint32_t vertex) { return place_of(vertices[vertex]); });
    const auto places = std::make_unique_for_overwrite<Place[]>(vertices.size());
    tbb::parallel_for(TriangleRange(0, vertices.size(), kClosedGrain), [&](const TriangleRange& range) {
      for (std::size_t v = range.begin(); v != range.end(); ++v) places[v] = place_of(vertices[v]);
    });
    return use(triangles, [&](std::uint32_t vertex) { return places[vertex]; });
  });
}

template <class Triangles, class Places>
std::uint64_t sum_of_areas(const Triangles& triangles, const Places& places) {
  // By its name alone the compiler would call it.
  const auto area = [](const auto&... places_of) { return twice_area(places_of...); };
  return sum_over<std::uint64_t>(triangles, std::plus<>(), places, area);
}
template <class Triangles, class Places>
EdgeHash sum_of_sides(const Triangles& triangles, const Places& places) {
  return sum_over<EdgeHash>(triangles, std::bit_xor<>(), places, hash_of_sides);
}

}  // namespace

std::int64_t closed_bytes(MeshView mesh) {
  return keeps_places(mesh) ? static_cast<std::int64_t>(mesh.vertices.size() * sizeof(Place)) : 0;
}

Closed is_closed(MeshView mesh) {
  return with_places(mesh, [](const auto& triangles, const auto& places) -> Closed {
    // An edge that is used equally often in both directions is used an even number of times.
    if (sum_of_areas(triangles, places) == 0) return {true, true};
    const EdgeHash odd = sum_of_sides(triangles, places);
    return {false, (odd.a | odd.b) == 0};
  });
}

EdgeSums::EdgeSums(MeshView mesh) {
  with_places(mesh, [&](const auto& triangles, const auto& places) {
    area_ = sum_of_areas(triangles, places);
    const EdgeHash odd = sum_of_sides(triangles, places);
    odd_ = {odd.a, odd.b};
  });
}

EdgeSums::EdgeSums(MeshView mesh, std::span<const std::uint32_t> triangles) {
  EdgeHash odd;
  for (const std::uint32_t triangle : triangles) {
    const auto [a, b, c] = mesh.corners(triangle);
    const Place p = place_of(a), q = place_of(b), r = place_of(c);
    area_ += twice_area(p, q, r);
    odd = odd ^ hash_of_sides(p, q, r);
  }
  odd_ = {odd.a, odd.b};
}

EdgeSums& EdgeSums::operator+=(const EdgeSums& other) {
  area_ += other.area_;
  for (std::size_t n = 0; n < odd_.size(); ++n) odd_[n] ^= other.odd_[n];
  return *this;
}

EdgeSums& EdgeSums::operator-=(const EdgeSums& other) {
  area_ -= other.area_;
  for (std::size_t n = 0; n < odd_.size(); ++n) odd_[n] ^= other.odd_[n];
  return *this;
}

// Whether a closed mesh faces outwards.

namespace {

// Disjoint sets of vertices, joined by triangles, and numbered in the order of their lowest vertices. A link always
// leads to a lower vertex, so the lowest vertex represents its set in the end, whatever the threads do.
class VertexSets {
 public:
  explicit VertexSets(MeshView mesh) : link_(mesh.vertices.size()) {
    for (std::uint32_t v = 0; v < link_.size(); ++v) link_[v] = v;
    // Link each vertex to the lowest one beside it, which spares most triangles a search. A link that is lost because
    // threads meet is found below.
    for_each_triangle(mesh, [&](const Triangle& t) {
      const std::uint32_t lowest = std::min({link(t[0]), link(t[1]), link(t[2])});
      for (const std::uint32_t v : t) at(v).store(lowest, std::memory_order_relaxed);
    });
    // Link each to the end of its path: a link leads to a vertex whose own link leads there already.
    std::size_t ends = 0;
    for (std::uint32_t v = 0; v < link_.size(); ++v) {
      ends += link_[v] == v;
      link_[v] = link_[link_[v]];
    }
    for_each_triangle(mesh, [&](const Triangle& t) {
      // Sets that met before are two links away.
      const std::uint32_t end = link(link(t[0]));
      if (end == link(link(t[1])) && end == link(link(t[2]))) return;
      join(t[0], t[1]);
      join(t[1], t[2]);
    });
    lowest_.reserve(ends);
    for (std::uint32_t v = 0; v < link_.size(); ++v) {
      if (link_[v] == v) {
        link_[v] = count();
        lowest_.push_back(v);
      } else {
        link_[v] = link_[link_[v]];  // the link of a lower vertex is the number of its set already
      }
    }
  }

  std::uint32_t count() const { return static_cast<std::uint32_t>(lowest_.size()); }
  /// The set of a vertex.
  std::uint32_t of(std::uint32_t v) const { return link_[v]; }
  std::uint32_t lowest(std::uint32_t set) const { return lowest_[set]; }

 private:
  template <class Use>
  static void for_each_triangle(MeshView mesh, const Use& use) {
    with_arrays(mesh, [&](const auto& triangles, const auto&) {
      tbb::parallel_for(TriangleRange(0, triangles.size(), 4096), [&](const TriangleRange& range) {
        for (std::size_t t = range.begin(); t != range.end(); ++t) use(triangles[t]);
      });
    });
  }

  std::atomic_ref<std::uint32_t> at(std::uint32_t v) { return std::atomic_ref(link_[v]); }
  std::uint32_t link(std::uint32_t v) { return at(v).load(std::memory_order_relaxed); }

  std::uint32_t find(std::uint32_t v) {
    for (;;) {
      const std::uint32_t up = link(v);
      if (up == v) return v;
      const std::uint32_t above = link(up);
      at(v).store(above, std::memory_order_relaxed);  // halves the path
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

  std::vector<std::uint32_t> link_;    // first to a vertex, in the end to a set
  std::vector<std::uint32_t> lowest_;  // by set
};

struct ChunkPart {
  std::uint32_t set;
  OutwardTerms sums;
};
constexpr std::size_t kOutwardChunk = 1024, kOutwardChunks = 64;

}  // namespace

bool faces_outwards(MeshView mesh) {
  const VertexSets sets(mesh);
  // Sum up chunks side by side, then in their order, so that the bits do not depend on the number of threads. Most
  // neighbours in a chunk belong to one set.
  std::vector<OutwardTerms> of_set(sets.count());
  std::array<std::vector<ChunkPart>, kOutwardChunks> parts;
  with_arrays(mesh, [&](const auto& triangles, const auto& vertices) {
    for (std::size_t first = 0; first < triangles.size(); first += kOutwardChunks * kOutwardChunk) {
      tbb::parallel_for(std::size_t{0}, kOutwardChunks, [&](std::size_t chunk) {
        std::vector<ChunkPart>& mine = parts[chunk];
        mine.clear();
        const std::size_t begin = first + chunk * kOutwardChunk,
                          end = std::min(triangles.size(), begin + kOutwardChunk);
        for (std::size_t t = begin; t < end;) {
          const std::uint32_t set = sets.of(triangles[t][0]);
          const Vec3 origin = vertices[sets.lowest(set)];
          OutwardTerms sums;
          for (; t < end && sets.of(triangles[t][0]) == set; ++t) {
            const auto [a, b, c] = triangles[t];
            sums.add(OutwardTerms::of(vertices[a], vertices[b], vertices[c], origin));
          }
          mine.push_back({set, sums});
        }
      });
      for (const auto& chunk : parts)
        for (const ChunkPart& part : chunk) of_set[part.set].add(part.sums);
    }
  });
  return std::ranges::any_of(of_set, &OutwardTerms::has_area) &&
         std::ranges::all_of(of_set, &OutwardTerms::faces_outwards);
}

std::int64_t outward_bytes(MeshView mesh) {
  const VertexSets sets(mesh);
  // The most parts of a chunk: runs of triangles of one set.
  const std::size_t triangles = mesh.triangles.size(), chunks = (triangles + kOutwardChunk - 1) / kOutwardChunk;
  const auto parts = [&](const TriangleRange& range, std::int64_t most) {
    for (std::size_t chunk = range.begin(); chunk != range.end(); ++chunk) {
      std::int64_t runs = 1;
      const std::size_t begin = chunk * kOutwardChunk, end = std::min(triangles, begin + kOutwardChunk);
      for (std::size_t t = begin + 1; t < end; ++t)
        runs += sets.of(mesh.triangles[t][0]) != sets.of(mesh.triangles[t - 1][0]);
      most = std::max(most, runs);
    }
    return most;
  };
  const std::int64_t most_parts = tbb::parallel_reduce(TriangleRange(0, chunks, 8), std::int64_t{0}, parts,
                                                       [](std::int64_t a, std::int64_t b) { return std::max(a, b); });
  // There is a number for each vertex, and one for each set, of which there may be as many; the sums of each set; and
  // parts in vectors that double: while one grows there are up to three times as many.
  return static_cast<std::int64_t>(mesh.vertices.size() * 2 * sizeof(std::uint32_t)) +
         sets.count() * static_cast<std::int64_t>(sizeof(OutwardTerms)) +
         static_cast<std::int64_t>(std::min(kOutwardChunks, chunks) * 3 * sizeof(ChunkPart)) * most_parts;
}

// The same, kept. The terms are those of faces_outwards(), with an origin of their own, rounded down to multiples of a
// power of two that leaves 80 bits to their sum. So a triangle that moves to and fro leaves nothing behind.

namespace {

// 2^32 terms of the largest size still add up to less than 2^127.
constexpr int kFixedBits = 80, kMostFixedBits = 94;

// x / 2^unit, rounded down. Nothing if that is 2^kMostFixedBits or more, or no number.
std::optional<__int128> fixed(double x, int unit) {
  if (x == 0) return 0;
  if (!std::isfinite(x)) return std::nullopt;
  int exponent;
  const double fraction = std::frexp(x, &exponent);
  const auto digits = static_cast<std::int64_t>(std::ldexp(fraction, 53));
  if (exponent - unit > kMostFixedBits) return std::nullopt;
  const int shift = exponent - 53 - unit;
  if (shift >= 0) return static_cast<__int128>(digits) * (static_cast<__int128>(1) << shift);
  return shift > -63 ? digits >> -shift : digits >> 63;
}

std::int16_t unit_for(double magnitude) {
  return magnitude > 0 && std::isfinite(magnitude) ? static_cast<std::int16_t>(std::ilogb(magnitude) - kFixedBits) : 0;
}

double times_unit(__int128 count, int unit) { return std::ldexp(static_cast<double>(count), unit); }

}  // namespace

OutwardSums::OutwardSums(MeshView mesh) : set_of_(mesh.vertices.size()) {
  const VertexSets sets(mesh);
  // A set that no triangle uses is left out: meshes may have any number of such vertices.
  constexpr std::uint32_t kNoSet = static_cast<std::uint32_t>(-1);
  std::vector<std::uint32_t> number(sets.count(), kNoSet);
  std::uint32_t count = 0;
  for (const Triangle& t : mesh.triangles)
    if (std::uint32_t& n = number[sets.of(t[0])]; n == kNoSet) n = count++;
  sets_.resize(count);
  for (std::uint32_t v = 0; v < set_of_.size(); ++v) set_of_[v] = number[sets.of(v)];
  for (std::uint32_t set = 0; set < sets.count(); ++set)
    if (const std::uint32_t n = number[set]; n != kNoSet) {
      sets_[n].first = sets.lowest(set);
      sets_[n].origin = mesh.vertices[sets.lowest(set)];
    }
  // First the magnitudes, in double, for the units.
  struct Magnitudes {
    double reach = 0, normal = 0;
  };
  std::vector<Magnitudes> magnitudes(sets_.size());
  const auto triangles = static_cast<std::uint32_t>(mesh.triangles.size());
  std::uint32_t last = 0;
  for (std::uint32_t t = 0; t < triangles; ++t) {
    const std::uint32_t n = set_of_[mesh.triangles[t][0]];
    const Terms terms = terms_of(mesh, t, sets_[n]);
    magnitudes[n].reach += terms.reach;
    magnitudes[n].normal += terms.normal_length;
    ++sets_[n].triangles;
    sets_[n].runs += t % kOutwardChunk == 0 || n != last;
    last = n;
  }
  for (std::size_t n = 0; n < sets_.size(); ++n) {
    sets_[n].volume_unit = unit_for(magnitudes[n].reach);
    sets_[n].normal_unit = unit_for(magnitudes[n].normal);
  }
  for (std::uint32_t t = 0; t < triangles; ++t) {
    Set& set = sets_[set_of_[mesh.triangles[t][0]]];
    add(set, terms_of(mesh, t, set), 1);
  }
  for (Set& set : sets_) {
    set.is_sure = is_sure(set, mesh);
    unsure_ += !set.is_sure;
    with_area_ += set.triangles_with_area > 0;
  }
}

std::int64_t OutwardSums::bytes(std::int64_t triangles, std::int64_t vertices) {
  constexpr std::int64_t kWhileMade = 2 * sizeof(std::uint32_t) + 2 * sizeof(double);
  return vertices * static_cast<std::int64_t>(sizeof(std::uint32_t) + kWhileMade) +
         std::min(triangles, vertices) * static_cast<std::int64_t>(sizeof(Set));
}

OutwardSums::Terms OutwardSums::terms_of(MeshView mesh, std::uint32_t triangle, const Set& set) const {
  const auto [a, b, c] = mesh.corners(triangle);
  const Vec3 normal = cross(b - a, c - a), from = a - set.origin;
  const double length = max_norm(normal);
  return {dot(from, normal), max_norm(from) * length, length, normal};
}

void OutwardSums::add(Set& set, const Terms& terms, int times) {
  const auto put = [&](Fixed& sum, double term, int unit) {
    if (const auto count = fixed(term, unit))
      sum += times * *count;
    else
      set.is_lost = true;
  };
  put(set.volume, terms.volume, set.volume_unit);
  put(set.reach, terms.reach, set.volume_unit);
  for (std::size_t axis = 0; axis < 3; ++axis) put(set.normal[axis], terms.normal[axis], set.normal_unit);
  put(set.normal_length, terms.normal_length, set.normal_unit);
  set.triangles_with_area += static_cast<std::uint32_t>(times * (terms.normal_length > 0));
}

// Bounds what faces_outwards() finds of the set, whose origin is the lowest vertex as it is now. With d from one origin
// to the other, a volume changes by dot(d, sum of normals), which is at most 3 |d| |sum| in the largest norms, and the
// magnitude of each product by 3 |d| |normal|. A sum of n numbers in double is off by at most n units of rounding of
// their magnitudes: those of a run of a chunk, and the sums of runs. The factor covers the terms' own rounding. Each
// integer is short of its sum by less than a unit for each triangle, as terms are rounded down.
bool OutwardSums::is_sure(const Set& set, MeshView mesh) const {
  if (set.triangles_with_area == 0) return !set.is_lost;
  const double d = max_norm(mesh.vertices[set.first] - set.origin);
  const double normals = times_unit(set.normal_length, set.normal_unit),
               most_normals = times_unit(set.normal_length + set.triangles, set.normal_unit),
               volume = times_unit(set.volume, set.volume_unit),
               reach = 3 * (times_unit(set.reach + set.triangles, set.volume_unit) + d * most_normals);
  double sum = 0;
  for (const Fixed& along : set.normal) sum = std::max(sum, std::abs(times_unit(along, set.normal_unit)));
  sum += times_unit(set.triangles, set.normal_unit);
  const double rounding = (kOutwardChunk + 64.0 + set.runs) * 0x1p-53;
  const double off = rounding * most_normals;
  const bool cancels = sum + off <= OutwardTerms::kRounding * (normals - off);
  return !set.is_lost && std::isfinite(reach) && cancels &&
         volume - 3 * d * (sum + off) > 2 * (OutwardTerms::kRounding + rounding) * reach;
}

void OutwardSums::judge(Set& set, MeshView mesh) {
  unsure_ -= !set.is_sure;
  set.is_sure = is_sure(set, mesh);
  unsure_ += !set.is_sure;
}

void OutwardSums::follow(MeshView before, MeshView after, std::span<const std::uint32_t> triangles) {
  std::vector<std::uint32_t> touched;
  for (const std::uint32_t t : triangles) {
    const std::uint32_t n = set_of_[after.triangles[t][0]];
    if (touched.empty() || touched.back() != n) touched.push_back(n);
    Set& set = sets_[n];
    with_area_ -= set.triangles_with_area > 0;
    add(set, terms_of(before, t, set), -1);
    add(set, terms_of(after, t, set), 1);
    with_area_ += set.triangles_with_area > 0;
  }
  for (const std::uint32_t n : touched) judge(sets_[n], after);
}

}  // namespace standoff
