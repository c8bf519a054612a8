// SPDX-License-Identifier: Apache-2.0
#include "field/cpu/bins.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include "field/lattice.h"

namespace standoff::cpu {
namespace {

// The bricks of a triangle in 32 bits: the lowest brick's index and, per axis, whether the next one is touched as well.
// Long triangles, and grids of 2^29 bricks or 2^31 samples on an axis, do not fit: their bricks are computed again when
// needed.
constexpr std::uint32_t kNowhere = 0xffffffffu;
constexpr std::uint32_t kLong = 0xfffffffeu;
constexpr int kSpanBits = 3;
constexpr std::int64_t kMostKeyedBricks = (std::int64_t{1} << (32 - kSpanBits)) - 1,
                       kMostKeyedSamples = std::numeric_limits<std::int32_t>::max();

// Triangles between two checks whether the caller wants to stop; a long one may touch a million bricks.
constexpr std::int64_t kCheckEvery = 256;

// Chunks of triangles are counted and sorted in parallel, each with its own counters: use as many chunks as help while
// the counters stay small.
std::int64_t chunk_count(std::int64_t triangles, std::int64_t bricks, int threads) {
  constexpr std::int64_t kMostCounters = std::int64_t{4} << 20;
  constexpr std::int64_t kLeastTriangles = 4096;
  return std::max<std::int64_t>(
      1, std::min({std::int64_t{4} * threads, kMostCounters / bricks, triangles / kLeastTriangles}));
}

// Which bricks each triangle reaches.
class Binning {
 public:
  Binning(const Job& job, const BlockLattice& lattice, Reach kind, const Region* regions)
      : job_(job),
        mesh_(memory_of(job.mesh)),
        lattice_(lattice),
        kernels_(kernels_for(job.simd)),
        kind_(kind),
        regions_(regions),
        reach_sq_(cell_reach_sq<kBrickSide>(lattice)),
        has_keys_(lattice.brick_count() <= kMostKeyedBricks && std::ranges::max(lattice.size) <= kMostKeyedSamples) {}

  /// The keys of the job's triangles first, first + 1, ..., at most kReachLanes of them.
  void make_keys(std::int64_t first, std::int64_t count, std::uint32_t* keys) const {
    if (!has_keys_) return static_cast<void>(std::fill_n(keys, count, kLong));
    std::uint32_t triangles[kReachLanes];
    for (std::int64_t n = 0; n < kReachLanes; ++n) triangles[n] = job_.triangle(first + std::min(n, count - 1));
    BrickRanges ranges;
    kernels_.reached_bricks(lattice_, mesh_, triangles, regions_, ranges);
    for (std::int64_t n = 0; n < count; ++n) keys[n] = key(ranges, n);
  }

  /// Calls use(brick) for each brick of the triangle whose key is `key`.
  template <class Use>
  void for_each_brick(std::uint32_t triangle, std::uint32_t key, Use use) const {
    if (key == kNowhere) return;
    if (key == kLong) return for_each_brick_of_long(triangle, use);
    const std::int64_t lowest = key >> kSpanBits, along_y = lattice_.bricks[0], along_z = along_y * lattice_.bricks[1];
    for (unsigned z = 0; z <= (key >> 2 & 1); ++z)
      for (unsigned y = 0; y <= (key >> 1 & 1); ++y)
        for (unsigned x = 0; x <= (key & 1); ++x) use(lowest + x + along_y * y + along_z * z);
  }

 private:
  std::int64_t index(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return x + lattice_.bricks[0] * (y + lattice_.bricks[1] * z);
  }

  std::uint32_t key(const BrickRanges& r, std::int64_t n) const {
    std::uint32_t span[3];
    for (int axis = 0; axis < 3; ++axis) {
      if (r.low[axis][n] > r.high[axis][n]) return kNowhere;
      span[axis] = static_cast<std::uint32_t>(r.high[axis][n] - r.low[axis][n]);
    }
    if ((span[0] | span[1] | span[2]) > 1) return kLong;
    const auto lowest = static_cast<std::uint32_t>(index(r.low[0][n], r.low[1][n], r.low[2][n]));
    return (lowest << kSpanBits) | span[0] | (span[1] << 1) | (span[2] << 2);
  }

