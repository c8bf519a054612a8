#include "field/cpu/bins.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "geometry/triangle_frame.h"

namespace standoff::cpu {
namespace {

// A triangle's bricks in 32 bits: the lowest brick's index and, per axis, whether the next one is touched as well.
// Enough for all but long triangles and grids of more than 2^29 bricks, which are looked at again when they are needed.
constexpr std::uint32_t kNowhere = 0xffffffffu;
constexpr std::uint32_t kLong = 0xfffffffeu;
constexpr int kSpanBits = 3;
constexpr std::int64_t kMostKeyedBricks = (std::int64_t{1} << (32 - kSpanBits)) - 1;

// Triangles between two chances for the caller to stop; long ones may touch a million bricks each.
constexpr std::int64_t kCheckEvery = 256;

// What rounding may add to a box or a distance, in samples or grid units: far above double's, far below one sample.
constexpr double kSlack = 1e-6;

struct BrickRange {
  std::int64_t low[3], high[3];  // inclusive; low > high on some axis for none
  bool empty() const { return low[0] > high[0] || low[1] > high[1] || low[2] > high[2]; }
};

class Binning {
 public:
  Binning(const Job& job, const Lattice& lattice, Reach kind) : job_(job), lattice_(lattice), kind_(kind) {
    for (int axis = 0; axis < 3; ++axis) {
      to_samples_[axis] = 1 / lattice.spacing[axis];
      reach_[axis] = job.thickness * to_samples_[axis] + 2 * kSlack;
    }
    const double scale = lattice.scale;
    double brick_radius_sq = 0;
    for (const double h : lattice.spacing) {
      const double half = h * scale * (kBrickSide - 1) / 2;
      brick_radius_sq += half * half;
    }
    const double reach = (job.thickness * scale + std::sqrt(brick_radius_sq)) * (1 + kSlack);
    reach_sq_ = reach * reach;
  }

  /// The bricks with samples in the triangle's grown box.
  BrickRange range(std::uint32_t triangle) const {
    const Vec3 a = job_.mesh.corner(triangle, 0), b = job_.mesh.corner(triangle, 1), c = job_.mesh.corner(triangle, 2);
    const Vec3 low = min(a, min(b, c)), high = max(a, max(b, c));
    const double lows[3] = {low.x, low.y, low.z}, highs[3] = {high.x, high.y, high.z};
    BrickRange range;
    for (int axis = 0; axis < 3; ++axis) {
      const double last = static_cast<double>(lattice_.size[axis] - 1);
      const double from = (lows[axis] - lattice_.origin[axis]) * to_samples_[axis] - reach_[axis];
      const double to = (highs[axis] - lattice_.origin[axis]) * to_samples_[axis] + reach_[axis];
      // The first sample at or above `from` and the last at or below `to`, by truncation of what is not negative.
      const auto first_sample = static_cast<std::int64_t>(std::clamp(from + (1 - kSlack), 0.0, last + 1));
      const auto last_sample = static_cast<std::int64_t>(std::clamp(to + 1, 0.0, last + 1)) - 1;
      range.low[axis] = first_sample / kBrickSide;
      range.high[axis] = last_sample < first_sample ? -1 : last_sample / kBrickSide;
    }
    return range;
  }

  std::int64_t index(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return x + lattice_.bricks[0] * (y + lattice_.bricks[1] * z);
  }

