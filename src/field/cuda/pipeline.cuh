// The launches of one field by each way, in order. A way has two halves: after the first one it is known how much room
// the second one needs. On a stream all of it is there beforehand (enqueue_...); who can wait looks in between
// (counted_run.cuh).
#pragma once

#include "field/cuda/cell_hierarchy.cuh"
#include "field/cuda/outcome.cuh"
#include "gpu/workspace.h"
#include "thesis/algorithm_1.cuh"

namespace standoff::STANDOFF_PLATFORM {

inline std::int64_t blocks_for(std::int64_t items) { return (items + kThreads - 1) / kThreads; }

/// What every way needs: which tiles are used, and scratch for running sums over the tiles.
struct TileArrays {
  std::uint32_t* used;  // per tile, and a zero behind the last
  Counter* rank;        // their running sum
  void* sum_scratch;
  std::int64_t sum_scratch_bytes;

  TileArrays(gpu::Workspace& memory, std::int64_t tiles)
      : used(memory.take<std::uint32_t>(tiles + 1)),
        rank(memory.take<Counter>(tiles + 1)),
        sum_scratch_bytes(running_sum_bytes(tiles + 1)) {
    sum_scratch = memory.take<char>(sum_scratch_bytes);
  }

  void sum(const std::uint32_t* counts, Counter* start, std::int64_t count, Stream stream) const {
    running_sum(stream, sum_scratch, sum_scratch_bytes, counts, start, count);
  }
  /// Slots for the tiles marked as used.
  void give(const Lattice& l, const Task& task, Stream stream) const {
    const std::int64_t tiles = l.tile_count();
    sum(used, rank, tiles + 1, stream);
    launch(stream, "give slots", give_slots, blocks_for(tiles + 1), kThreads, used, rank, tiles, task.output,
           task.outcome);
  }
  /// Slots for the tiles that have triangles.
  void give(const Lattice& l, const Task& task, const Counter* start, Stream stream) const {
    const std::int64_t tiles = l.tile_count();
    launch(stream, "mark tiles", mark_used_tiles, blocks_for(tiles + 1), kThreads, start, tiles, used);
    give(l, task, stream);
  }
};

/// The arrays of the way for thin bands.
struct ThinArrays {
  static constexpr std::int64_t kBytesPerEntry = 4;
  TileArrays tiles;
  TileLists lists;
  LongList long_ones;

  ThinArrays(gpu::Workspace& memory, std::int64_t triangles, const Lattice& l, std::int64_t entries)
      : tiles(memory, l.tile_count()) {
    lists.counts = memory.take<std::uint32_t>(l.tile_count() + 1);
    lists.start = memory.take<Counter>(l.tile_count() + 1);
    lists.entries = memory.take<std::uint32_t>(entries);
    lists.capacity = static_cast<Counter>(entries);
    long_ones.triangles = memory.take<std::uint32_t>(triangles);
    long_ones.count = memory.take<Counter>(1);
  }
};

/// The lists of one level of a descent, and those of its parents: the two swap from level to level.
struct ThickArrays {
  static constexpr std::int64_t kBytesPerEntry = 4 + 4 + 1;
  TileArrays tiles;
  std::uint32_t* counts;
  Counter* start[2];
  std::uint32_t* entries[2];
  unsigned char* keep;
  Counter* bound;
  Counter* chunk_start;
  Counter capacity;  // of each of entries, and of keep

  ThickArrays(gpu::Workspace& memory, std::int64_t, const Lattice& l, std::int64_t most)
      : tiles(memory, l.tile_count()), capacity(static_cast<Counter>(most)) {
    const std::int64_t cells = l.tile_count() + 1;  // no level has more
    counts = memory.take<std::uint32_t>(cells);
    for (auto& one : start) one = memory.take<Counter>(cells > 2 ? cells : 2);
    for (auto& one : entries) one = memory.take<std::uint32_t>(most);
    keep = memory.take<unsigned char>(most);
    bound = memory.take<Counter>(cells);
    chunk_start = memory.take<Counter>(cells);
  }
};

/// The method thesis keeps a number per sample.
struct ThesisArrays {
  static constexpr std::int64_t kBytesPerEntry = 1;  // it has no lists
  TileArrays tiles;
  Counter* nearest;

