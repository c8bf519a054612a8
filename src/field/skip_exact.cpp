// SPDX-License-Identifier: Apache-2.0
#include "field/skip_exact.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "core/hashes.h"
#include "core/threads.h"
#include "field/reach.h"
#include "geometry/predicates.h"
#include "geometry/triangle_box.h"

namespace standoff {
namespace {

// Bits and not values are compared: 0 equals -0, but may give a result that does not.
bool same_bits(const Corners& a, const Corners& b) {
  using Bits = std::array<std::uint64_t, 9>;
  return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

std::uint32_t hash(const Corners& corners) {
  std::uint64_t h = 0;
  for (const std::uint64_t bits : std::bit_cast<std::array<std::uint64_t, 9>>(corners)) {
    h = (h ^ bits) * kSplitmixStep;
    h ^= h >> 32;
  }
  return static_cast<std::uint32_t>(h);
}

// Triangles in chunks that are looked at side by side.
constexpr std::int64_t kChunk = std::int64_t{1} << 14;
// Entries are sorted in buckets by the top bits of their hash: enough for the sorting to stay in a near cache.
constexpr int kBucketBits = 11;
constexpr std::uint32_t kBuckets = 1u << kBucketBits;
constexpr std::uint32_t bucket_of(std::uint32_t hash) { return hash >> (32 - kBucketBits); }

class ExactRule {
 public:
  ExactRule(MeshView mesh, const Grid& grid, double thickness)
      : mesh_(mesh),
        grid_(grid),
        chunks_((static_cast<std::int64_t>(mesh.triangles.size()) + kChunk - 1) / kChunk),
        reach_(reach_beyond_rounding(grid, thickness)),
        kept_(mesh.triangles.size(), 1) {}

  std::vector<std::uint32_t> kept() {
    sort_into_buckets();
    tbb::parallel_for(std::uint32_t{0}, kBuckets, [&](std::uint32_t bucket) { drop_copies(bucket); });
    std::vector<std::uint32_t> kept;
    kept.reserve(static_cast<std::size_t>(std::ranges::count(kept_, 1)));
    for (std::uint32_t triangle = 0; triangle < kept_.size(); ++triangle)
      if (kept_[triangle]) kept.push_back(triangle);
    if (kept.empty() && !kept_.empty()) kept.push_back(0);
    return kept;
  }

 private:
  template <class Use>
  void for_each_in_chunk(std::int64_t chunk, Use use) const {
    const auto end = std::min<std::int64_t>((chunk + 1) * kChunk, static_cast<std::int64_t>(mesh_.triangles.size()));
    for (auto triangle = static_cast<std::uint32_t>(chunk * kChunk); triangle < end; ++triangle) use(triangle);
  }

  bool in_reach(std::uint32_t triangle) const {
    return !samples_in(triangle_box(mesh_, triangle).grown(reach_), grid_).empty();
  }

  // An entry is a triangle's hash above its index, so that sorting brings equal hashes together, lowest index first.
  void sort_into_buckets() {
    std::vector<std::uint32_t> hashes(mesh_.triangles.size());
    std::vector<std::array<std::uint32_t, kBuckets>> places(static_cast<std::size_t>(chunks_));
    tbb::parallel_for(std::int64_t{0}, chunks_, [&](std::int64_t chunk) {
      auto& count = places[chunk];
      count.fill(0);
      for_each_in_chunk(chunk, [&](std::uint32_t triangle) {
        kept_[triangle] = in_reach(triangle);
        if (!kept_[triangle]) return;
        hashes[triangle] = hash(mesh_.corners(triangle));
        ++count[bucket_of(hashes[triangle])];
      });
    });
    start_[kBuckets] =
        places_from_counts(places, kBuckets, [&](std::size_t bucket, std::uint32_t place) { start_[bucket] = place; });
    entries_.resize(start_[kBuckets]);
    tbb::parallel_for(std::int64_t{0}, chunks_, [&](std::int64_t chunk) {
      for_each_in_chunk(chunk, [&](std::uint32_t triangle) {
        if (kept_[triangle])
          entries_[places[chunk][bucket_of(hashes[triangle])]++] = std::uint64_t{hashes[triangle]} << 32 | triangle;
      });
    });
  }

  // Compares each triangle with the ones of equal hash that stay. Different triangles with one hash are rare by chance
  // and could be many by design; past a few, the rest simply stays.
  void drop_copies(std::uint32_t bucket) {
    const auto begin = entries_.begin() + start_[bucket], end = entries_.begin() + start_[bucket + 1];
    std::sort(begin, end);
    constexpr std::ptrdiff_t kMostCompared = 8;
    std::array<std::uint32_t, kMostCompared> originals;
    std::ptrdiff_t count = 0;
    for (auto entry = begin; entry != end; ++entry) {
      if (entry == begin || *entry >> 32 != *(entry - 1) >> 32) count = 0;
      const auto triangle = static_cast<std::uint32_t>(*entry);
      const bool alone = count == 0 && (entry + 1 == end || *entry >> 32 != *(entry + 1) >> 32);
      if (alone) continue;
      const auto corners = mesh_.corners(triangle);
      const auto is_original = [&](std::uint32_t other) { return same_bits(corners, mesh_.corners(other)); };
      if (std::any_of(originals.begin(), originals.begin() + count, is_original))
        kept_[triangle] = 0;
      else if (count < kMostCompared)
        originals[count++] = triangle;
    }
  }

  MeshView mesh_;
  const Grid& grid_;
  std::int64_t chunks_;
  double reach_;
  std::vector<std::uint8_t> kept_;
  std::vector<std::uint64_t> entries_;
  std::array<std::uint32_t, kBuckets + 1> start_{};
};

}  // namespace

std::vector<std::uint32_t> kept_by_exact_rule(MeshView mesh, const Grid& grid, double thickness) {
  return ExactRule(mesh, grid, thickness).kept();
}

}  // namespace standoff