  // A long triangle misses most bricks of its box: take the bricks whose centre is near enough, in groups of eight.
  template <class Use>
  void for_each_brick_of_long(std::uint32_t triangle, Use use) const {
    const auto [a, b, c] = job_.mesh.corners(triangle);
    const Triple<double> corner[3] = {triple_of(a), triple_of(b), triple_of(c)};
    const CellRange r = reached_cells<kBrickSide>(lattice_, box_of(corner[0], corner[1], corner[2]));
    if (r.empty()) return;
    const LongTriangle<kBrickSide> long_triangle(lattice_, r, corner);
    double at[3][kReachLanes] = {};
    std::int64_t bricks[kReachLanes];
    unsigned count = 0;
    const auto use_group = [&] {
      const unsigned all = (1u << count) - 1;
      unsigned near = kind_ == Reach::box ? all : kernels_.within(long_triangle.frame, at, reach_sq_) & all;
      for (; near != 0; near &= near - 1) use(bricks[std::countr_zero(near)]);
      count = 0;
    };
    for (std::int64_t z = r.low[2]; z <= r.high[2]; ++z)
      for (std::int64_t y = r.low[1]; y <= r.high[1]; ++y)
        for (std::int64_t x = r.low[0]; x <= r.high[0]; ++x) {
          const Triple<double> center = long_triangle.center(lattice_, x, y, z);
          at[0][count] = center.x, at[1][count] = center.y, at[2][count] = center.z;
          bricks[count++] = index(x, y, z);
          if (count == kReachLanes) use_group();
        }
    use_group();
  }

  const Job& job_;
  const MeshMemory mesh_;
  const BlockLattice& lattice_;
  const Kernels& kernels_;
  Reach kind_;
  const Region* regions_;
  double reach_sq_;  // cell_reach_sq() of a brick, grid units
  bool has_keys_;    // else all triangles count as long
};

class BinBatches {
 public:
  BinBatches(const Job& job, const BlockLattice& lattice, std::int64_t most_refs, Reach reach, const Region* regions);

  const Bins& bins() const { return bins_; }
  Bins take_bins() { return std::move(bins_); }
  // The indices of all batches.
  std::int64_t refs() const { return refs_; }
  // Replaces the batch by the next one; false if there is none.
  bool next();

 private:
  std::int64_t chunk_begin(std::int64_t chunk) const { return job_.triangle_count() * chunk / chunks_; }

