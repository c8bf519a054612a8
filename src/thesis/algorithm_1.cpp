// SPDX-License-Identifier: Apache-2.0
// The method `thesis` on the CPU: Algorithm 1 of the 2008 thesis (docs/thesis.md).
#include "thesis/thesis.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>

#include "field/cpu/bins.h"
#include "field/cpu/kernels.h"
#include "geometry/triple.h"
#include "thesis/thesis_distance.h"

namespace standoff::cpu {

// Four floats in a vector type of g++ and clang, which every processor can add at once. It is for loops that need not
// be compiled once per instruction set, and that compilers do not vectorise because they contain selections.

namespace {

struct Four {
  typedef float Lanes __attribute__((vector_size(16)));
  typedef int Mask __attribute__((vector_size(16)));
  Lanes v;

  Four() = default;
  STANDOFF_INLINE Four(Lanes lanes) : v(lanes) {}
  /// The same number in all lanes.
  STANDOFF_INLINE explicit Four(float a) : v{a, a, a, a} {}
  STANDOFF_INLINE explicit Four(double a) : Four(static_cast<float>(a)) {}
  STANDOFF_INLINE explicit Four(int a) : Four(static_cast<float>(a)) {}

  static STANDOFF_INLINE Four load(const float* p) {
    Four f;
    __builtin_memcpy(&f.v, p, sizeof f.v);
    return f;
  }
  STANDOFF_INLINE void store(float* p) const { __builtin_memcpy(p, &v, sizeof v); }

  friend STANDOFF_INLINE Four operator+(const Four& a, const Four& b) { return a.v + b.v; }
  friend STANDOFF_INLINE Four operator-(const Four& a, const Four& b) { return a.v - b.v; }
  friend STANDOFF_INLINE Four operator*(const Four& a, const Four& b) { return a.v * b.v; }
};

// The same as in geometry/triple.h, lane by lane.
STANDOFF_INLINE Four min(const Four& a, const Four& b) { return a.v < b.v ? a.v : b.v; }
STANDOFF_INLINE Four max(const Four& a, const Four& b) { return a.v > b.v ? a.v : b.v; }
STANDOFF_INLINE Four::Mask less(const Four& a, const Four& b) { return a.v < b.v; }
STANDOFF_INLINE Four select(Four::Mask condition, const Four& yes, const Four& no) { return condition ? yes.v : no.v; }

// Samples of a row are measured four at a time. The last ones may lie past the triangle's box, where distances are
// valid too, or past the brick, where rows have spare room.
constexpr int kLanesAtOnce = 4;
constexpr int kRow = kBrickSide + kLanesAtOnce;
constexpr std::int64_t kTrianglesAtOnce = 2048;  // triangles of a brick in one task

// Data that the bricks share. Lengths are in grid units (lattice.h), positions relative to the brick's centre.
struct Shared {
  const Job& job;
  VisitedSamples* visited;
  BlockLattice lattice;
  float coordinate[3][kRow];  // the samples of a brick, per axis

  Shared(const Job& j, VisitedSamples* visit)
      : job(j), visited(visit), lattice(make_block_lattice(j.grid, j.thickness)) {
    for (int axis = 0; axis < 3; ++axis)
      for (int sample = 0; sample < kRow; ++sample) coordinate[axis][sample] = brick_coordinate(lattice, sample, axis);
  }

  SampleRange samples(const Brick& brick) const {
    return intersection(samples_of_brick({brick.at[0], brick.at[1], brick.at[2]}),
                        {{0, 0, 0}, {lattice.size[0], lattice.size[1], lattice.size[2]}});
  }
};

// The nearest triangle of every sample of a brick so far.
struct BrickSamples {
  alignas(64) float distance_sq[kBrickSide][kBrickSide][kRow];  // z, y, x
  alignas(64) std::uint32_t nearest[kBrickSide][kBrickSide][kRow];

