// SPDX-License-Identifier: Apache-2.0
// Thin bands of many meshes in one sequence of launches (standoff/cuda_batch.h): the kernels are those of one field
// (pipeline.cuh). Kernels here make the fields' records from what lies in device memory, and share out the outcomes.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include "field/cuda/capacity.h"
#include "field/cuda/pipeline.cuh"
#include "field/prepare.h"

namespace standoff::STANDOFF_PLATFORM {

/// Whether a field may have this place, as check_task() and is_thin() ask it of a single one. (Moderate spacings are
/// finite, and so is the extent of their grid.)
STANDOFF_DEVICE bool is_valid(const BatchPlace& place) {
  const Vec3 &o = place.origin, &h = place.spacing;
  const double least = min(min(h.x, h.y), h.z), largest = max(max(h.x, h.y), h.z);
  return is_finite(o.x) && is_finite(o.y) && is_finite(o.z) && h.x > 0 && h.y > 0 && h.z > 0 && is_moderate(largest) &&
         is_even(least, largest) && place.thickness > 0 && is_thin(largest, place.thickness);
}

/// Whether element n of an array ascends to the next one, the first one is 0 and the one at `count` is `all`.
STANDOFF_DEVICE bool ascends(const std::int64_t* first, std::int64_t n, std::int64_t count, std::int64_t all) {
  return first[n] <= first[n + 1] && (n > 0 || first[0] == 0) && (n + 1 < count || first[count] == all);
}

/// Makes the fields' records and clears their outcomes, a thread per field. A field without a valid place gets a
/// lattice of zeros, which has_place() tells.
STANDOFF_KERNEL void place_fields(BatchTask task, ManyFields fields) {
  const std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (n >= task.count) return;
  Outcome* const outcome = task.outcomes + n;
  *outcome = no_outcome();
  PlacedField& made = fields.all[n];
  made = {};
  made.outcome = outcome;
  if (!ascends(task.first_vertex, n, task.count, task.vertex_count) ||
      !ascends(task.first_triangle, n, task.count, task.triangle_count)) {
    atomicOr(&task.total->needed_entries, Counter{Outcome::kNoOrder});  // many threads may write it
    stop(task.total);
    return;
  }
  const BatchPlace place = task.places[n];
  if (!is_valid(place)) {
    outcome->needed_entries = Outcome::kNoPlace;
    stop(outcome);
    return;
  }
  const std::int64_t vertex = task.first_vertex[n], triangle = task.first_triangle[n], sample = n * task.size.count();
  made.lattice = lattice_of({{place.origin.x, place.spacing.x, 0, task.size.x},
                             {place.origin.y, place.spacing.y, 0, task.size.y},
                             {place.origin.z, place.spacing.z, 0, task.size.z}},
                            place.thickness);
  made.mesh = {task.vertices + 3 * vertex, task.first_vertex[n + 1] - vertex, task.triangles + 3 * triangle,
               task.first_triangle[n + 1] - triangle};
  made.output = {task.values + sample, task.nearest ? task.nearest + sample : nullptr};
}

/// Tells each field how many entries it needs, or what stopped all of them. A thread per field.
STANDOFF_KERNEL void share_counts(ManyFields fields, const Counter* start) {
  const std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (n >= fields.count) return;
  Outcome& outcome = *fields.field(n).outcome;
  if (outcome.stopped) return;
  const bool all_stopped = fields.outcome->stopped != 0;
  outcome.stopped = all_stopped;
  outcome.needed_entries = all_stopped ? fields.outcome->needed_entries
                                       : start[fields.tile(n + 1, 0, 0, 0)] - start[fields.tile(n, 0, 0, 0)];
}

/// Sums the counts of the fields that did not stop. A thread per field.
STANDOFF_KERNEL void sum_counts(ManyFields fields) {
  const std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (n >= fields.count) return;
  const Outcome& outcome = *fields.field(n).outcome;
  if (outcome.stopped) return;
  atomicAdd(&fields.outcome->samples_examined, outcome.samples_examined);
  atomicAdd(&fields.outcome->samples_band, outcome.samples_band);
}

/// The pipeline of many thin bands.
struct ManyBands : BandLists {
  TileSums tiles;
  PlacedField* fields;

  ManyBands(gpu::Workspace& memory, const BatchTask& task, std::int64_t entries)
      : BandLists(memory, task.triangle_count, tile_count(stacked_grid(task).size), entries),
        tiles(memory, tile_count(stacked_grid(task).size)),
        fields(memory.take<PlacedField>(task.count)) {}

  /// First half: makes the fields' records, and counts the triangles of each tile.
  void count(const BatchTask& task, Stream stream) const {
    const ManyFields many = fields_of(task);
    launch(stream, "place fields", place_fields, blocks_for(task.count), kThreads, task, many);
    count_all({}, many, tiles, stream);
    launch(stream, "share counts", share_counts, blocks_for(task.count), kThreads, many, lists.start);
  }

  /// Second half: writes the lists, and the fields from them.
  void fill(const BatchTask& task, Stream stream) const {
    const ManyFields many = fields_of(task);
    list_triangles({}, many, stream);
    const ByRows<AllSteps> way;
    if (task.nearest)
      gather.run<true>({}, many, way, lists, true, stream);
    else
      gather.run<false>({}, many, way, lists, true, stream);
    launch(stream, "sum counts", sum_counts, blocks_for(task.count), kThreads, many);
  }

  void enqueue(const BatchTask& task, Stream stream) const {
    clear(task.total, stream);
    if (task.count == 0) return;
    count(task, stream);
    fill(task, stream);
  }

 private:
  ManyFields fields_of(const BatchTask& task) const {
    const Size3 each = DistanceField::tiles_of(task.size);
    return {fields, task.first_triangle, task.total, task.count, task.triangle_count, {each.x, each.y, each.z}};
  }
};

/// Throws Error{usage} or Error{limit} if a task of many meshes is not valid.
inline void check_task(const BatchTask& task) {
  check_sizes(task);
  const bool has_all =
      task.total &&
      (task.count == 0 || (task.first_vertex && task.first_triangle && task.places && task.values && task.outcomes));
  if (!has_all || (task.triangle_count > 0 && (!task.vertices || !task.triangles)))
    throw Error(ErrorCode::usage,
                "cuda: the arrays of many meshes must point to device memory, all but nearest; one is null");
}

}  // namespace standoff::STANDOFF_PLATFORM
