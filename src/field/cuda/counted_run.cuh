// SPDX-License-Identifier: Apache-2.0
// A field from host memory: the device counts the entries that it needs, the host reads the counts, allocates the
// memory, and the work goes on. Nothing is guessed, so nothing is done twice. It costs a wait per level of cells, or a
// single one for a thin band.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <mutex>
#include <span>
#include <vector>

#include "core/side_by_side.h"
#include "field/backend.h"
#include "field/cuda/capacity.h"
#include "field/cuda/pipeline.cuh"
#include "gpu/host_copies.cuh"
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

  /// Once the field is there.
  void free_lists() {
    for (Growing* const list : {&entries[0], &entries[1], &keep}) *list = Growing();
  }

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
  begin(run.lattice, run.task, nullptr);
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
    copy_in_by_pieces(job.threads,
                      {converted<Vec3>(vertices_, job.mesh.vertices),
                       converted<Triangle>(triangles_, job.mesh.triangles), copied<std::uint32_t>(kept_, job.kept)});
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
  template <class T>
  static HostArray copied(const Memory& to, std::span<const T> all) {
    return {to.as<void>(), static_cast<std::int64_t>(all.size()), sizeof(T),
            [all](void* piece, std::int64_t first, std::int64_t count) {
              std::copy_n(all.data() + first, count, static_cast<T*>(piece));
            }};
  }
  // Elements of another layout are converted on the way.
  template <class T, class Array>
  static HostArray converted(const Memory& to, const Array& all) {
    if (const auto packed = all.as_span()) return copied<T>(to, *packed);
    return {to.as<void>(), static_cast<std::int64_t>(all.size()), sizeof(T),
            [&all](void* piece, std::int64_t first, std::int64_t count) {
              T* const elements = static_cast<T*>(piece);
              for (std::int64_t n = 0; n < count; ++n) elements[n] = all[static_cast<std::size_t>(first + n)];
            }};
  }
  Memory vertices_, triangles_, kept_;
  DeviceMesh mesh_;
};

/// Marks the tiles that are not stored and lie inside, on several threads.
inline void mark_inside(int threads, std::span<const std::int32_t> slots, const Lattice& l, Sink& sink) {
  side_by_side(threads, kCopyWorkers, [&](int worker) {
    const auto share = [&](int n) { return std::ssize(slots) * n / kCopyWorkers; };
    for (std::int64_t index = share(worker); index < share(worker + 1); ++index) {
      if (slots[static_cast<std::size_t>(index)] != DistanceField::kInside) continue;
      std::int64_t tile[3];
      tile_at(l, index, tile);
      sink.mark_inside(tile[0], tile[1], tile[2]);
    }
  });
}

