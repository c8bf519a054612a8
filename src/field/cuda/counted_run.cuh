// SPDX-License-Identifier: Apache-2.0
// A field from host memory: the device counts the entries that it needs, the host reads the counts, allocates the
// memory, and the work goes on. Nothing is guessed, so nothing is done twice. It costs a wait per level of cells, or a
// single one for a thin band.
#pragma once

#include <algorithm>
#include <functional>
#include <vector>

#include "field/backend.h"
#include "field/cuda/capacity.h"
#include "field/cuda/pipeline.cuh"
#include "gpu/platform.cuh"

namespace standoff::STANDOFF_PLATFORM {

/// Bytes that a CountedRun takes at its beginning; it allocates lists and values later, when they have been counted.
template <class Pipeline>
std::int64_t counting_bytes(std::int64_t triangles, const Lattice& l) {
  gpu::Workspace memory(nullptr);
  const Pipeline arrays(memory, triangles, l, 0);
  return memory.used() + l.tile_count() * static_cast<std::int64_t>(sizeof(std::int32_t));
}

/// Computes a sparse field on the default stream. A pipeline's run() launches the counting, reads the counts, allocates
/// that memory, and launches the work that needs it.
class CountedRun {
 public:
  /// Requires a valid mesh in device memory. `grid` as for make_lattice(). `waited` is called each time after the
  /// counts were read.
  CountedRun(const DeviceMesh& mesh, const Grid& grid, double thickness, bool with_nearest,
             std::function<void()> waited)
      : lattice(make_lattice(grid, thickness)),
        with_nearest_(with_nearest),
        waited_(std::move(waited)),
        outcome_memory_(sizeof(Outcome)) {
    check_count(mesh);
    const std::int64_t tiles = lattice.tile_count();
    task.mesh = mesh;
    task.grid = grid;
    task.thickness = thickness;
    task.outcome = outcome_memory_.as<Outcome>();
    task.output.slots = slots_.room_for<std::int32_t>(tiles);
    task.output.slot_capacity = tiles;  // there are no values yet, so all tiles may have a slot
  }

  /// Computes the field.
  template <class Pipeline>
  void run() {
    gpu::Workspace measure(nullptr);
    const Pipeline sizes(measure, task.mesh.used_count(), lattice, 0);
    const Memory bare(measure.used());
    gpu::Workspace memory(bare.as<void>());
    Pipeline arrays(memory, task.mesh.used_count(), lattice, 0);
    arrays.run(*this);
    look();  // wait for the device before the arrays are freed
  }

  const Outcome& outcome() const { return outcome_; }
  /// Tiles without a sample of the band have lost their slot; the values there are zero.
  const DeviceOutput& output() const { return task.output; }

  // For pipelines.
  const Lattice lattice;
  Task task;
  Growing entries[2], keep;

  /// Waits for the device and reads the counts.
  const Outcome& look() {
    copy_out(&outcome_, task.outcome, sizeof outcome_);
    if (outcome_.needed_entries == Outcome::kNoSeeds) throw_no_seeds();
    if (outcome_.stopped != 0)
      throw Error(ErrorCode::internal, "gpu: the kernels stopped without a reason; please report this");
    return outcome_;
  }
  /// The same between the two halves of a pipeline; reports progress to the caller.
  const Outcome& wait() {
    look();
    waited_();
    return outcome_;
  }

  /// Bytes of the values that make_values() allocates.
  std::int64_t value_bytes() const { return (with_nearest_ ? 8 : 4) * value_count(); }

  // Tiles are copied out many at a time, also tiles that lose their slot: so none may stay unwritten.
  void make_values() {
    task.output.slot_capacity = static_cast<std::int64_t>(outcome_.needed_slots);
    if (task.output.slot_capacity == 0) return;
    task.output.values = values_.room_for<float>(value_count());
    fill_bytes(nullptr, task.output.values, 0, 4 * value_count());
    if (!with_nearest_) return;
    task.output.nearest = nearest_.room_for<std::uint32_t>(value_count());
    fill_bytes(nullptr, task.output.nearest, 0, 4 * value_count());
  }