  explicit BrickSamples(bool with_nearest) {
    std::fill_n(&distance_sq[0][0][0], kBrickSide * kBrickSide * kRow, std::numeric_limits<float>::infinity());
    if (with_nearest) std::fill_n(&nearest[0][0][0], kBrickSide * kBrickSide * kRow, kNoTriangle);
  }
};

// The inner loop of Algorithm 1, over `count` samples of a row. Triangles come in ascending order, so a strict
// comparison keeps the lowest index of equally near ones.
template <bool kNearest>
void lower_row(const ThesisTriangle<Four>& triangle, std::uint32_t index, const float* x, float y, float z, int count,
               float* distance_sq, std::uint32_t* nearest) {
  for (int first = 0; first < count; first += kLanesAtOnce) {
    const Four d = standoff::distance_sq(triangle, Triple<Four>{Four::load(x + first), Four(y), Four(z)});
    const Four before = Four::load(distance_sq + first);
    if constexpr (kNearest)
      for (int n = 0; n < kLanesAtOnce; ++n)
        if (d.v[n] < before.v[n]) nearest[first + n] = index;
    min(d, before).store(distance_sq + first);
  }
}

// Gathers the triangles of a brick: the body of a reduction over them, so that many triangles in few bricks, as in the
// thesis's minimum grids, are work for all threads. The result does not depend on how the reduction cuts them: neither
// do least values, and the left part, which has the lower indices, wins ties.
class Gather {
 public:
  Gather(const Shared& shared, const Brick& brick, std::span<const std::uint32_t> refs, bool with_nearest)
      : shared_(shared),
        brick_(brick),
        refs_(refs),
        with_nearest_(with_nearest),
        samples_(std::make_unique<BrickSamples>(with_nearest)) {}
  Gather(Gather& other, tbb::split) : Gather(other.shared_, other.brick_, other.refs_, other.with_nearest_) {}

  void operator()(const tbb::blocked_range<std::size_t>& part) {
    for (std::size_t n = part.begin(); n < part.end(); ++n) {
      if (with_nearest_)
        add<true>(refs_[n]);
      else
        add<false>(refs_[n]);
      // Check often enough that cancelling is quick, even if each triangle reaches every sample.
      constexpr std::size_t kAsk = 256;
      if (n % kAsk == 0) shared_.job.progress.advance(0);
    }
  }

  void join(const Gather& right) {
    examined_ += right.examined_;
    for (int z = 0; z < kBrickSide; ++z)
      for (int y = 0; y < kBrickSide; ++y)
        for (int x = 0; x < kBrickSide; ++x)
          if (right.samples_->distance_sq[z][y][x] < samples_->distance_sq[z][y][x]) {
            samples_->distance_sq[z][y][x] = right.samples_->distance_sq[z][y][x];
            if (with_nearest_) samples_->nearest[z][y][x] = right.samples_->nearest[z][y][x];
          }
  }

  const BrickSamples& samples() const { return *samples_; }
  std::int64_t examined() const { return examined_; }

 private:
  template <bool kNearest>
  void add(std::uint32_t index) {
    const MeshView& mesh = shared_.job.mesh;
    const auto [a, b, c] = mesh.corners(index);
    const Triple<double> corner[3] = {triple_of(a), triple_of(b), triple_of(c)};
    const SampleRange all = shared_.samples(brick_);
    const SampleRange range = intersection(shared_.visited(corner, shared_.job.grid, shared_.job.thickness), all);
    if (range.empty()) return;
    examined_ += range.count();
    const Triple<double> center{brick_.center[0], brick_.center[1], brick_.center[2]};
    const auto triangle = thesis_triangle<Four>(shared_.lattice, corner, center);
    const int x0 = static_cast<int>(range.begin.x - all.begin.x), count = static_cast<int>(range.end.x - range.begin.x);
    for (auto z = range.begin.z - all.begin.z; z < range.end.z - all.begin.z; ++z)
      for (auto y = range.begin.y - all.begin.y; y < range.end.y - all.begin.y; ++y)
        lower_row<kNearest>(triangle, index, shared_.coordinate[0] + x0, shared_.coordinate[1][y],
                            shared_.coordinate[2][z], count, samples_->distance_sq[z][y] + x0,
                            samples_->nearest[z][y] + x0);
  }

