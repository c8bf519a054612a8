// SPDX-License-Identifier: Apache-2.0
// A field from host memory: the device counts what is needed, the host reads the counts, allocates it, and the work
// goes on. Nothing is guessed, so nothing is done twice; what it costs is a wait per level of cells, or one in all.
#pragma once

#include <functional>

#include "field/cuda/enqueue.cuh"

namespace standoff::STANDOFF_PLATFORM {

/// Device memory that is made anew where it is too small. What it held is lost then.
class Growing {
 public:
  /// Room for `count` of them. Throws Error{limit}.
  template <class T>
  T* room_for(std::int64_t count) {
    const std::int64_t bytes = count * static_cast<std::int64_t>(sizeof(T));
    if (bytes > bytes_) {
      memory_ = Memory();  // the old before the new; cudaFree waits for what still reads it
      bytes_ = 0;
      memory_ = Memory(bytes);
      bytes_ = bytes;
    }
    return memory_.as<T>();
  }

 private:
  Memory memory_;
  std::int64_t bytes_ = 0;
};

/// Bytes that a CountedRun takes from its beginning on; lists and values come to them when they have been counted.
template <class Pipeline>
std::int64_t counting_bytes(std::int64_t triangles, const Lattice& l) {
  gpu::Workspace memory(nullptr);
  const Pipeline arrays(memory, triangles, l, 0);
  return memory.used() + l.tile_count() * static_cast<std::int64_t>(sizeof(std::int32_t));
}

/// One sparse field, on the default stream. A pipeline's run() goes on from here: it launches, looks at what was
/// counted, allocates that memory, and launches what needs it.
class CountedRun {
 public:
  /// The mesh is in device memory, and was validated. `waited` is called after each look at the counts.
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
    task.output.slot_capacity = tiles;  // no values yet: all may have a slot
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
    look();  // before the arrays go
  }

  const Outcome& outcome() const { return outcome_; }
  /// Tiles that turned out to hold no sample of the band have no slot any more; the values of theirs are zero.
  const DeviceOutput& output() const { return task.output; }

  // For pipelines.
  const Lattice lattice;
  Task task;
  Growing entries[2], keep;

  /// Waits for the device, and looks at what was counted.
  const Outcome& look() {
    copy_out(&outcome_, task.outcome, sizeof outcome_);
    if (outcome_.stopped != 0)
      throw Error(ErrorCode::internal, "gpu: the kernels stopped without a reason; please report this");
    return outcome_;
  }
  /// The same between two halves; reports progress to the caller.
  const Outcome& wait() {
    look();
    waited_();
    return outcome_;
  }

  /// Of the values that make_values() takes.
  std::int64_t value_bytes() const { return (with_nearest_ ? 8 : 4) * value_count(); }

  // Tiles are copied out many at a time, also those that will have lost their slot: so none may be left unwritten.
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
  std::int64_t most = run.task.mesh.used_count();  // candidates of any level so far
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
  run.keep = Growing();  // the tiles' lists alone are still needed
  run.entries[1 - half] = Growing();
  require_free_memory(run.value_bytes());
  run.make_values();
  gather_tiles(run.lattice, run.task, half, nullptr);
}

}  // namespace standoff::STANDOFF_PLATFORM
