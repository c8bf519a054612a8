// SPDX-License-Identifier: Apache-2.0
// The skip rules: which triangles are left out before any distance is computed.
#include "field/skip.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

#include "core/hashes.h"
#include "core/progress.h"
#include "core/threads.h"
#include "field/prepare.h"
#include "geometry/predicates.h"
#include "geometry/triangle_box.h"

namespace standoff {

std::vector<std::uint32_t> kept_triangles(MeshView mesh, const Grid& grid, double thickness, SkipRule rule) {
  if (const SkipRow* row = find_skip_rule(rule.kind)) return row->kept(mesh, grid, thickness, rule.fraction);
  std::vector<std::uint32_t> all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

std::int64_t skip_bytes(std::int64_t triangles, SkipRule rule) {
  const SkipRow* row = find_skip_rule(rule.kind);
  return triangles * (row ? row->bytes_per_triangle : std::int64_t{sizeof(std::uint32_t)});
}

namespace {

using CornerBits = std::array<std::uint64_t, 9>;

// Compares bits, not values: 0 equals -0, but their results may differ.
CornerBits corner_bits_of(MeshView mesh, std::uint32_t triangle) {
  return std::bit_cast<CornerBits>(Corners(mesh.corners(triangle)));
}

std::uint64_t corner_hash(const CornerBits& bits) {
  std::uint64_t h = 0;
  for (const std::uint64_t word : bits) {
    h = (h ^ word) * kSplitmixStep;
    h ^= h >> 32;
  }
  return h;
}

// Triangles of a chunk; chunks are hashed in parallel.
constexpr std::int64_t kChunk = std::int64_t{1} << 14;
// Entries are sorted in buckets by the top bits of their hash: a bucket fits into a near cache.
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
        hashes[triangle] = static_cast<std::uint32_t>(corner_hash(corner_bits_of(mesh_, triangle)));
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

  // Compares each triangle with the triangles of equal hash that stay. Different triangles rarely have one hash by
  // chance, but an attacker could make many; past a few, the rest simply stays.
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
      const CornerBits bits = corner_bits_of(mesh_, triangle);
      const auto is_original = [&](std::uint32_t other) { return bits == corner_bits_of(mesh_, other); };
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

namespace {

std::size_t number_among(MeshView mesh, std::span<const std::uint32_t> among) {
  return among.empty() ? mesh.triangles.size() : among.size();
}
std::uint32_t nth_among(std::span<const std::uint32_t> among, std::size_t n) {
  return among.empty() ? static_cast<std::uint32_t>(n) : among[n];
}

// A hash table of triangles by their corners, with linear probing.
class CornerTable {
 public:
  CornerTable(MeshView mesh, std::size_t most) : mesh_(mesh), places_(most + most / 4 + 1, kNoTriangle) {}

  /// Returns whether a triangle with the same corners was added before.
  bool add(std::uint32_t triangle) {
    // An attacker could make many triangles of one hash: past this number, the rest counts as new.
    constexpr int kMostCompared = 64;
    const CornerBits bits = corner_bits_of(mesh_, triangle);
    std::size_t place = static_cast<std::size_t>((corner_hash(bits) >> 32) * places_.size() >> 32);
    for (int n = 0; n < kMostCompared; ++n) {
      if (places_[place] == kNoTriangle) {
        places_[place] = triangle;
        return false;
      }
      if (corner_bits_of(mesh_, places_[place]) == bits) return true;
      if (++place == places_.size()) place = 0;
    }
    return false;
  }

 private:
  MeshView mesh_;
  std::vector<std::uint32_t> places_;
};

}  // namespace

// If a triangle has m - 1 other copies on average, about k^2 / 2n (m - 1) pairs of k random triangles are copies: with
// k = 8 sqrt(n), that is 32 (m - 1). A triangle that was taken twice is no copy.
bool has_many_copies(MeshView mesh, std::span<const std::uint32_t> among) {
  const std::size_t all = number_among(mesh, among);
  const auto taken = std::min(all, static_cast<std::size_t>(8 * std::sqrt(static_cast<double>(all))));
  // Hashes with the triangles that have them: one that was taken twice then lies beside itself.
  std::vector<std::pair<std::uint64_t, std::uint32_t>> some(taken);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, taken, 1024), [&](const auto& range) {
    for (std::size_t n = range.begin(); n < range.end(); ++n) {
      const std::uint32_t triangle = nth_among(among, taken == all ? n : static_cast<std::size_t>(splitmix64(n) % all));
      some[n] = {corner_hash(corner_bits_of(mesh, triangle)), triangle};
    }
  });
  std::ranges::sort(some);
  some.erase(std::unique(some.begin(), some.end()), some.end());
  double pairs = 0;
  for (auto next = some.begin(); next != some.end();) {
    const auto first = next;
    next = std::find_if(next, some.end(), [&](const auto& one) { return one.first != first->first; });
    const auto same = static_cast<double>(next - first);
    pairs += same * (same - 1) / 2;
  }
  const auto k = static_cast<double>(some.size());
  return pairs > 0 && 8 * pairs * static_cast<double>(all) >= k * k;  // m - 1 >= 1/4
}

std::vector<std::uint32_t> without_many_copies(MeshView mesh, std::span<const std::uint32_t> among,
                                               ProgressMeter& progress) {
  if (!has_many_copies(mesh, among)) return {};
  const std::size_t all = number_among(mesh, among);
  std::vector<bool> is_copy(all);
  std::size_t copies = 0;
  {
    CornerTable table(mesh, all);
    WorkCheck check(progress, 1 << 16);
    for (std::size_t n = 0; n < all; ++n) {
      is_copy[n] = table.add(nth_among(among, n));
      copies += is_copy[n];
      check.add(1);
    }
  }
  std::vector<std::uint32_t> kept;
  if (copies == 0) return kept;
  kept.reserve(all - copies);
  for (std::size_t n = 0; n < all; ++n)
    if (!is_copy[n]) kept.push_back(nth_among(among, n));
  return kept;
}

}  // namespace standoff
