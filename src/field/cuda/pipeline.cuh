// SPDX-License-Identifier: Apache-2.0
// The launches of a field, in order: a pipeline for thin bands, and one for thick bands and full fields. A pipeline has
// two halves: the first one counts the memory that the second one needs. On a stream, a workspace holds all of it from
// the beginning (in_workspace() below); from host memory, the counts are read in between (counted_run.cuh).
//
// A pipeline P is a struct of arrays in device memory with
//   P::kBytesPerEntry                                   bytes that its lists take per entry
//   P(Workspace&, triangles, lattice, entries)          takes the arrays from a workspace, or measures them
//   p.enqueue(lattice, task, stream)                    launches all of it
//   p.run(counted run)                                  launches it half by half (counted_run.cuh)
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "field/cuda/bin.cuh"
#include "field/cuda/capacity.h"
#include "field/cuda/cell_hierarchy.cuh"
#include "field/cuda/gather_groups.cuh"
#include "field/cuda/gather_rows.cuh"
#include "field/prepare.h"
#include "gpu/devices.h"

namespace standoff::STANDOFF_PLATFORM {

inline std::int64_t blocks_for(std::int64_t items) { return (items + kThreads - 1) / kThreads; }

/// Scratch memory for running sums over the tiles.
struct TileSums {
  void* scratch;
  std::int64_t scratch_bytes;

  TileSums(gpu::Workspace& memory, std::int64_t tiles) : scratch_bytes(running_sum_bytes(tiles + 1)) {
    scratch = memory.take<char>(scratch_bytes);
  }
  void sum(const std::uint32_t* counts, Counter* start, std::int64_t count, Stream stream) const {
    running_sum(stream, scratch, scratch_bytes, counts, start, count);
  }
};

/// The arrays of every pipeline of one field: which tiles are used, and running sums over the tiles.
struct TileArrays : TileSums {
  std::uint32_t* used;  // per tile, and a zero behind the last
  Counter* rank;        // their running sum

  TileArrays(gpu::Workspace& memory, std::int64_t tiles)
      : TileSums(memory, tiles), used(memory.take<std::uint32_t>(tiles + 1)), rank(memory.take<Counter>(tiles + 1)) {}

  /// Gives slots to the tiles marked as used.
  void give(const Lattice& l, const Task& task, Stream stream) const {
    const std::int64_t tiles = l.tile_count();
    sum(used, rank, tiles + 1, stream);
    launch(stream, "give slots", give_slots, blocks_for(tiles + 1), kThreads, used, rank, tiles, task.output,
           task.outcome);
  }
  /// Gives slots to the tiles that have triangles.
  void give(const Lattice& l, const Task& task, const Counter* start, Stream stream) const {
    const std::int64_t tiles = l.tile_count();
    launch(stream, "mark tiles", mark_used_tiles, blocks_for(tiles + 1), kThreads, start, tiles, used);
    give(l, task, stream);
  }
};

/// The number of blocks that stride over the tiles.
inline std::int64_t tile_blocks(const Lattice& l) {
  const std::int64_t tiles = l.tile_count(), most = std::int64_t{kManyBlocks} * 4;
  return tiles < most ? tiles : most;
}

class CountedRun;

/// From the tiles' lists to the field.
struct TileGather {
  GatherWork work;
  std::int64_t most_cut;

  TileGather(gpu::Workspace& memory, std::int64_t tiles) : most_cut(std::min(tiles, kMostCut)) {
    // The item that fills a group stands for its empty tiles, of which there is one.
    work.capacity = tiles + kMostParts;
    work.items = memory.take<WorkItem>(work.capacity);
    work.cut_tiles = memory.take<std::int64_t>(most_cut);
    work.found = memory.take<Counter>(most_cut * kTileSamples);
    work.counts = memory.take<WorkCounts>(1);
  }