  ThesisArrays(gpu::Workspace& memory, std::int64_t, const Lattice& l, std::int64_t)
      : tiles(memory, l.tile_count()), nearest(memory.take<Counter>(l.size[0] * l.size[1] * l.size[2])) {}
};

template <Through kThrough = Through::write>
void launch_gather(const Lattice& l, const Task& task, const GatherLists& lists, Stream stream) {
  // Sparse: most tiles are empty, so blocks look for those that are not.
  const std::int64_t tiles = l.tile_count(), most = task.output.slots ? std::int64_t{kManyBlocks} * 4 : 0x7fffffff;
  launch(stream, "gather", task.output.nearest ? gather<true, kThrough> : gather<false, kThrough>,
         tiles < most ? tiles : most, kGatherThreads, l, task.mesh, lists, task.output, task.outcome);
}

/// Thin bands, first half: how many triangles each tile has, and which tiles get a slot. Nothing is listed.
inline void count_thin(const Lattice& l, const Task& task, const ThinArrays& a, Stream stream) {
  const std::int64_t tiles = l.tile_count(), per_triangle = blocks_for(task.mesh.used_count());
  launch(stream, "clear", clear_outcome, 1, 1, task.outcome, a.long_ones.count);
  fill_bytes(stream, a.lists.counts, 0, (tiles + 1) * static_cast<std::int64_t>(sizeof(std::uint32_t)));
  launch(stream, "count small", bin_small<false>, per_triangle, kThreads, l, task.mesh, a.lists, a.long_ones,
         task.outcome);
  launch(stream, "count long", bin_long<false>, kManyBlocks, kThreads, l, task.mesh, a.lists, a.long_ones,
         task.outcome);
  a.tiles.sum(a.lists.counts, a.lists.start, tiles + 1, stream);
  launch(stream, "check room", check_entries, 1, 1, a.lists.start + tiles, a.lists.capacity, task.outcome);
  if (task.output.slots) a.tiles.give(l, task, a.lists.start, stream);
}

/// Thin bands, second half: the lists, and the field from them.
template <Through kThrough = Through::write>
void fill_thin(const Lattice& l, const Task& task, const ThinArrays& a, Stream stream) {
  const std::int64_t per_triangle = blocks_for(task.mesh.used_count());
  launch(stream, "list small", bin_small<true>, per_triangle, kThreads, l, task.mesh, a.lists, a.long_ones,
         task.outcome);
  launch(stream, "list long", bin_long<true>, kManyBlocks, kThreads, l, task.mesh, a.lists, a.long_ones, task.outcome);
  launch(stream, "check lists", check_lists, blocks_for(l.tile_count()), kThreads, a.lists.counts, l.tile_count(),
         task.outcome);
  launch_gather<kThrough>(l, task, {a.lists.start, a.lists.entries, nullptr}, stream);
}

template <Through kThrough>
void enqueue_thin(const Lattice& l, const Task& task, const ThinArrays& a, Stream stream) {
  count_thin(l, task, a, stream);
  fill_thin<kThrough>(l, task, a, stream);
}

/// One level of the descent: from the parents' lists in half `from` of the arrays to the children's in the other.
struct Descent {
  Step step;
  std::int64_t parents, children;
  int from;