/// Copies finished tiles from the device and writes them to the sink, on several threads. `is_signed`: with the sign
/// that they have; if not, magnitudes.
inline void hand_over(int threads, const DeviceOutput& output, const Lattice& l, bool is_signed, Sink& sink,
                      ProgressMeter& progress) {
  if (output.slot_capacity == 0 && !is_signed) return;
  std::vector<std::int32_t> slots(static_cast<std::size_t>(l.tile_count()));
  copy_out(slots.data(), output.slots, l.tile_count() * static_cast<std::int64_t>(sizeof(std::int32_t)));
  if (is_signed) mark_inside(threads, slots, l, sink);
  std::vector<std::int64_t> tile_of_slot(static_cast<std::size_t>(output.slot_capacity), -1);
  for (std::size_t index = 0; index < slots.size(); ++index)
    if (slots[index] >= 0) tile_of_slot[static_cast<std::size_t>(slots[index])] = static_cast<std::int64_t>(index);

  std::vector<std::vector<TileTarget>> targets(kCopyWorkers);  // of the slots that a worker has taken
  std::mutex opening;  // so that a worker's tiles lie side by side in the memory of a sparse field
  const auto open = [&](int worker, std::int64_t first, std::int64_t count) {
    auto& mine = targets[static_cast<std::size_t>(worker)];
    mine.assign(static_cast<std::size_t>(count), {});
    const std::lock_guard lock(opening);
    for (std::int64_t n = 0; n < count; ++n) {
      const std::int64_t index = tile_of_slot[static_cast<std::size_t>(first + n)];
      if (index < 0) continue;  // a tile without a sample of the band
      std::int64_t tile[3];
      tile_at(l, index, tile);
      mine[static_cast<std::size_t>(n)] = sink.open(tile[0], tile[1], tile[2]);
    }
  };
  static_assert(kTilesTaken * (2 * 4 * kTileSamples) % kPieceBytes == 0);
  constexpr std::int64_t kAtOnce = kPieceBytes / (2 * 4 * kTileSamples);  // in a piece: values, then nearest triangles
  const auto copy = [&](void* piece, std::int64_t first, std::int64_t count) {
    float* const values = static_cast<float*>(piece);
    copy_out_later(values, output.values + first * kTileSamples, 4 * count * kTileSamples, nullptr);
    if (output.nearest)
      copy_out_later(values + kAtOnce * kTileSamples, output.nearest + first * kTileSamples, 4 * count * kTileSamples,
                     nullptr);
  };
  const auto use = [&](int worker, const void* piece, std::int64_t first, std::int64_t count) {
    const float* const values = static_cast<const float*>(piece);
    const auto* const nearest = reinterpret_cast<const std::uint32_t*>(values + kAtOnce * kTileSamples);
    for (std::int64_t n = 0; n < count; ++n) {
      const TileTarget& to =
          targets[static_cast<std::size_t>(worker)][static_cast<std::size_t>(first % kTilesTaken + n)];
      if (!to.values) continue;
      for (std::int64_t z = 0; z < to.size.z; ++z)
        for (std::int64_t y = 0; y < to.size.y; ++y) {
          const std::int64_t from = n * kTileSamples + 64 * z + 8 * y, row = to.row * y + to.slice * z;
          std::transform(values + from, values + from + to.size.x, to.values + row,
                         [&](float value) { return is_signed ? value : std::abs(value); });
          if (to.nearest) std::copy_n(nearest + from, to.size.x, to.nearest + row);
        }
    }
    if (first % kTilesTaken + count == kTilesTaken) progress.advance();
  };
  const std::int64_t tile_bytes = (output.nearest ? 8 : 4) * kTileSamples;
  copy_out_by_pieces(threads, {output.slot_capacity, tile_bytes, kTilesTaken, kAtOnce}, open, copy, use);
}

/// Units of progress of a window: so many for its copies, and seven times as many for computing it.
inline std::int64_t copies_of(const Grid& grid) {
  return std::max<std::int64_t>(1, tile_count(grid.size) / kTilesTaken);
}
inline constexpr std::int64_t kUnitsPerCopy = 8;

/// A job from host memory on the current device. The mesh stays there for several windows of the job's grid.
template <class Pipeline>
class HostRun {
 public:
  /// Copies the mesh, if there is room for it and for a window of this size.
  HostRun(const Job& job, const Grid& window) : job_(job), mesh_(with_room(job, window)) {}

  /// A window of the job's grid that begins at a brick. sign(field) may negate the samples inside of the finished
  /// field, and says whether it has. Waits for the device.
  template <class Sign>
  Counts run(const Grid& window, const Sink& sink, const Sign& sign) const {
    CountedRun field(mesh_.mesh(), window, job_.thickness, sink.with_nearest(), [&] { job_.progress.check(); });
    field.run<Pipeline>();
    const bool is_signed = sign(field);
    job_.progress.advance((kUnitsPerCopy - 1) * copies_of(window));
    Sink part = sink.of_window(job_.grid, window);
    hand_over(job_.threads, field.output(), field.lattice, is_signed, part, job_.progress);
    return {static_cast<std::int64_t>(field.outcome().samples_examined),
            static_cast<std::int64_t>(field.outcome().samples_band), is_signed ? window.sample_count() : 0};
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
