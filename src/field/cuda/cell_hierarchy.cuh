// SPDX-License-Identifier: Apache-2.0
// Thick bands and full fields: candidates pass down from coarse cells to fine ones. A cell starts from its parent's
// candidates and drops those that cannot be nearest to any of its samples (docs/cuda.md derives the three tests).
//
// A step leads from parents to their eight children. A block of threads takes a chunk of a parent's candidates, and
// goes through it with a thread per candidate.
//   bound    finds for each child a bound of the distance at its centre, and the triangle that gives it
//   keep     decides which children keep each candidate, and counts them
//   hand     writes the candidates into the children's lists
#pragma once

#include "field/cuda/bin.cuh"
#include "field/lattice.h"
#include "gpu/warp.cuh"

namespace standoff {

// A level of cells: level 0 is the tiles, each higher level joins 2x2x2 cells, the last one is a single cell.

struct Level {
  std::int64_t side;  // samples per axis of a cell
  std::int64_t cells[3];

  STANDOFF_HD std::int64_t count() const { return cells[0] * cells[1] * cells[2]; }
};

inline Level level_of(const Lattice& l, int number) {
  Level level{std::int64_t{kTileSide} << number, {}};
  for (int axis = 0; axis < 3; ++axis) level.cells[axis] = (l.size[axis] + level.side - 1) / level.side;
  return level;
}

/// The number of the level with a single cell.
inline int top_level(const Lattice& l) {
  int number = 0;
  while (level_of(l, number).count() > 1) ++number;
  return number;
}

/// A box around the samples of a cell inside the grid. Grid units.
struct CellBox {
  Triple<double> center;
  float half[3], radius;  // with a margin for rounding
};

STANDOFF_INLINE CellBox cell_at(const Lattice& l, const Level& level, const std::int64_t* at) {
  CellBox cell;
  double middle[3];
  float radius_sq = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t first = at[axis] * level.side;
    const std::int64_t past = first + level.side < l.size[axis] ? first + level.side : l.size[axis];
    middle[axis] = static_cast<double>(first + past - 1) / 2;
    cell.half[axis] = static_cast<float>(static_cast<double>(past - 1 - first) / 2 * l.unit[axis]) * (1 + kSlackRatio);
    radius_sq += cell.half[axis] * cell.half[axis];
  }
  cell.center = position(l, middle[0], middle[1], middle[2]);
  cell.radius = sqrt(radius_sq);
  return cell;
}

}  // namespace standoff