  const Shared& shared_;
  const Brick& brick_;
  std::span<const std::uint32_t> refs_;
  bool with_nearest_;
  std::unique_ptr<BrickSamples> samples_;
  std::int64_t examined_ = 0;
};

// Writes the finished tiles of a brick to the sink; returns the number of its samples in the band.
std::int64_t emit(const Shared& shared, const Brick& brick, const BrickSamples& samples, Sink& sink) {
  constexpr int side = DistanceField::kTileSide;
  const SampleRange all = shared.samples(brick);
  const int size[3] = {static_cast<int>(all.end.x - all.begin.x), static_cast<int>(all.end.y - all.begin.y),
                       static_cast<int>(all.end.z - all.begin.z)};
  const float limit = shared.lattice.thickness_world, unscale = shared.lattice.unscale;
  std::int64_t band = 0;
  float values[side][side][side];
  for (int tile = 0; tile < kBrickTiles; ++tile) {
    const int x0 = side * (tile & 1), y0 = side * (tile >> 1 & 1), z0 = side * (tile >> 2);
    const int nx = std::min(side, size[0] - x0), ny = std::min(side, size[1] - y0), nz = std::min(side, size[2] - z0);
    bool needed = false;
    for (int z = 0; z < nz; ++z)
      for (int y = 0; y < ny; ++y)
        for (int x = 0; x < nx; ++x) {
          const float value = std::sqrt(samples.distance_sq[z0 + z][y0 + y][x0 + x]) * unscale;
          values[z][y][x] = value;
          band += value <= limit;
          needed |= value <= limit;
        }
    if (!needed) continue;
    const TileTarget target =
        sink.open(2 * brick.at[0] + (tile & 1), 2 * brick.at[1] + (tile >> 1 & 1), 2 * brick.at[2] + (tile >> 2));
    for (int z = 0; z < target.size.z; ++z)
      for (int y = 0; y < target.size.y; ++y)
        for (int x = 0; x < target.size.x; ++x) {
          const bool inside = x < nx && y < ny && z < nz;
          const std::int64_t at = x + target.row * y + target.slice * z;
          target.values[at] = inside ? std::min(values[z][y][x], limit) : limit;
          if (target.nearest)
            target.nearest[at] =
                inside && values[z][y][x] <= limit ? samples.nearest[z0 + z][y0 + y][x0 + x] : kNoTriangle;
        }
  }
  return band;
}

}  // namespace

Counts run_in_boxes(const Job& job, Sink& sink, VisitedSamples* visited) {
  const Shared shared(job, visited);
  std::atomic<std::int64_t> examined{0}, band{0};
  const auto gather_batch = [&](const Bins& bins) {
    tbb::parallel_for(std::int64_t{0}, bins.bricks(), [&](std::int64_t n) {
      const auto refs = bins.of(n);
      if (!refs.empty()) {
        const Brick brick = brick_at(shared.lattice, bins.first_brick + n);
        Gather gather(shared, brick, refs, sink.with_nearest());
        // Isolation keeps a thread that waits for the other parts of its brick from beginning another brick.
        tbb::this_task_arena::isolate([&] {
          tbb::parallel_reduce(tbb::blocked_range<std::size_t>(0, refs.size(), kTrianglesAtOnce), gather,
                               tbb::simple_partitioner());
        });
        examined += gather.examined();
        band += emit(shared, brick, gather.samples(), sink);
      }
      job.progress.advance();
    });
  };
  for_each_batch(job, shared.lattice, most_refs(job.triangle_count()), gather_batch, Reach::box);
  return {examined, band};
}

Counts run_thesis(const Job& job, Sink& sink) {
  job.progress.stage("distances", brick_count(job.grid), 0.2, 1);
  return run_in_boxes(job, sink, visited_samples);
}

std::int64_t thesis_scratch_bytes(const MeshLoad& mesh, const Grid& grid, double thickness, int threads) {
  return bins_scratch_bytes(mesh, make_block_lattice(grid, thickness), most_refs(mesh.triangles), threads) +
         2 * static_cast<std::int64_t>(sizeof(BrickSamples)) * threads;
}

}  // namespace standoff::cpu