  /// `fills`: also tiles without triangles.
  template <bool kNearest, class Way, class Fields>
  void run(const typename Fields::Lattices& lattices, const Fields& fields, const Way& way, const TileLists& lists,
           bool fills, Stream stream) const {
    fill_bytes(stream, work.counts, 0, sizeof *work.counts);
    launch(stream, "check lists", check_lists<Fields>, blocks_for(tile_count_of(fields)), kThreads, fields, lists,
           work);
    fill_bytes(stream, work.found, 0xff, most_cut * kTileSamples * static_cast<std::int64_t>(sizeof(Counter)));
    launch(stream, "list work", list_work<Fields>, blocks_for(32 * tile_groups(fields)), kThreads, fields, lists.start,
           work, fills);
    launch(stream, "gather", gather<kNearest, Way, Fields>, kManyBlocks * 2, kGatherThreads, lattices, fields, way,
           lists.entries, work);
    launch(stream, "finish cut tiles", finish_cut_tiles<kNearest, typename Way::Steps, Fields>,
           std::min<std::int64_t>(most_cut, kManyBlocks), kGatherThreads, lattices, fields, work);
  }
  /// The same for one field, with nearest triangles where its output has them.
  template <class Way>
  void run(const Lattice& l, const Task& task, const Way& way, const TileLists& lists, Stream stream) const {
    const OneField field(l, task);
    if (task.output.nearest)
      run<true>(l, field, way, lists, !task.output.slots, stream);
    else
      run<false>(l, field, way, lists, !task.output.slots, stream);
  }
};

/// Thin bands, of one field or of many (field_set.cuh): triangles are counted in the tiles that they reach, then listed
/// there.
struct BandLists {
  static constexpr std::int64_t kBytesPerEntry = 4;
  TileLists lists;
  LongList long_ones;
  TileGather gather;

  BandLists(gpu::Workspace& memory, std::int64_t triangles, std::int64_t tiles, std::int64_t entries)
      : gather(memory, tiles) {
    lists.counts = memory.take<std::uint32_t>(tiles + 1);
    lists.start = memory.take<Counter>(tiles + 1);
    lists.entries = memory.take<std::uint32_t>(entries);
    lists.capacity = static_cast<Counter>(entries);
    long_ones.numbers = memory.take<std::uint32_t>(triangles);
    long_ones.capacity = triangles;
    long_ones.count = memory.take<Counter>(2);
  }

  void clear(Outcome* outcome, Stream stream) const {
    launch(stream, "clear", clear_outcome, 1, 1, outcome, long_ones.count, 2);
  }

  /// First half: counts the triangles of each tile. Lists nothing.
  template <class Fields>
  void count_all(const typename Fields::Lattices& lattices, const Fields& fields, const TileSums& tiles,
                 Stream stream) const {
    const std::int64_t all = tile_count_of(fields), per_triangle = triangle_blocks(fields);
    fill_bytes(stream, lists.counts, 0, (all + 1) * static_cast<std::int64_t>(sizeof(std::uint32_t)));
    launch(stream, "count small", bin_small<false, Fields>, per_triangle, kThreads, lattices, fields, lists, long_ones);
    launch(stream, "count long", bin_long<false, Fields>, kManyBlocks, kThreads, lattices, fields, lists, long_ones);
    tiles.sum(lists.counts, lists.start, all + 1, stream);
    launch(stream, "check room", check_entries, 1, 1, lists.start + all, lists.capacity, fields.total());
  }

  /// Second half: writes the lists.
  template <class Fields>
  void list_triangles(const typename Fields::Lattices& lattices, const Fields& fields, Stream stream) const {
    const std::int64_t per_triangle = triangle_blocks(fields);
    launch(stream, "list small", bin_small<true, Fields>, per_triangle, kThreads, lattices, fields, lists, long_ones);
    launch(stream, "list long", bin_long<true, Fields>, kManyBlocks, kThreads, lattices, fields, lists, long_ones);
  }

 private:
  template <class Fields>
  static std::int64_t triangle_blocks(const Fields& fields) {
    return std::max<std::int64_t>(1, blocks_for(fields.triangle_count()));  // many meshes may all be empty
  }
};

/// A thin band.
struct ThinBand : BandLists {
  TileArrays tiles;

  ThinBand(gpu::Workspace& memory, std::int64_t triangles, const Lattice& l, std::int64_t entries)
      : BandLists(memory, triangles, l.tile_count(), entries), tiles(memory, l.tile_count()) {}

  /// First half: counts the triangles of each tile, and gives tiles their slots. Lists nothing.
  void count(const Lattice& l, const Task& task, Stream stream) const {
    clear(task.outcome, stream);
    count_all(l, OneField(l, task), tiles, stream);
    if (task.output.slots) tiles.give(l, task, lists.start, stream);
  }