namespace standoff::STANDOFF_PLATFORM {

inline constexpr int kStepThreads = 256;
/// A chunk has at most so many candidates. It is found, and its children set up, once.
inline constexpr Counter kChunk = 4 * kStepThreads;

/// The arrays of a step.
struct Step {
  Level parent, child;
  const Counter* parent_start;          // per parent, and the end
  const std::uint32_t* parent_entries;  // triangles
  const Counter* chunk_start;           // per parent, and the end
  unsigned char* keep;                  // per parent's entry: a bit per child
  Counter* bound;                       // per child: bound (a float's bits) << 32 | triangle
  std::uint32_t* child_counts;          // per child, and a zero behind
  const Counter* child_start;
  std::uint32_t* child_entries;
};

/// Writes the root's list: all triangles. A thread per triangle.
STANDOFF_KERNEL void list_all(DeviceMesh mesh, std::uint32_t* entries, Counter* start, Outcome* outcome) {
  const std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (n == 0) {
    start[0] = 0;
    start[1] = static_cast<Counter>(mesh.used_count());
  }
  if (n >= mesh.used_count()) return;
  const std::uint32_t triangle = used_triangle(mesh, n);
  entries[n] = triangle;
  is_valid(mesh, triangle, outcome);
}

/// Writes the number of chunks of each parent, and 0 behind the last. A thread per parent.
STANDOFF_KERNEL void count_chunks(const Counter* start, std::int64_t parents, std::uint32_t* chunks, Outcome* outcome) {
  const std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (n > parents) return;
  chunks[n] = n < parents && !outcome->stopped
                  ? static_cast<std::uint32_t>((start[n + 1] - start[n] + kChunk - 1) / kChunk)
                  : 0;
}

/// Sets all bounds to infinity. A thread per child.
STANDOFF_KERNEL void clear_bounds(Counter* bound, std::int64_t children) {
  const std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (n < children) bound[n] = ~Counter{0};
}

/// A child, relative to the parent's centre.
struct Child {
  std::int64_t index;  // -1 if the grid ends before it
  Triple<float> center;
  float half[3], radius;
  float within;           // bounds the distance of its samples from the mesh, by the bound at its centre
  Triple<float> surface;  // the point of the mesh that gives the bound
};

/// The shared memory of a chunk's threads.
struct Chunk {
  Counter first, end;  // entries
  Triple<double> center;
  float extent;  // the parent's largest coordinate
  Child child[8];
  Counter least[8];
  unsigned counts[8];
  Counter base[8];
};

/// Begins a chunk; all threads of the block take part. It needs no barrier first: other threads than the first eight
/// may still read `base` of the chunk before, but this does not write `base`.
STANDOFF_DEVICE void begin_chunk(const Lattice& l, const Step& step, Counter number, Chunk& chunk) {
  const int t = static_cast<int>(threadIdx.x);
  const std::int64_t parent = t < 32 ? warp_find(step.chunk_start, step.parent.count(), number) : 0;
  if (t < 8) {
    const std::int64_t at[3] = {parent % step.parent.cells[0], parent / step.parent.cells[0] % step.parent.cells[1],
                                parent / (step.parent.cells[0] * step.parent.cells[1])};
    const CellBox whole = cell_at(l, step.parent, at);
    if (t == 0) {
      chunk.first = step.parent_start[parent] + (number - step.chunk_start[parent]) * kChunk;
      const Counter end = step.parent_start[parent + 1];
      chunk.end = chunk.first + kChunk < end ? chunk.first + kChunk : end;
      chunk.center = whole.center;
      chunk.extent = max(whole.half[0], max(whole.half[1], whole.half[2]));
    }
    const std::int64_t of_child[3] = {2 * at[0] + (t & 1), 2 * at[1] + (t >> 1 & 1), 2 * at[2] + (t >> 2)};
    Child& child = chunk.child[t];
    child.index = -1;
    if (of_child[0] < step.child.cells[0] && of_child[1] < step.child.cells[1] && of_child[2] < step.child.cells[2]) {
      const CellBox cell = cell_at(l, step.child, of_child);
      child.index = of_child[0] + step.child.cells[0] * (of_child[1] + step.child.cells[1] * of_child[2]);
      child.center = narrowed(cell.center - whole.center);
      for (int axis = 0; axis < 3; ++axis) child.half[axis] = cell.half[axis];
      child.radius = cell.radius;
    }
    chunk.least[t] = ~Counter{0};
    chunk.counts[t] = 0;
  }
  __syncthreads();
}

/// A triangle's corners and box relative to the parent's centre.
struct CandidateCorners {
  Triple<float> a, b, c;
  BoxOf<float> box;
  float slack;  // the error of a distance
};
STANDOFF_DEVICE CandidateCorners candidate_corners(const Lattice& l, const DeviceMesh& mesh, std::uint32_t triangle,
                                                   const Chunk& chunk) {
  const Corners c = corners_of(mesh, triangle);
  CandidateCorners at{narrowed(local(l, c.at[0], chunk.center)),
                      narrowed(local(l, c.at[1], chunk.center)),
                      narrowed(local(l, c.at[2], chunk.center)),
                      {},
                      0};
  at.box = box_of(at.a, at.b, at.c);
  at.slack = fma(max(farthest_coordinate(at.box), chunk.extent), kSlackOfCoordinate, kSlack);
  return at;
}
STANDOFF_DEVICE TriangleFrame<float> frame_of(const CandidateCorners& at) {
  return make_frame(at.a, at.b, at.c, float{kLeastLengthSq});
}

/// A candidate relative to the parent's centre.
struct Candidate {
  TriangleFrame<float> frame;
  BoxOf<float> box;
  float slack;
};
STANDOFF_DEVICE Candidate candidate(const Lattice& l, const DeviceMesh& mesh, std::uint32_t triangle,
                                    const Chunk& chunk) {
  const CandidateCorners at = candidate_corners(l, mesh, triangle, chunk);
  return {frame_of(at), at.box, at.slack};
}

/// Bounds of the distances of a triangle from points. The centroid of a small one is a good enough point of it, and
/// takes a tenth of the instructions.
struct UpperBounds {
  TriangleFrame<float> frame;
  Triple<float> centroid;
  float slack;
  bool by_centroid;

