// SPDX-License-Identifier: Apache-2.0
// Thick bands and full fields: candidates pass down from coarse cells to fine ones. A cell starts from its parent's
// candidates and drops those that cannot be nearest to any of its samples (docs/cuda.md derives the three tests).
//
// A step leads from parents to their eight children. A block of threads takes a chunk of a parent's candidates, and
// goes through it with a thread per candidate.
//   bound    finds for each child a bound of the distance at its centre, and the triangle that gives it
//   keep     decides which children keep each candidate, and counts them
//   hand     writes the candidates into the children's lists
//
// A triangle that is not larger than a child is known well enough by its box: it is no nearer than that, and no farther
// than the box's middle and what lies between the middle and the triangle. That takes a tenth of the instructions of
// setting it up and measuring it, which larger triangles need.
#pragma once

#include "field/cuda/bin.cuh"
#include "field/cuda/culling.cuh"
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

// Four blocks to a multiprocessor, which leave 64 registers.
inline constexpr int kStepThreads = 256, kStepBlocks = 4;
/// A chunk has at most so many candidates. It is found, and its children set up, once.
inline constexpr Counter kChunk = 4 * kStepThreads;

/// A triangle's box, relative to the grid's centre. Grid units.
struct alignas(16) TriangleBox {
  Triple<float> middle;
  float off;  // the middle's distance from the triangle
  Triple<float> half;
  float largest;  // of `half`
};
/// The boxes of all used triangles, by number.
struct TriangleBoxes {
  TriangleBox* all;
  Triple<double> grid_center;
  float grid_extent;  // the largest coordinate of the grid's samples, relative to its centre
};

/// The arrays of a step.
struct Step {
  Level parent, child;
  TriangleBoxes boxes;
  const Counter* parent_start;          // per parent, and the end
  const std::uint32_t* parent_entries;  // numbers of used triangles
  const Counter* chunk_start;           // per parent, and the end
  unsigned char* keep;                  // per parent's entry: a bit per child
  Counter* bound;                       // per child: bound (a float's bits) << 32 | number of the used triangle
  std::uint32_t* child_counts;          // per child, and a zero behind
  const Counter* child_start;
  std::uint32_t* child_entries;  // as the parents'; of tiles, triangles of the mesh
};

/// Writes the root's list: all used triangles, by number, and their boxes. If there is no other level (`is_tile`), the
/// root is a tile. A thread per triangle.
STANDOFF_KERNEL void list_all(Lattice l, DeviceMesh mesh, TriangleBoxes boxes, bool is_tile, std::uint32_t* entries,
                              Counter* start, Outcome* outcome) {
  const std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (n == 0) {
    start[0] = 0;
    start[1] = static_cast<Counter>(mesh.used_count());
  }
  if (n >= mesh.used_count()) return;
  const std::uint32_t triangle = used_triangle(mesh, n);
  entries[n] = is_tile ? triangle : static_cast<std::uint32_t>(n);
  if (!is_valid(mesh, triangle, outcome) || is_tile) return;
  const Corners c = corners_of(mesh, triangle);
  const Triple<double>& center = boxes.grid_center;
  const Triple<float> at[3] = {narrowed(local(l, c.at[0], center)), narrowed(local(l, c.at[1], center)),
                               narrowed(local(l, c.at[2], center))};
  const CenteredBox box = centered(box_of(at[0], at[1], at[2]));
  const auto frame = make_frame(at[0], at[1], at[2], float{kLeastLengthSq});
  boxes.all[n] = {box.middle, sqrt(distance_sq(frame, box.middle)), box.half,
                  max(box.half.x, max(box.half.y, box.half.z))};
}

/// Writes the number of chunks of each parent, and 0 behind the last. A thread per parent.
STANDOFF_KERNEL void count_chunks(const Counter* start, std::int64_t parents, std::uint32_t* chunks, Outcome* outcome) {
  const std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (n > parents) return;
  chunks[n] = n < parents && !outcome->stopped
                  ? static_cast<std::uint32_t>((start[n + 1] - start[n] + kChunk - 1) / kChunk)
                  : 0;
}

/// The record of the boxes, without their memory.
inline TriangleBoxes boxes_of(const Lattice& l) {
  const std::int64_t first[3] = {0, 0, 0};
  const CellBox grid = cell_at(l, level_of(l, top_level(l)), first);
  return {nullptr, grid.center, max(grid.half[0], max(grid.half[1], grid.half[2]))};
}