 private:
  std::int64_t value_count() const { return static_cast<std::int64_t>(outcome_.needed_slots) * kTileSamples; }

  bool with_nearest_;
  std::function<void()> waited_;
  Outcome outcome_{};
  Memory outcome_memory_;
  Growing slots_, values_, nearest_;
};

inline void ThinBand::run(CountedRun& run) {
  lists.capacity = ~Counter{0};
  count(run.lattice, run.task, nullptr);
  const auto needed = static_cast<std::int64_t>(run.wait().needed_entries);
  lists.capacity = static_cast<Counter>(needed);
  require_free_memory(needed * kBytesPerEntry + run.value_bytes());
  lists.entries = run.entries[0].room_for<std::uint32_t>(needed);
  run.make_values();
  fill(run.lattice, run.task, nullptr);
}

inline void ThickBand::run(CountedRun& run) {
  std::int64_t most = run.task.mesh.used_count();  // the most candidates of a level so far
  require_free_memory(most * kBytesPerEntry);
  capacity = ~Counter{0};
  entries[0] = run.entries[0].room_for<std::uint32_t>(most);
  begin(run.task, nullptr);
  int half = 0;
  for (int number = top_level(run.lattice); number > 0; --number, half = 1 - half) {
    keep = run.keep.room_for<unsigned char>(most);
    Step step = step_to(run.lattice, number - 1, half);
    count_level(run.lattice, run.task, step, half, nullptr);
    most = std::max(most, static_cast<std::int64_t>(run.wait().needed_entries));
    entries[1 - half] = run.entries[1 - half].room_for<std::uint32_t>(most);
    step.child_entries = entries[1 - half];
    fill_level(run.lattice, run.task, step, nullptr);
  }
  tiles.give(run.lattice, run.task, start[half], nullptr);
  run.look();
  run.keep = Growing();  // only the tiles' lists are still needed
  run.entries[1 - half] = Growing();
  require_free_memory(run.value_bytes());
  run.make_values();
  gather_tiles(run.lattice, run.task, half, nullptr);
}

/// The mesh in device memory.
class MeshOnDevice {
 public:
  explicit MeshOnDevice(const Job& job)
      : vertices_(bytes<Vec3>(job.mesh.vertices.size())),
        triangles_(bytes<Triangle>(job.mesh.triangles.size())),
        kept_(bytes<std::uint32_t>(job.kept.size())) {
    copy_all<Vec3>(vertices_, job.mesh.vertices);
    copy_all<Triangle>(triangles_, job.mesh.triangles);
    if (!job.kept.empty()) copy_in(kept_.as<void>(), job.kept.data(), bytes<std::uint32_t>(job.kept.size()));
    mesh_ = {vertices_.as<double>(),
             static_cast<std::int64_t>(job.mesh.vertices.size()),
             triangles_.as<std::uint32_t>(),
             static_cast<std::int64_t>(job.mesh.triangles.size()),
             job.kept.empty() ? nullptr : kept_.as<std::uint32_t>(),
             static_cast<std::int64_t>(job.kept.size())};
  }
  const DeviceMesh& mesh() const { return mesh_; }
  static std::int64_t bytes_of(const Job& job) {
    return bytes<Vec3>(job.mesh.vertices.size()) + bytes<Triangle>(job.mesh.triangles.size()) +
           bytes<std::uint32_t>(job.kept.size());
  }