  const Job& job_;
  const Binning binning_;
  std::int64_t most_refs_, bricks_, chunks_, refs_ = 0;
  std::vector<std::uint32_t> keys_;                 // by triangle
  std::vector<std::vector<std::uint32_t>> counts_;  // by chunk of triangles, by brick; later places in a batch
  Bins bins_;
};

BinBatches::BinBatches(const Job& job, const BlockLattice& lattice, std::int64_t most_refs, Reach reach,
                       const Region* regions)
    : job_(job),
      binning_(job, lattice, reach, regions),
      most_refs_(most_refs),
      bricks_(lattice.brick_count()),
      chunks_(chunk_count(job.triangle_count(), bricks_, job.threads)),
      keys_(static_cast<std::size_t>(job.triangle_count())),
      counts_(static_cast<std::size_t>(chunks_)) {
  tbb::parallel_for(std::int64_t{0}, chunks_, [&](std::int64_t chunk) {
    auto& count = counts_[chunk];
    count.assign(static_cast<std::size_t>(bricks_), 0);
    for (std::int64_t n = chunk_begin(chunk), end_of_chunk = chunk_begin(chunk + 1); n < end_of_chunk;) {
      if (n % kCheckEvery < kReachLanes) job_.progress.check();
      const std::int64_t end = std::min<std::int64_t>(n + kReachLanes, end_of_chunk);
      binning_.make_keys(n, end - n, &keys_[static_cast<std::size_t>(n)]);
      for (; n < end; ++n)
        binning_.for_each_brick(job_.triangle(n), keys_[n], [&](std::int64_t brick) { ++count[brick]; });
    }
  });

  // Reserve room for the largest batch: growing later would hold old and new memory at once.
  std::int64_t fullest = 0;
  for (std::int64_t brick = 0; brick < bricks_; ++brick) {
    std::int64_t here = 0;
    for (const auto& count : counts_) here += count[brick];
    refs_ += here;
    fullest = std::max(fullest, here);
  }
  bins_.refs.reserve(static_cast<std::size_t>(std::min(refs_, std::max(most_refs, fullest))));
  bins_.start.reserve(static_cast<std::size_t>(bricks_ + 1));
}

bool BinBatches::next() {
  // Take bricks until the batch is full, turning counts into positions.
  const std::int64_t first = bins_.end_brick();
  if (first == bricks_) return false;
  bins_.first_brick = first;
  bins_.start.clear();
  std::int64_t total = 0, end = first;
  for (; end < bricks_; ++end) {
    std::int64_t here = 0;
    for (const auto& count : counts_) here += count[end];
    if (end > first && total + here > most_refs_) break;
    bins_.start.push_back(static_cast<std::uint32_t>(total));
    for (auto& count : counts_) {
      const std::uint32_t mine = count[end];
      count[end] = static_cast<std::uint32_t>(total);
      total += mine;
    }
  }
  bins_.start.push_back(static_cast<std::uint32_t>(total));
  bins_.refs.resize(static_cast<std::size_t>(total));
  tbb::parallel_for(std::int64_t{0}, chunks_, [&](std::int64_t chunk) {
    auto& position = counts_[chunk];
    for (std::int64_t n = chunk_begin(chunk), end_of_chunk = chunk_begin(chunk + 1); n < end_of_chunk; ++n) {
      if (n % kCheckEvery == 0) job_.progress.check();
      const std::uint32_t triangle = job_.triangle(n);
      binning_.for_each_brick(triangle, keys_[n], [&](std::int64_t brick) {
        if (brick >= first && brick < end) bins_.refs[position[brick]++] = triangle;
      });
    }
  });
  return true;
}

}  // namespace

void for_each_batch(const Job& job, const BlockLattice& lattice, std::int64_t most_refs,
                    const std::function<void(const Bins&)>& use, Reach reach, const Region* regions) {
  BinBatches batches(job, lattice, most_refs, reach, regions);
  while (batches.next()) use(batches.bins());
}

std::optional<Bins> all_bins(const Job& job, const BlockLattice& lattice, std::int64_t most_refs,
                             const Region* regions) {
  BinBatches batches(job, lattice, most_refs, Reach::distance, regions);
  if (batches.refs() > most_refs) return std::nullopt;
  batches.next();
  return batches.take_bins();
}

std::int64_t bins_scratch_bytes(const MeshLoad& mesh, const BlockLattice& lattice, std::int64_t most_refs,
                                int threads) {
  const std::int64_t keys = mesh.triangles, bricks = lattice.brick_count();
  const std::int64_t counters = bricks * (chunk_count(mesh.triangles, bricks, threads) + 1) + 1;
  // No triangle is in more bricks than there are.
  const double entries = std::min(mesh.brick_refs, static_cast<double>(mesh.triangles) * static_cast<double>(bricks));
  const std::int64_t refs = entries < static_cast<double>(most_refs) ? static_cast<std::int64_t>(entries) : most_refs;
  return static_cast<std::int64_t>(sizeof(std::uint32_t)) * (keys + refs + counters);
}

}  // namespace standoff::cpu