/// Sets all bounds to infinity. A thread per child.
STANDOFF_KERNEL void clear_bounds(Counter* bound, std::int64_t children) {
  const std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (n < children) bound[n] = ~Counter{0};
}

/// A child, relative to the parent's centre.
struct alignas(16) Child {
  Triple<float> center;
  float reach_sq;  // candidates farther from the centre are not the nearest of any sample
  NearSurface surface;
  CellExtent extent;
  float half_typical, half_inverse;  // half of a distance that candidates typically have, and half of its inverse
  std::int64_t index;                // -1 if the grid ends before it
};

/// The shared memory of a chunk's threads.
struct Chunk {
  Counter first, end;  // entries
  Triple<double> center;
  Triple<float> from_grid;  // the centre, relative to the grid's
  Child child[8];
  Counter least[8];  // bits of a squared distance << 32 | number of the triangle
  unsigned counts[8];
  Counter base[8];
};

/// Begins a chunk; all threads of the block take part. After the last barrier of the chunk before, only the first warp
/// may have read the chunk.
STANDOFF_DEVICE void begin_chunk(const Lattice& l, const Step& step, Counter number, Chunk& chunk) {
  const int t = static_cast<int>(threadIdx.x);
  if (t < 32) __syncwarp();  // its lanes have read the chunk before
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
      chunk.from_grid = narrowed(whole.center - step.boxes.grid_center);
    }
    const std::int64_t of_child[3] = {2 * at[0] + (t & 1), 2 * at[1] + (t >> 1 & 1), 2 * at[2] + (t >> 2)};
    Child& child = chunk.child[t];
    child.index = -1;
    if (of_child[0] < step.child.cells[0] && of_child[1] < step.child.cells[1] && of_child[2] < step.child.cells[2]) {
      const CellBox cell = cell_at(l, step.child, of_child);
      child.index = of_child[0] + step.child.cells[0] * (of_child[1] + step.child.cells[1] * of_child[2]);
      child.center = narrowed(cell.center - whole.center);
      for (int axis = 0; axis < 3; ++axis) child.extent.width[axis] = 2 * cell.half[axis];
      child.extent.radius = cell.radius;
    }
    chunk.least[t] = ~Counter{0};
    chunk.counts[t] = 0;
  }
  __syncthreads();
}

/// The frame of a used triangle, relative to the parent's centre.
STANDOFF_DEVICE TriangleFrame<float> frame_of(const Lattice& l, const DeviceMesh& mesh, std::uint32_t number,
                                              const Chunk& chunk) {
  const Corners c = corners_of(mesh, used_triangle(mesh, number));
  return make_frame(narrowed(local(l, c.at[0], chunk.center)), narrowed(local(l, c.at[1], chunk.center)),
                    narrowed(local(l, c.at[2], chunk.center)), float{kLeastLengthSq});
}

/// Whether a triangle is known by its box: if no half side is longer than a child's radius. Decides no bit. Where
/// larger ones were known by their boxes too, more candidates would be kept; where fewer, more would be measured.
STANDOFF_DEVICE bool is_small(const TriangleBox& box, const Chunk& chunk) {
  return box.largest <= chunk.child[0].extent.radius;
}
/// The error of a triangle's distances from the grid's cells.
STANDOFF_DEVICE float slack_of(const TriangleBox& box, const Step& step) {
  const float farthest = max(max(abs(box.middle.x), abs(box.middle.y)), abs(box.middle.z)) + box.largest;
  return distance_slack(max(farthest, step.boxes.grid_extent));
}

/// A candidate relative to the parent's centre.
struct Candidate {
  CenteredBox box;
  float slack;
  bool by_box;                 // it is known by its box
  TriangleFrame<float> frame;  // if not

  STANDOFF_DEVICE Candidate(const Lattice& l, const DeviceMesh& mesh, const Step& step, std::uint32_t number,
                            const Chunk& chunk) {
    const TriangleBox known = step.boxes.all[number];
    box = {known.middle - chunk.from_grid, known.half};
    slack = slack_of(known, step);
    by_box = is_small(known, chunk);
    if (!by_box) frame = frame_of(l, mesh, number, chunk);
  }
  /// The squared distance of p from the middle of the box, or from the triangle.
  STANDOFF_DEVICE float distance_sq_to(const Triple<float>& p) const {
    const Triple<float> from = p - box.middle;
    return by_box ? dot(from, from) : distance_sq(frame, p);
  }
};

