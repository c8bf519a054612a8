// The blocking way: from host memory to a sink, one field at a time.
#pragma once

#include <algorithm>
#include <vector>

#include "cuda/emulated.h"
#include "cuda/guess.h"
#include "cuda/lattice.h"
#include "cuda/platform.cuh"
#include "field/backend.h"

namespace difi::DIFI_PLATFORM {

/// The mesh in device memory.
class MeshOnDevice {
 public:
  explicit MeshOnDevice(const Job& job)
      : vertices_(bytes(job.mesh.vertices)), triangles_(bytes(job.mesh.triangles)), kept_(bytes(job.kept)) {
    copy_in(vertices_.as<void>(), job.mesh.vertices.data(), bytes(job.mesh.vertices));
    copy_in(triangles_.as<void>(), job.mesh.triangles.data(), bytes(job.mesh.triangles));
    if (!job.kept.empty()) copy_in(kept_.as<void>(), job.kept.data(), bytes(job.kept));
    mesh_ = {vertices_.as<double>(),
             static_cast<std::int64_t>(job.mesh.vertices.size()),
             triangles_.as<std::uint32_t>(),
             static_cast<std::int64_t>(job.mesh.triangles.size()),
             job.kept.empty() ? nullptr : kept_.as<std::uint32_t>(),
             static_cast<std::int64_t>(job.kept.size())};
  }
  const DeviceMesh& mesh() const { return mesh_; }
  static std::int64_t bytes_of(const Job& job) {
    return bytes(job.mesh.vertices) + bytes(job.mesh.triangles) + bytes(job.kept);
  }

 private:
  template <class T>
  static std::int64_t bytes(std::span<const T> all) {
    return static_cast<std::int64_t>(all.size_bytes());
  }
  Memory vertices_, triangles_, kept_;
  DeviceMesh mesh_;
};

/// Takes finished tiles from the device, some at a time, and gives them to the sink.
inline void hand_over(const DeviceOutput& output, const gpu::Lattice& l, std::int64_t stored_at_most, Sink& sink,
                      ProgressMeter& progress) {
  const std::int64_t tiles = l.tile_count();
  std::vector<std::int32_t> slots(static_cast<std::size_t>(tiles));
  copy_out(slots.data(), output.slots, tiles * static_cast<std::int64_t>(sizeof(std::int32_t)));
  const std::int64_t batch = std::min(stored_at_most, gpu::kTilesAtOnce);
  std::vector<float> values(static_cast<std::size_t>(batch) * gpu::kTileSamples);
  std::vector<std::uint32_t> nearest(output.nearest ? values.size() : 0);
  std::int64_t here = 0, end = 0;  // the slots in host memory
  for (std::int64_t index = 0; index < tiles; ++index) {
    const std::int64_t slot = slots[index];
    if (slot < 0) continue;
    if (slot >= end) {  // slots ascend
      here = slot;
      end = std::min(here + batch, stored_at_most);
      const std::int64_t first = here * gpu::kTileSamples, bytes = (end - here) * gpu::kTileSamples * 4;
      copy_out(values.data(), output.values + first, bytes);
      if (output.nearest) copy_out(nearest.data(), output.nearest + first, bytes);
      progress.advance();
    }
    std::int64_t tile[3];
    gpu::tile_at(l, index, tile);
    const TileTarget target = sink.open(tile[0], tile[1], tile[2]);
    for (std::int64_t z = 0; z < target.size.z; ++z)
      for (std::int64_t y = 0; y < target.size.y; ++y) {
        const std::int64_t from = (slot - here) * gpu::kTileSamples + 64 * z + 8 * y;
        const std::int64_t to = target.row * y + target.slice * z;
        std::copy_n(values.data() + from, target.size.x, target.values + to);
        if (target.nearest) std::copy_n(nearest.data() + from, target.size.x, target.nearest + to);
      }
  }
}

/// Runs a job. Where the guess of the room was too small, the outcome says what is needed, and it runs once more.
inline Counts run(const Job& job, Sink& sink, Method method) {
  job.progress.stage("gather", 1, 0.2, 0.9);
  const gpu::Lattice l = gpu::make_lattice(job.grid, job.thickness);
  const std::int64_t triangles = job.triangle_count(), tiles = l.tile_count();
  const std::int64_t slot_bytes = tiles * static_cast<std::int64_t>(sizeof(std::int32_t));
  std::int64_t entries = gpu::likely_entries(triangles, job.grid, job.thickness, method);
  std::int64_t slot_capacity = std::min(tiles, gpu::kTilesAtOnce);
  const auto value_bytes = [&] { return slot_capacity * gpu::kTileSamples * 4; };
  const auto round_bytes = [&] {  // of what is allocated anew for every round
    return (sink.with_nearest() ? 2 : 1) * value_bytes() +
           workspace_bytes(triangles, job.grid, job.thickness, method, entries);
  };
  expect_room(MeshOnDevice::bytes_of(job) + slot_bytes + round_bytes());
  const MeshOnDevice mesh(job);
  const Memory slots(slot_bytes), outcome_memory(sizeof(Outcome));
  for (;;) {
    expect_room(round_bytes());
    Task task{mesh.mesh(), job.grid, job.thickness, method, {}, outcome_memory.as<Outcome>()};
    const Memory values(value_bytes()), nearest(sink.with_nearest() ? value_bytes() : 1);
    task.output = {values.as<float>(), sink.with_nearest() ? nearest.as<std::uint32_t>() : nullptr,
                   slots.as<std::int32_t>(), slot_capacity};
    const std::int64_t bytes = workspace_bytes(triangles, job.grid, job.thickness, method, entries);
    const Memory workspace(bytes);
    DIFI_PLATFORM::enqueue(task, workspace.as<void>(), bytes, nullptr);
    Outcome outcome;
    copy_out(&outcome, task.outcome, sizeof outcome);
    if (outcome.stopped == 0) {
      job.progress.stage("copy", std::max<std::int64_t>(1, tiles / gpu::kTilesAtOnce), 0.9, 1);
      hand_over(task.output, l, static_cast<std::int64_t>(outcome.needed_slots), sink, job.progress);
      return {static_cast<std::int64_t>(outcome.samples_examined), static_cast<std::int64_t>(outcome.samples_band)};
    }
    const auto needed_entries = static_cast<std::int64_t>(outcome.needed_entries);
    const auto needed_slots = static_cast<std::int64_t>(outcome.needed_slots);
    if (outcome.bad_triangle != Outcome::kNone || (needed_entries <= entries && needed_slots <= slot_capacity))
      throw Error(ErrorCode::internal, "gpu: the kernels stopped without a reason; please report this");
    // Later levels of a descent may want more than the one that stopped it: leave them some room.
    if (needed_entries > entries) entries = needed_entries + needed_entries / 2;
    slot_capacity = std::max(slot_capacity, needed_slots);
    job.progress.advance(0);
  }
}

}  // namespace difi::DIFI_PLATFORM