  Descent(const Lattice& l, const ThickArrays& a, int child_level, int half)
      : step{gpu::level_of(l, child_level + 1),
             gpu::level_of(l, child_level),
             a.start[half],
             a.entries[half],
             a.chunk_start,
             a.keep,
             a.bound,
             a.counts,
             a.start[1 - half],
             a.entries[1 - half]},
        parents(step.parent.count()),
        children(step.child.count()),
        from(half) {}
};

/// The root of the descent, in half 0.
inline void begin_thick(const Task& task, const ThickArrays& a, Stream stream) {
  launch(stream, "clear", clear_outcome, 1, 1, task.outcome, static_cast<Counter*>(nullptr));
  launch(stream, "list all", list_all, blocks_for(task.mesh.used_count()), kThreads, task.mesh, a.entries[0],
         a.start[0], task.outcome);
}

/// First half of a level: which children keep which candidates, and how many that makes. No list is written.
inline void count_level(const Lattice& l, const Task& task, const ThickArrays& a, const Descent& d,
                        Stream stream) {
  launch(stream, "count chunks", count_chunks, blocks_for(d.parents + 1), kThreads, d.step.parent_start, d.parents,
         a.counts, task.outcome);
  a.tiles.sum(a.counts, a.chunk_start, d.parents + 1, stream);
  launch(stream, "clear bounds", clear_bounds, blocks_for(d.children), kThreads, a.bound, d.children);
  fill_bytes(stream, a.counts, 0, (d.children + 1) * static_cast<std::int64_t>(sizeof(std::uint32_t)));
  launch(stream, "bound", bound_children, kManyBlocks, kChunk, l, task.mesh, d.step, task.outcome);
  launch(stream, "keep", keep_candidates, kManyBlocks, kChunk, l, task.mesh, d.step, task.outcome);
  a.tiles.sum(a.counts, a.start[1 - d.from], d.children + 1, stream);
  launch(stream, "check room", check_entries, 1, 1, a.start[1 - d.from] + d.children, a.capacity, task.outcome);
}

/// Second half of a level: the children's lists.
inline void fill_level(const Lattice& l, const Task& task, const Descent& d, Stream stream) {
  launch(stream, "hand down", hand_down, kManyBlocks, kChunk, l, d.step, task.outcome);
}

/// The field from the tiles' lists, which are in half `half`.
inline void gather_thick(const Lattice& l, const Task& task, const ThickArrays& a, int half, Stream stream) {
  launch_gather(l, task, {a.start[half], a.entries[half], gpu::top_level(l) > 0 ? a.bound : nullptr}, stream);
}

inline void enqueue_thick(const Lattice& l, const Task& task, const ThickArrays& a, Stream stream) {
  begin_thick(task, a, stream);
  int half = 0;
  for (int number = gpu::top_level(l); number > 0; --number, half = 1 - half) {
    const Descent level(l, a, number - 1, half);
    count_level(l, task, a, level, stream);
    fill_level(l, task, level, stream);
  }
  if (task.output.slots) a.tiles.give(l, task, a.start[half], stream);
  gather_thick(l, task, a, half, stream);
}

/// How many blocks stride over the tiles.
inline std::int64_t tile_blocks(const Lattice& l) {
  const std::int64_t tiles = l.tile_count(), most = std::int64_t{kManyBlocks} * 4;
  return tiles < most ? tiles : most;
}

/// Algorithm 1, first half: the least distance of each sample, and which tiles get a slot.
template <Through kThrough = Through::write>
void lower_thesis(const Lattice& l, const Task& task, const ThesisArrays& a, Stream stream) {
  const std::int64_t tiles = l.tile_count(), samples = task.grid.sample_count();
  const std::int64_t warps = blocks_for(32 * task.mesh.used_count());
  launch(stream, "clear", clear_outcome, 1, 1, task.outcome, static_cast<Counter*>(nullptr));
  launch(stream, "clear samples", clear_samples, kManyBlocks, kThreads, a.nearest, samples);
  launch(stream, "Algorithm 1", lower_samples<kThrough>, warps < kManyBlocks * 8 ? warps : kManyBlocks * 8, kThreads, l,
         task.mesh, task.grid, task.thickness, a.nearest, task.outcome);
  if (!task.output.slots) return;
  fill_bytes(stream, a.tiles.used, 0, (tiles + 1) * static_cast<std::int64_t>(sizeof(std::uint32_t)));
  launch(stream, "mark tiles", mark_near_tiles, tile_blocks(l), kGatherThreads, l, a.nearest, a.tiles.used,
         task.outcome);
  a.tiles.give(l, task, stream);
}

/// Algorithm 1, second half: the field from them.
inline void write_thesis(const Lattice& l, const Task& task, const ThesisArrays& a, Stream stream) {
  launch(stream, "write", write_samples, tile_blocks(l), kGatherThreads, l, a.nearest, task.output, task.outcome);
}

template <Through kThrough>
void enqueue_thesis(const Lattice& l, const Task& task, const ThesisArrays& a, Stream stream) {
  lower_thesis<kThrough>(l, task, a, stream);
  write_thesis(l, task, a, stream);
}

}  // namespace standoff::STANDOFF_PLATFORM
