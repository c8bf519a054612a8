// SPDX-License-Identifier: Apache-2.0
// Runs a job from host memory to a sink and waits for it, one field at a time.
#pragma once

#include <algorithm>
#include <vector>

#include "field/backend.h"
#include "field/cuda/capacity.h"
#include "field/cuda/counted_run.cuh"

namespace standoff::STANDOFF_PLATFORM {

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
  // Elements of another layout are converted some at a time.
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

/// Takes finished tiles from the device, some at a time, and gives them to the sink.
inline void hand_over(const DeviceOutput& output, const Lattice& l, Sink& sink, ProgressMeter& progress) {
  const std::int64_t tiles = l.tile_count();
  std::vector<std::int32_t> slots(static_cast<std::size_t>(tiles));
  copy_out(slots.data(), output.slots, tiles * static_cast<std::int64_t>(sizeof(std::int32_t)));
  const std::int64_t batch = std::min(output.slot_capacity, kTilesAtOnce);
  std::vector<float> values(static_cast<std::size_t>(batch) * kTileSamples);
  std::vector<std::uint32_t> nearest(output.nearest ? values.size() : 0);
  std::int64_t here = 0, end = 0;  // the slots in host memory
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

/// Runs a job on the current device.
template <class Pipeline>
Counts run_from_host(const Job& job, Sink& sink) {
  job.progress.stage("gather", 1, 0.2, 0.9);
  const Lattice l = make_lattice(job.grid, job.thickness);
  require_free_memory(MeshOnDevice::bytes_of(job) + counting_bytes<Pipeline>(job.triangle_count(), l));
  const MeshOnDevice mesh(job);
  CountedRun field(mesh.mesh(), job.grid, job.thickness, sink.with_nearest(), [&] { job.progress.advance(0); });
  field.run<Pipeline>();
  job.progress.stage("copy", std::max<std::int64_t>(1, l.tile_count() / kTilesAtOnce), 0.9, 1);
  hand_over(field.output(), l, sink, job.progress);
  return {static_cast<std::int64_t>(field.outcome().samples_examined),
          static_cast<std::int64_t>(field.outcome().samples_band)};
}

}  // namespace standoff::STANDOFF_PLATFORM