 private:
  template <class T>
  static std::int64_t bytes(std::size_t count) {
    return static_cast<std::int64_t>(count * sizeof(T));
  }
  // Converts elements of another layout in batches.
  template <class T, class Array>
  static void copy_all(const Memory& to, const Array& all) {
    if (const auto packed = all.as_span()) {
      copy_in(to.as<void>(), packed->data(), bytes<T>(packed->size()));
      return;
    }
    constexpr std::size_t kAtOnce = std::size_t{1} << 18;
    std::vector<T> staged(std::min(all.size(), kAtOnce));
    for (std::size_t first = 0; first < all.size(); first += kAtOnce) {
      const std::size_t count = std::min(all.size() - first, kAtOnce);
      for (std::size_t n = 0; n < count; ++n) staged[n] = all[first + n];
      copy_in(to.as<T>() + first, staged.data(), bytes<T>(count));
    }
  }
  Memory vertices_, triangles_, kept_;
  DeviceMesh mesh_;
};

/// Copies finished tiles from the device in batches, and writes them to the sink.
inline void hand_over(const DeviceOutput& output, const Lattice& l, Sink& sink, ProgressMeter& progress) {
  const std::int64_t tiles = l.tile_count();
  std::vector<std::int32_t> slots(static_cast<std::size_t>(tiles));
  copy_out(slots.data(), output.slots, tiles * static_cast<std::int64_t>(sizeof(std::int32_t)));
  const std::int64_t batch = std::min(output.slot_capacity, kTilesAtOnce);
  std::vector<float> values(static_cast<std::size_t>(batch) * kTileSamples);
  std::vector<std::uint32_t> nearest(output.nearest ? values.size() : 0);
  std::int64_t here = 0, end = 0;  // the range of slots in host memory
  for (std::int64_t index = 0; index < tiles; ++index) {
    const std::int64_t slot = slots[index];
    if (slot < 0) continue;
    if (slot >= end) {  // slots ascend
      here = slot;
      end = std::min(here + batch, output.slot_capacity);
      const std::int64_t first = here * kTileSamples, bytes = (end - here) * kTileSamples * 4;
      copy_out(values.data(), output.values + first, bytes);
      if (output.nearest) copy_out(nearest.data(), output.nearest + first, bytes);
      progress.advance();
    }
    std::int64_t tile[3];
    tile_at(l, index, tile);
    const TileTarget target = sink.open(tile[0], tile[1], tile[2]);
    for (std::int64_t z = 0; z < target.size.z; ++z)
      for (std::int64_t y = 0; y < target.size.y; ++y) {
        const std::int64_t from = (slot - here) * kTileSamples + 64 * z + 8 * y;
        const std::int64_t to = target.row * y + target.slice * z;
        std::copy_n(values.data() + from, target.size.x, target.values + to);
        if (target.nearest) std::copy_n(nearest.data() + from, target.size.x, target.nearest + to);
      }
  }
}

/// Units of progress of a window: so many for its copies, and seven times as many for computing it.
inline std::int64_t copies_of(const Grid& grid) {
  return std::max<std::int64_t>(1, tile_count(grid.size) / kTilesAtOnce);
}
inline constexpr std::int64_t kUnitsPerCopy = 8;

/// A job from host memory on the current device. The mesh stays there for several windows of the job's grid.
template <class Pipeline>
class HostRun {
 public:
  /// Copies the mesh, if there is room for it and for a window of this size.
  HostRun(const Job& job, const Grid& window) : job_(job), mesh_(with_room(job, window)) {}

  /// A window of the job's grid that begins at a brick. Waits for the device.
  Counts run(const Grid& window, const Sink& sink) const {
    CountedRun field(mesh_.mesh(), window, job_.thickness, sink.with_nearest(), [&] { job_.progress.check(); });
    field.run<Pipeline>();
    job_.progress.advance((kUnitsPerCopy - 1) * copies_of(window));
    Sink part = sink.of_window(job_.grid, window);
    hand_over(field.output(), field.lattice, part, job_.progress);
    return {static_cast<std::int64_t>(field.outcome().samples_examined),
            static_cast<std::int64_t>(field.outcome().samples_band)};
  }

 private:
  static const Job& with_room(const Job& job, const Grid& window) {
    const Lattice l = make_lattice(window, job.thickness);
    require_free_memory(MeshOnDevice::bytes_of(job) + counting_bytes<Pipeline>(job.triangle_count(), l));
    return job;
  }

  const Job& job_;
  MeshOnDevice mesh_;
};

}  // namespace standoff::STANDOFF_PLATFORM