  STANDOFF_DEVICE float at(const Triple<float>& p) const {
    const Triple<float> from = p - centroid;
    return sqrt(by_centroid ? dot(from, from) : distance_sq(frame, p)) + slack;
  }
};
/// A triangle is small if no side of its box is longer than `small`.
STANDOFF_DEVICE UpperBounds upper_bounds(const CandidateCorners& at, float small) {
  UpperBounds bounds{{}, (at.a + at.b + at.c) * (1.0f / 3), at.slack, longest_side(at.box) <= small};
  if (!bounds.by_centroid) bounds.frame = frame_of(at);
  return bounds;
}

/// Lowers the least bound of a child by those of a warp's lanes. All lanes take part.
STANDOFF_DEVICE void lower_bound(float most, std::uint32_t triangle, Counter& least) {
  // Distances are not negative, so their order equals the order of their bits.
  const std::uint32_t bits = __float_as_uint(most), fewest = warp_min(bits);
  const std::uint32_t first = warp_min(bits == fewest ? triangle : kNoTriangle);
  if (threadIdx.x % 32 == 0) atomicMin(&least, Counter{fewest} << 32 | first);
}

STANDOFF_KERNEL void __launch_bounds__(kStepThreads)
    bound_children(Lattice l, DeviceMesh mesh, Step step, Outcome* outcome) {
  __shared__ Chunk chunk;
  if (outcome->stopped) return;
  const int t = static_cast<int>(threadIdx.x);
  const Counter chunks = step.chunk_start[step.parent.count()];
  for (Counter number = blockIdx.x; number < chunks; number += gridDim.x) {
    begin_chunk(l, step, number, chunk);
    for (Counter first = chunk.first; first < chunk.end; first += kStepThreads) {
      const Counter entry = first + static_cast<Counter>(t);
      const std::uint32_t triangle = step.parent_entries[entry < chunk.end ? entry : chunk.first];
      const UpperBounds bounds = upper_bounds(candidate_corners(l, mesh, triangle, chunk), chunk.child[0].radius / 2);
      for (int n = 0; n < 8; ++n)
        if (chunk.child[n].index >= 0) lower_bound(bounds.at(chunk.child[n].center), triangle, chunk.least[n]);
    }
    __syncthreads();
    if (t < 8 && chunk.child[t].index >= 0) atomicMin(&step.bound[chunk.child[t].index], chunk.least[t]);
  }
}

/// Whether a candidate may be nearest to a sample of the child.
STANDOFF_DEVICE bool may_be_nearest(const Lattice& l, const Candidate& c, const Child& child) {
  const float least = max(sqrt(distance_sq(c.frame, child.center)) - c.slack, 0.0f);
  const float by_distance = child.within + 2 * child.radius * (1 + kSlackRatio);
  const float by_reach = l.thickness * (1 + kSlackRatio) + child.radius;
  if (least > min(by_distance, by_reach)) return false;
  const Triple<float>& q = child.surface;
  float spread = 2 * child.half[0] * max(c.box.high.x - q.x, q.x - c.box.low.x);
  spread = fma(2 * child.half[1], max(c.box.high.y - q.y, q.y - c.box.low.y), spread);
  spread = fma(2 * child.half[2], max(c.box.high.z - q.z, q.z - c.box.low.z), spread);
  const float within = child.within * (1 + kBisectorSlack);
  return fma(least, least, -spread) < within * within;
}

/// Finds the point of the surface that bounds distances at a child's centre: the closest one of the triangle that gave
/// the bound. It may lower the bound.
STANDOFF_DEVICE void bound_by_closest_point(const Lattice& l, const DeviceMesh& mesh, const Chunk& chunk, Child& child,
                                            Counter& bound) {
  const Counter known = load_relaxed(&bound);  // blocks of the same parent lower it to the same number
  const auto triangle = static_cast<std::uint32_t>(known);
  const Candidate nearest = candidate(l, mesh, triangle, chunk);
  child.surface = closest_in_frame(nearest.frame, child.center);
  const float by_closest = sqrt(distance_sq(nearest.frame, child.center)) + nearest.slack;
  child.within = min(__uint_as_float(static_cast<std::uint32_t>(known >> 32)), by_closest);
  atomicMin(&bound, Counter{__float_as_uint(child.within)} << 32 | triangle);
}

STANDOFF_KERNEL void __launch_bounds__(kStepThreads)
    keep_candidates(Lattice l, DeviceMesh mesh, Step step, Outcome* outcome) {
  __shared__ Chunk chunk;
  if (outcome->stopped) return;
  const int t = static_cast<int>(threadIdx.x);
  const Counter chunks = step.chunk_start[step.parent.count()];
  for (Counter number = blockIdx.x; number < chunks; number += gridDim.x) {
    begin_chunk(l, step, number, chunk);
    if (t < 8 && chunk.child[t].index >= 0)
      bound_by_closest_point(l, mesh, chunk, chunk.child[t], step.bound[chunk.child[t].index]);
    __syncthreads();
    for (Counter first = chunk.first; first < chunk.end; first += kStepThreads) {
      const Counter entry = first + static_cast<Counter>(t);
      const bool mine = entry < chunk.end;
      const Candidate c = candidate(l, mesh, step.parent_entries[mine ? entry : chunk.first], chunk);
      unsigned kept = 0;
      for (int n = 0; n < 8; ++n) {
        if (chunk.child[n].index < 0) continue;
        const bool keeps = mine && may_be_nearest(l, c, chunk.child[n]);
        kept |= keeps ? 1u << n : 0u;
        const std::uint32_t votes = __ballot_sync(0xffffffffu, keeps);
        if (t % 32 == 0 && votes) atomicAdd(&chunk.counts[n], static_cast<unsigned>(__popc(votes)));
      }
      if (mine) step.keep[entry] = static_cast<unsigned char>(kept);
    }
    __syncthreads();
    if (t < 8 && chunk.counts[t] != 0) atomicAdd(&step.child_counts[chunk.child[t].index], chunk.counts[t]);
  }
}

/// Writes the block's candidates into the children's lists. Two sweeps over the chunk: the first one counts, so that
/// each child's list is lengthened once.
STANDOFF_KERNEL void __launch_bounds__(kStepThreads) hand_down(Lattice l, Step step, Outcome* outcome) {
  __shared__ Chunk chunk;
  if (outcome->stopped) return;
  const int t = static_cast<int>(threadIdx.x);
  const std::uint32_t before_me = (1u << t % 32) - 1;
  const Counter chunks = step.chunk_start[step.parent.count()];
  for (Counter number = blockIdx.x; number < chunks; number += gridDim.x) {
    begin_chunk(l, step, number, chunk);
    for (Counter first = chunk.first; first < chunk.end; first += kStepThreads) {
      const Counter entry = first + static_cast<Counter>(t);
      const unsigned kept = entry < chunk.end ? step.keep[entry] : 0;
      for (int n = 0; n < 8; ++n) {
        const std::uint32_t votes = __ballot_sync(0xffffffffu, kept >> n & 1);
        if (t % 32 == 0 && votes) atomicAdd(&chunk.counts[n], static_cast<unsigned>(__popc(votes)));
      }
    }
    __syncthreads();
    // Lists fill from their ends, which takes the counts back down to zero.
    if (t < 8 && chunk.counts[t] != 0) {
      const std::int64_t child = chunk.child[t].index;
      chunk.base[t] = step.child_start[child] + atomicSub(&step.child_counts[child], chunk.counts[t]) - chunk.counts[t];
      chunk.counts[t] = 0;
    }
    __syncthreads();
    for (Counter first = chunk.first; first < chunk.end; first += kStepThreads) {
      const Counter entry = first + static_cast<Counter>(t);
      const unsigned kept = entry < chunk.end ? step.keep[entry] : 0;
      const std::uint32_t triangle = kept ? step.parent_entries[entry] : 0;
      for (int n = 0; n < 8; ++n) {
        const std::uint32_t votes = __ballot_sync(0xffffffffu, kept >> n & 1);
        if (votes == 0) continue;
        unsigned place = 0;
        if (t % 32 == 0) place = atomicAdd(&chunk.counts[n], static_cast<unsigned>(__popc(votes)));
        place = __shfl_sync(0xffffffffu, place, 0) + static_cast<unsigned>(__popc(votes & before_me));
        if (kept >> n & 1) step.child_entries[chunk.base[n] + place] = triangle;
      }
    }
    __syncthreads();
  }
}

}  // namespace standoff::STANDOFF_PLATFORM