/// Whether a candidate may be nearest to a sample of a child.
STANDOFF_DEVICE bool may_be_nearest(const Candidate& c, const Child& child) {
  // The candidate is no nearer to the child's centre than `least`, or for a box `least / distance`, where `distance` is
  // that of its middle: so nothing is divided, and no root is taken.
  float least, distance_sq_or_1;
  if (c.by_box) {
    // A box is no nearer than its nearest corner along the line through its middle. The slack takes slack * distance
    // off, which is at most slack * (distance^2 / typical + typical) / 2.
    const Triple<float> from = child.center - c.box.middle;
    const float squared = dot(from, from), by_slack = fma(squared, child.half_inverse, child.half_typical);
    const float in_box = fma(abs(from.x), c.box.half.x, fma(abs(from.y), c.box.half.y, abs(from.z) * c.box.half.z));
    least = fma(-c.slack, by_slack, squared - in_box);
    distance_sq_or_1 = squared;
  } else {
    least = sqrt(distance_sq(c.frame, child.center)) - c.slack;
    distance_sq_or_1 = 1;
  }
  least = max(least, 0.0f);
  return least * least <=
         min(child.reach_sq, bisector_sq(child.extent, c.box, c.slack, child.surface)) * distance_sq_or_1;
}

/// Lowers the least distance of a child by those of a warp's lanes. All lanes take part.
STANDOFF_DEVICE void lower_least(float squared, std::uint32_t number, Counter& least) {
  // Distances are not negative, so their order equals the order of their bits.
  const std::uint32_t bits = __float_as_uint(squared), fewest = warp_min(bits);
  if (bits == fewest && fewest <= load_relaxed(&least) >> 32) atomicMin(&least, Counter{bits} << 32 | number);
}

STANDOFF_KERNEL void __launch_bounds__(kStepThreads, kStepBlocks)
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
      const Candidate c(l, mesh, step, triangle, chunk);
      for (int n = 0; n < 8; ++n)
        if (chunk.child[n].index >= 0) lower_least(c.distance_sq_to(chunk.child[n].center), triangle, chunk.least[n]);
    }
    __syncthreads();
    if (t < 8 && chunk.child[t].index >= 0) {
      const auto nearest = static_cast<std::uint32_t>(chunk.least[t]);
      const TriangleBox box = step.boxes.all[nearest];
      const float distance = sqrt(__uint_as_float(static_cast<std::uint32_t>(chunk.least[t] >> 32)));
      const float most = distance + (is_small(box, chunk) ? box.off : 0) + slack_of(box, step);
      atomicMin(&step.bound[chunk.child[t].index], Counter{__float_as_uint(most)} << 32 | nearest);
    }
  }
}

/// Finds the point of the surface that bounds distances at a child's centre: the closest one of the triangle that gave
/// the bound. It may lower the bound.
STANDOFF_DEVICE void bound_by_closest_point(const Lattice& l, const DeviceMesh& mesh, const Step& step,
                                            const Chunk& chunk, Child& child) {
  Counter& bound = step.bound[child.index];
  const Counter known = load_relaxed(&bound);  // blocks of the same parent lower it to the same number
  const auto nearest = static_cast<std::uint32_t>(known);
  const auto frame = frame_of(l, mesh, nearest, chunk);
  const float by_closest = sqrt(distance_sq(frame, child.center)) + slack_of(step.boxes.all[nearest], step);
  const float within = min(__uint_as_float(static_cast<std::uint32_t>(known >> 32)), by_closest);
  atomicMin(&bound, Counter{__float_as_uint(within)} << 32 | nearest);
  child.surface = {closest_in_frame(frame, child.center), within};
  const float reach =
      min(within + 2 * child.extent.radius * (1 + kSlackRatio), l.thickness * (1 + kSlackRatio) + child.extent.radius);
  child.reach_sq = reach * reach * (1 + kBisectorSlack);
  child.half_typical = (within + child.extent.radius) / 2;
  child.half_inverse = 0.25f / child.half_typical;
}