  std::uint32_t key(std::uint32_t triangle) const {
    const BrickRange r = range(triangle);
    if (r.empty()) return kNowhere;
    const std::int64_t spans[3] = {r.high[0] - r.low[0], r.high[1] - r.low[1], r.high[2] - r.low[2]};
    const std::int64_t lowest = index(r.low[0], r.low[1], r.low[2]);
    if ((spans[0] | spans[1] | spans[2]) > 1 || lowest >= kMostKeyedBricks) return kLong;
    return static_cast<std::uint32_t>((lowest << kSpanBits) | spans[0] | (spans[1] << 1) | (spans[2] << 2));
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
  // A long triangle misses most bricks of its box: take those whose centre is near enough.
  template <class Use>
  void for_each_brick_of_long(std::uint32_t triangle, Use use) const {
    const BrickRange r = range(triangle);
    const Brick first = brick_at(lattice_, index(r.low[0], r.low[1], r.low[2]));
    Triple<double> corner[3];
    for (int which = 0; which < 3; ++which) {
      const Vec3 v = job_.mesh.corner(triangle, which) * lattice_.scale;
      corner[which] = {v.x - first.center[0], v.y - first.center[1], v.z - first.center[2]};
    }
    const TriangleFrame<double> frame = make_frame(corner[0], corner[1], corner[2], 1e-24);
    const double step[3] = {lattice_.spacing[0] * lattice_.scale * kBrickSide,
                            lattice_.spacing[1] * lattice_.scale * kBrickSide,
                            lattice_.spacing[2] * lattice_.scale * kBrickSide};
    for (std::int64_t z = r.low[2]; z <= r.high[2]; ++z)
      for (std::int64_t y = r.low[1]; y <= r.high[1]; ++y)
        for (std::int64_t x = r.low[0]; x <= r.high[0]; ++x) {
          const Triple<double> center{step[0] * static_cast<double>(x - r.low[0]),
                                      step[1] * static_cast<double>(y - r.low[1]),
                                      step[2] * static_cast<double>(z - r.low[2])};
          if (kind_ == Reach::box || distance_sq(frame, center) <= reach_sq_) use(index(x, y, z));
        }
  }

  const Job& job_;
  const Lattice& lattice_;
  Reach kind_;
  double to_samples_[3];
  double reach_[3];  // of a triangle's box, in samples
  double reach_sq_;  // from a brick's centre, grid units
};

// Triangles are counted and sorted in chunks side by side, each with counters of its own: as many chunks as help, as
// long as the counters stay small.
std::int64_t chunk_count(std::int64_t triangles, std::int64_t bricks, int threads) {
  constexpr std::int64_t kMostCounters = std::int64_t{4} << 20;
  constexpr std::int64_t kLeastTriangles = 4096;
  return std::max<std::int64_t>(
      1, std::min({std::int64_t{4} * threads, kMostCounters / bricks, triangles / kLeastTriangles}));
}

}  // namespace

void for_each_batch(const Job& job, const Lattice& lattice, std::int64_t most_refs,
                    const std::function<void(const Bins&)>& use, Reach reach) {
  const Binning binning(job, lattice, reach);
  const std::int64_t triangles = job.triangle_count(), bricks = lattice.brick_count();
  const std::int64_t chunks = chunk_count(triangles, bricks, job.threads);
  const auto chunk_begin = [&](std::int64_t chunk) { return triangles * chunk / chunks; };

  std::vector<std::uint32_t> keys(static_cast<std::size_t>(triangles));
  std::vector<std::vector<std::uint32_t>> counts(static_cast<std::size_t>(chunks));
  tbb::parallel_for(std::int64_t{0}, chunks, [&](std::int64_t chunk) {
    auto& count = counts[chunk];
    count.assign(static_cast<std::size_t>(bricks), 0);
    for (std::int64_t n = chunk_begin(chunk); n < chunk_begin(chunk + 1); ++n) {
      if (n % kCheckEvery == 0) job.progress.check();
      const std::uint32_t triangle = job.triangle(n);
      keys[n] = binning.key(triangle);
      binning.for_each_brick(triangle, keys[n], [&](std::int64_t brick) { ++count[brick]; });
    }
  });

  // Room for the largest batch, so that no batch has to move to a larger place while the old one is still held.
  std::int64_t all = 0, fullest = 0;
  for (std::int64_t brick = 0; brick < bricks; ++brick) {
    std::int64_t here = 0;
    for (const auto& count : counts) here += count[brick];
    all += here;
    fullest = std::max(fullest, here);
  }
  Bins bins;
  bins.refs.reserve(static_cast<std::size_t>(std::min(all, std::max(most_refs, fullest))));
  bins.start.reserve(static_cast<std::size_t>(bricks + 1));
  for (std::int64_t first = 0; first < bricks;) {
    // Take bricks until the batch is full, turning counts into positions.
    bins.first_brick = first;
    bins.start.clear();
    std::int64_t total = 0, end = first;
    for (; end < bricks; ++end) {
      std::int64_t here = 0;
      for (const auto& count : counts) here += count[end];
      if (end > first && total + here > most_refs) break;
      bins.start.push_back(static_cast<std::uint32_t>(total));
      for (auto& count : counts) {
        const std::uint32_t mine = count[end];
        count[end] = static_cast<std::uint32_t>(total);
        total += mine;
      }
    }
    bins.start.push_back(static_cast<std::uint32_t>(total));
    bins.refs.resize(static_cast<std::size_t>(total));
    tbb::parallel_for(std::int64_t{0}, chunks, [&](std::int64_t chunk) {
      auto& position = counts[chunk];
      for (std::int64_t n = chunk_begin(chunk); n < chunk_begin(chunk + 1); ++n) {
        if (n % kCheckEvery == 0) job.progress.check();
        const std::uint32_t triangle = job.triangle(n);
        binning.for_each_brick(triangle, keys[n], [&](std::int64_t brick) {
          if (brick >= first && brick < end) bins.refs[position[brick]++] = triangle;
        });
      }
    });
    use(bins);
    first = end;
  }
}

std::int64_t bins_scratch_bytes(std::int64_t triangles, const Lattice& lattice, std::int64_t most_refs, int threads) {
  const std::int64_t keys = triangles, bricks = lattice.brick_count();
  const std::int64_t counters = bricks * (chunk_count(triangles, bricks, threads) + 1) + 1;
  // No triangle is in more bricks than there are.
  const double entries = static_cast<double>(triangles) * static_cast<double>(bricks);
  const std::int64_t refs = entries < static_cast<double>(most_refs) ? static_cast<std::int64_t>(entries) : most_refs;
  return static_cast<std::int64_t>(sizeof(std::uint32_t)) * (keys + refs + counters);
}

}  // namespace standoff::cpu
