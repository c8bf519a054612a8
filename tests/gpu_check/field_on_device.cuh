// SPDX-License-Identifier: Apache-2.0
// A mesh and its field in device memory, for checks and measurements without the rest of standoff.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "backends/cuda/fields.h"
#include "backends/cuda/pipelines.cuh"
#include "standoff/cuda.h"
#include "standoff/mesh.h"

namespace standoff::STANDOFF_PLATFORM {

enum class Layout { dense, sparse };

/// Whether workspaces are filled with rubbish before use: shows what depends on it, but hides from a tool what reads
/// memory that nobody wrote.
inline bool poisons_workspace = true;

/// Everything enqueue() wants, allocated once; room for lists and tiles grows until the field fits.
class FieldOnDevice {
 public:
  FieldOnDevice(const Mesh& mesh, const Grid& grid, double thickness, Method method, Layout layout, bool with_nearest,
                const SignOptions& sign = {.method = SignMethod::none})
      : vertices_(bytes_of(mesh.vertices)),
        triangles_(bytes_of(mesh.triangles)),
        outcome_(sizeof(Outcome)),
        with_nearest_(with_nearest) {
    task_.mesh = {vertices_.as<double>(), static_cast<std::int64_t>(mesh.vertices.size()),
                  triangles_.as<std::uint32_t>(), static_cast<std::int64_t>(mesh.triangles.size())};
    task_.grid = grid;
    task_.thickness = thickness;
    task_.method = method;
    task_.sign = sign;
    task_.outcome = outcome_.as<Outcome>();
    upload(mesh);
    const std::int64_t tiles = tile_count(grid.size);
    if (layout == Layout::sparse) slots_ = Memory(4 * tiles);
    make_output(layout == Layout::dense ? 0 : std::min<std::int64_t>(tiles, 4096));
    make_workspace(cuda::likely_entries(task_.mesh.triangle_count, grid, thickness, method));
  }

  void upload(const Mesh& mesh) {
    copy_in(vertices_.as<void>(), mesh.vertices.data(), bytes_of(mesh.vertices));
    copy_in(triangles_.as<void>(), mesh.triangles.data(), bytes_of(mesh.triangles));
  }

  /// The field into host memory that is there. Requires dense output.
  void download(std::vector<float>& values) const { copy_out(values.data(), task_.output.values, bytes_of(values)); }

  void enqueue(Stream stream) { STANDOFF_PLATFORM::enqueue(task_, workspace_.as<void>(), workspace_bytes_, stream); }

  Outcome outcome() const {
    Outcome outcome;
    copy_out(&outcome, task_.outcome, sizeof outcome);
    return outcome;
  }

  /// Runs until the room is enough, and throws where that does not help.
  Outcome run() {
    for (;;) {
      enqueue(nullptr);
      const Outcome o = outcome();
      const auto entries = static_cast<std::int64_t>(o.needed_entries),
                 slots = static_cast<std::int64_t>(o.needed_slots);
      const bool few_entries = entries > entries_, few_slots = task_.output.slots && slots > task_.output.slot_capacity;
      if (o.stopped == 0 || !(few_entries || few_slots)) {
        cuda::check(o, task_);
        return o;
      }
      if (few_entries) make_workspace(entries + entries / 2);
      if (few_slots) make_output(slots);
    }
  }

  /// How many lists did not get exactly the triangles that were counted for them, after run(). The second pass takes
  /// each tile's count back down to zero; were it to take more than there is, it would write before the list's start.
  std::int64_t unbalanced_lists() const {
    const Lattice l = make_lattice(task_.grid, task_.thickness);
    const std::int64_t tiles = l.tile_count();
    const std::uint32_t* on_device = nullptr;
    with_pipeline(task_.method, task_.grid, task_.thickness, [&]<class Pipeline>() {
      gpu::Workspace memory(workspace_.as<void>());
      const Pipeline arrays(memory, task_.mesh.used_count(), l, 0);
      if constexpr (requires { arrays.lists; })
        on_device = arrays.lists.counts;
      else if constexpr (requires { arrays.counts; })
        on_device = top_level(l) > 0 ? arrays.counts : nullptr;
    });
    if (!on_device) return 0;  // no lists, or one of all triangles
    std::vector<std::uint32_t> counts(static_cast<std::size_t>(tiles));
    copy_out(counts.data(), on_device, bytes_of(counts));
    return tiles - std::count(counts.begin(), counts.end(), 0u);
  }