  /// Second half: writes the lists, and the field from them.
  template <class Steps = AllSteps>
  void fill(const Lattice& l, const Task& task, Stream stream) const {
    list_triangles(l, OneField(l, task), stream);
    gather.run(l, task, ByRows<Steps>{}, lists, stream);
  }

  void enqueue(const Lattice& l, const Task& task, Stream stream) const {
    count(l, task, stream);
    fill(l, task, stream);
  }
  inline void run(CountedRun& run);
};

/// Thick bands and full fields: the lists of one level of cells, and the lists of their parents; the two halves of the
/// arrays swap from level to level (cell_hierarchy.cuh).
struct ThickBand {
  static constexpr std::int64_t kBytesPerEntry = 4 + 4 + 1;
  TileArrays tiles;
  std::uint32_t* counts;
  Counter* start[2];
  std::uint32_t* entries[2];
  unsigned char* keep;
  Counter* bound;
  Counter* chunk_start;
  TileGather gather;
  TriangleBoxes boxes;
  Counter capacity;  // of each half of `entries`, and of `keep`

  ThickBand(gpu::Workspace& memory, std::int64_t triangles, const Lattice& l, std::int64_t most)
      : tiles(memory, l.tile_count()),
        gather(memory, l.tile_count()),
        boxes(boxes_of(l)),
        capacity(static_cast<Counter>(most)) {
    boxes.all = memory.take<TriangleBox>(triangles);
    const std::int64_t cells = l.tile_count() + 1;  // no level has more cells
    counts = memory.take<std::uint32_t>(cells);
    for (auto& one : start) one = memory.take<Counter>(cells > 2 ? cells : 2);
    for (auto& one : entries) one = memory.take<std::uint32_t>(most);
    keep = memory.take<unsigned char>(most);
    bound = memory.take<Counter>(cells);
    chunk_start = memory.take<Counter>(cells);
  }

  /// The step from the parents' lists in half `half` of the arrays to the children's lists in the other half.
  Step step_to(const Lattice& l, int child_level, int half) const {
    return {level_of(l, child_level + 1),
            level_of(l, child_level),
            boxes,
            start[half],
            entries[half],
            chunk_start,
            keep,
            bound,
            counts,
            start[1 - half],
            entries[1 - half]};
  }

  /// Writes the list of the root, the whole grid, to half 0.
  void begin(const Lattice& l, const Task& task, Stream stream) const {
    launch(stream, "clear", clear_outcome, 1, 1, task.outcome, static_cast<Counter*>(nullptr), 0);
    launch(stream, "list all", list_all, blocks_for(task.mesh.used_count()), kThreads, l, task.mesh, boxes,
           top_level(l) == 0, entries[0], start[0], task.outcome);
    fill_bytes(stream, counts, 0, sizeof *counts);  // if there is no level below the root
  }

  /// First half of a level: decides which children keep which candidates, and counts them. Writes no list.
  void count_level(const Lattice& l, const Task& task, const Step& step, int half, Stream stream) const {
    const std::int64_t parents = step.parent.count(), children = step.child.count();
    launch(stream, "count chunks", count_chunks, blocks_for(parents + 1), kThreads, step.parent_start, parents, counts,
           task.outcome);
    tiles.sum(counts, chunk_start, parents + 1, stream);
    launch(stream, "clear bounds", clear_bounds, blocks_for(children), kThreads, bound, children);
    fill_bytes(stream, counts, 0, (children + 1) * static_cast<std::int64_t>(sizeof(std::uint32_t)));
    launch(stream, "bound", bound_children, kManyBlocks, kStepThreads, l, task.mesh, step, task.outcome);
    launch(stream, "keep", keep_candidates, kManyBlocks, kStepThreads, l, task.mesh, step, task.outcome);
    tiles.sum(counts, start[1 - half], children + 1, stream);
    launch(stream, "check room", check_entries, 1, 1, start[1 - half] + children, capacity, task.outcome);
  }

  /// Second half of a level: writes the children's lists.
  static void fill_level(const Lattice& l, const Task& task, const Step& step, Stream stream) {
    launch(stream, "hand down", hand_down, kManyBlocks, kStepThreads, l, task.mesh, step, task.outcome);
  }