/// Counts, for each of eight children, the lanes whose bit is set; lane n returns the count of child n. All lanes take
/// part.
STANDOFF_DEVICE unsigned counts_of_children(unsigned bits) {
  unsigned count = 0;
  for (unsigned n = 0; n < 8; ++n) {
    const std::uint32_t votes = __ballot_sync(0xffffffffu, bits >> n & 1);
    if (threadIdx.x % 32 == n) count = static_cast<unsigned>(__popc(votes));
  }
  return count;
}

STANDOFF_KERNEL void __launch_bounds__(kStepThreads, kStepBlocks)
    keep_candidates(Lattice l, DeviceMesh mesh, Step step, Outcome* outcome) {
  __shared__ Chunk chunk;
  if (outcome->stopped) return;
  const int t = static_cast<int>(threadIdx.x);
  const Counter chunks = step.chunk_start[step.parent.count()];
  for (Counter number = blockIdx.x; number < chunks; number += gridDim.x) {
    begin_chunk(l, step, number, chunk);
    if (t < 8 && chunk.child[t].index >= 0) bound_by_closest_point(l, mesh, step, chunk, chunk.child[t]);
    __syncthreads();
    for (Counter first = chunk.first; first < chunk.end; first += kStepThreads) {
      const Counter entry = first + static_cast<Counter>(t);
      const bool mine = entry < chunk.end;
      const Candidate c(l, mesh, step, step.parent_entries[mine ? entry : chunk.first], chunk);
      unsigned kept = 0;
      for (int n = 0; n < 8; ++n) {
        const Child& child = chunk.child[n];
        if (child.index < 0) continue;
        if (mine && may_be_nearest(c, child)) kept |= 1u << n;
      }
      if (mine) step.keep[entry] = static_cast<unsigned char>(kept);
      const unsigned count = counts_of_children(kept);
      if (count != 0) atomicAdd(&chunk.counts[t % 32], count);
    }
    __syncthreads();
    if (t < 8 && chunk.counts[t] != 0) atomicAdd(&step.child_counts[chunk.child[t].index], chunk.counts[t]);
  }
}

/// Writes the block's candidates into the children's lists. Two sweeps over the chunk: the first one counts, so that
/// each child's list is lengthened once.
STANDOFF_KERNEL void __launch_bounds__(kStepThreads, kStepBlocks)
    hand_down(Lattice l, DeviceMesh mesh, Step step, Outcome* outcome) {
  __shared__ Chunk chunk;
  if (outcome->stopped) return;
  const int t = static_cast<int>(threadIdx.x);
  const std::uint32_t before_me = (1u << t % 32) - 1;
  const bool are_tiles = step.child.side == kTileSide;
  const Counter chunks = step.chunk_start[step.parent.count()];
  for (Counter number = blockIdx.x; number < chunks; number += gridDim.x) {
    begin_chunk(l, step, number, chunk);
    for (Counter first = chunk.first; first < chunk.end; first += kStepThreads) {
      const Counter entry = first + static_cast<Counter>(t);
      const unsigned count = counts_of_children(entry < chunk.end ? step.keep[entry] : 0u);
      if (count != 0) atomicAdd(&chunk.counts[t % 32], count);
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
      const unsigned kept = entry < chunk.end ? step.keep[entry] : 0u;
      const unsigned count = counts_of_children(kept);
      if (__ballot_sync(0xffffffffu, kept != 0) == 0) continue;
      Counter of_warp = 0;  // of lane n: where the warp's entries of child n begin
      if (count != 0) of_warp = chunk.base[t % 32] + atomicAdd(&chunk.counts[t % 32], count);
      const std::uint32_t candidate = kept ? step.parent_entries[entry] : 0;
      const std::uint32_t triangle = are_tiles && kept ? used_triangle(mesh, candidate) : candidate;
      for (int n = 0; n < 8; ++n) {
        const std::uint32_t votes = __ballot_sync(0xffffffffu, kept >> n & 1);
        const Counter place = __shfl_sync(0xffffffffu, of_warp, n);
        if (kept >> n & 1) step.child_entries[place + static_cast<Counter>(__popc(votes & before_me))] = triangle;
      }
    }
    __syncthreads();
  }
}

}  // namespace standoff::STANDOFF_PLATFORM