  /// The field, one value a sample, x fastest. NaN where the device's memory kept what was poured in before.
  std::vector<float> values() const {
    const auto far = static_cast<float>(task_.thickness);
    return dense<float>(task_.output.values, far, -far);
  }
  std::vector<std::uint32_t> nearest() const {
    return dense<std::uint32_t>(task_.output.nearest, kNoTriangle, kNoTriangle);
  }

  /// Sparse: what DeviceOutput::slots has for each tile, and the values of all slots.
  std::vector<std::int32_t> slots() const {
    std::vector<std::int32_t> slots(static_cast<std::size_t>(tile_count(task_.grid.size)));
    copy_out(slots.data(), task_.output.slots, bytes_of(slots));
    return slots;
  }
  template <class T>
  std::vector<T> pool(const T* on_device) const {
    std::vector<T> pool(static_cast<std::size_t>(task_.output.slot_capacity) * kTileSamples);
    copy_out(pool.data(), on_device, bytes_of(pool));
    return pool;
  }

  void* workspace() const { return workspace_.as<void>(); }
  std::int64_t workspace_bytes() const { return workspace_bytes_; }
  const Task& task() const { return task_; }
  /// Room for no list entry: then the work ends after counting.
  void take_entries_away() { make_workspace(0); }

 private:
  template <class T>
  static std::int64_t bytes_of(const std::vector<T>& all) {
    return static_cast<std::int64_t>(all.size() * sizeof(T));
  }

  void make_output(std::int64_t slot_capacity) {
    const std::int64_t count = slots_.as<void>() ? slot_capacity * kTileSamples : task_.grid.sample_count();
    values_ = Memory();
    nearest_ = Memory();
    values_ = Memory(4 * count);
    fill_bytes(nullptr, values_.as<void>(), 0xff, 4 * count);  // NaN: what is not written shows
    if (with_nearest_) {
      nearest_ = Memory(4 * count);
      fill_bytes(nullptr, nearest_.as<void>(), 0x5a, 4 * count);
    }
    task_.output = {values_.as<float>(), nearest_.as<std::uint32_t>(), slots_.as<std::int32_t>(), slot_capacity};
  }
  void make_workspace(std::int64_t entries) {
    entries_ = entries;
    workspace_bytes_ = STANDOFF_PLATFORM::workspace_bytes(task_, entries);
    workspace_ = Memory();
    workspace_ = Memory(workspace_bytes_);
    if (poisons_workspace) fill_bytes(nullptr, workspace_.as<void>(), 0xcd, workspace_bytes_);
  }

  template <class T>
  std::vector<T> dense(const T* on_device, T outside, T inside) const {
    const Grid& grid = task_.grid;
    std::vector<T> all(static_cast<std::size_t>(grid.sample_count()), outside);
    if (!task_.output.slots) {
      copy_out(all.data(), on_device, bytes_of(all));
      return all;
    }
    const Lattice l = make_lattice(grid, task_.thickness);
    const std::vector<std::int32_t> slots = this->slots();
    const std::vector<T> pool = this->pool(on_device);
    for (std::int64_t k = 0; k < grid.size.z; ++k)
      for (std::int64_t j = 0; j < grid.size.y; ++j)
        for (std::int64_t i = 0; i < grid.size.x; ++i) {
          const std::int64_t slot = slots[static_cast<std::size_t>(l.tile(i / 8, j / 8, k / 8))];
          T& value = all[static_cast<std::size_t>(grid.index(i, j, k))];
          if (slot >= 0)
            value = pool[static_cast<std::size_t>(slot * kTileSamples + i % 8 + 8 * (j % 8) + 64 * (k % 8))];
          else if (slot == DistanceField::kInside)
            value = inside;
        }
    return all;
  }

  Memory vertices_, triangles_, outcome_, slots_, values_, nearest_, workspace_;
  bool with_nearest_;
  Task task_;
  std::int64_t workspace_bytes_ = 0, entries_ = 0;
};

}  // namespace standoff::STANDOFF_PLATFORM