  /// Computes the field from the tiles' lists in half `half`.
  void gather_tiles(const Lattice& l, const Task& task, int half, Stream stream) const {
    gather.run(l, task, ByGroups{top_level(l) > 0 ? bound : nullptr}, {counts, start[half], entries[half], capacity},
               stream);
  }

  void enqueue(const Lattice& l, const Task& task, Stream stream) const {
    begin(l, task, stream);
    int half = 0;
    for (int number = top_level(l); number > 0; --number, half = 1 - half) {
      const Step step = step_to(l, number - 1, half);
      count_level(l, task, step, half, stream);
      fill_level(l, task, step, stream);
    }
    if (task.output.slots) tiles.give(l, task, start[half], stream);
    gather_tiles(l, task, half, stream);
  }
  inline void run(CountedRun& run);
};

/// Calls use.template operator()<Pipeline>() with the pipeline of the method `tiles` for a thickness.
template <class Use>
auto with_tiles_pipeline(const Grid& grid, double thickness, Use use) {
  return is_thin(grid, thickness) ? use.template operator()<ThinBand>() : use.template operator()<ThickBand>();
}

// Bytes that the alignment of arrays may waste.
inline constexpr std::int64_t kAlignmentLoss = 4096;

/// Bytes of a workspace beside the lists' entries; `sizes` are what the pipeline's constructor takes.
template <class Pipeline, class... Sizes>
std::int64_t bytes_beside_entries(const Sizes&... sizes) {
  gpu::Workspace memory(nullptr);
  const Pipeline arrays(memory, sizes..., 0);
  return memory.used() + kAlignmentLoss;
}

/// Bytes of a workspace for `entries` list entries, plus one entry per triangle.
template <class Pipeline>
std::int64_t needed_bytes(std::int64_t triangles, const Lattice& l, std::int64_t entries) {
  return bytes_beside_entries<Pipeline>(triangles, l) + std::max(entries, triangles) * Pipeline::kBytesPerEntry;
}

/// Throws Error{usage} if a task is not valid.
inline void check_task(const Task& task) {
  const auto fail = [](const std::string& what) { throw Error(ErrorCode::usage, "cuda: " + what); };
  validate(task.grid);
  check_grid(task.grid);
  if (!(task.thickness > 0)) fail("the thickness must be positive; infinity gives a full field");
  check_count(task.mesh);
  if (!task.mesh.vertices || !task.mesh.triangles || !task.output.values || !task.outcome)
    fail("vertices, triangles, values and outcome must point to device memory; one is null");
  if (task.output.slots && task.output.slot_capacity < 0)
    fail("the output has room for " + std::to_string(task.output.slot_capacity) + " tiles; give it 0 or more");
}

/// Throws Error{usage} if a workspace is null, not aligned or smaller than `least`.
inline void check_workspace(const void* workspace, std::int64_t bytes, std::int64_t least) {
  const auto fail = [](const std::string& what) { throw Error(ErrorCode::usage, "cuda: " + what); };
  if (reinterpret_cast<std::uintptr_t>(workspace) % gpu::Workspace::kAlignment != 0)
    fail("the workspace must be aligned to " + std::to_string(gpu::Workspace::kAlignment) +
         " bytes, as what cudaMalloc gives is");
  if (!workspace || bytes < least)
    fail("the workspace has " + std::to_string(bytes) + " bytes, this field wants " + std::to_string(least) +
         " at least; ask workspace_bytes()");
}

/// A pipeline in a workspace that is large enough; its lists get all remaining memory.
template <class Pipeline, class... Sizes>
Pipeline filling(void* workspace, std::int64_t bytes, const Sizes&... sizes) {
  gpu::Workspace memory(workspace);
  return Pipeline(memory, sizes..., (bytes - bytes_beside_entries<Pipeline>(sizes...)) / Pipeline::kBytesPerEntry);
}
/// The same for a checked task and workspace.
template <class Pipeline>
Pipeline in_workspace(const Task& task, const Lattice& l, void* workspace, std::int64_t bytes) {
  return filling<Pipeline>(workspace, bytes, task.mesh.used_count(), l);
}

}  // namespace standoff::STANDOFF_PLATFORM
