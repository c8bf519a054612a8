// SPDX-License-Identifier: Apache-2.0
// Many meshes and their fields in device memory, for checks and measurements.
#pragma once

#include <algorithm>
#include <vector>

#include "backends/cuda/fields.h"
#include "standoff/cuda_batch.h"
#include "tests/gpu_check/field_on_device.cuh"
#include "tests/support/mesh_batch.h"

namespace standoff::STANDOFF_PLATFORM {

/// Everything enqueue() wants of many meshes, allocated once; room for lists grows until the fields fit.
class BatchOnDevice {
 public:
  BatchOnDevice(const testing::MeshBatch& meshes, const Size3& size, bool with_nearest)
      : meshes_(meshes),
        vertices_(copy_of(meshes.vertices)),
        triangles_(copy_of(meshes.triangles)),
        first_vertex_(copy_of(meshes.first_vertex)),
        first_triangle_(copy_of(meshes.first_triangle)),
        places_(copy_of(meshes.places)),
        outcomes_((meshes.count() + 1) * static_cast<std::int64_t>(sizeof(Outcome))) {
    task_ = meshes.sizes(size);
    const std::int64_t bytes = 4 * task_.count * size.count();
    values_ = Memory(bytes);
    fill_bytes(nullptr, values_.as<void>(), 0xff, bytes);  // NaN: what is not written shows
    if (with_nearest) {
      nearest_ = Memory(bytes);
      fill_bytes(nullptr, nearest_.as<void>(), 0x5a, bytes);
    }
    task_.vertices = vertices_.as<double>();
    task_.triangles = triangles_.as<std::uint32_t>();
    task_.first_vertex = first_vertex_.as<std::int64_t>();
    task_.first_triangle = first_triangle_.as<std::int64_t>();
    task_.places = places_.as<BatchPlace>();
    task_.values = values_.as<float>();
    task_.nearest = nearest_.as<std::uint32_t>();
    task_.outcomes = outcomes_.as<Outcome>();
    task_.total = task_.outcomes + task_.count;
    make_workspace(STANDOFF_PLATFORM::workspace_bytes(task_, cuda::likely_entries(task_)));
  }

  void enqueue(Stream stream) { STANDOFF_PLATFORM::enqueue(task_, workspace_.as<void>(), workspace_bytes_, stream); }

  /// Runs until the room is enough, and throws where that does not help. Returns the total.
  Outcome run() {
    for (;;) {
      enqueue(nullptr);
      const Outcome total = outcomes().back();
      const auto entries = static_cast<std::int64_t>(total.needed_entries);
      const bool is_short = total.stopped != 0 && entries > 0;  // other reasons have no number of entries
      const std::int64_t bytes = is_short ? STANDOFF_PLATFORM::workspace_bytes(task_, entries) : 0;
      if (bytes <= workspace_bytes_) {
        cuda::check(total, task_);
        return total;
      }
      make_workspace(bytes);
    }
  }

  /// The same fields as tasks of their own.
  std::vector<Task> single_tasks() const {
    std::vector<Task> tasks;
    for (std::size_t n = 0; n < meshes_.places.size(); ++n) {
      const std::int64_t vertex = meshes_.first_vertex[n], triangle = meshes_.first_triangle[n],
                         sample = static_cast<std::int64_t>(n) * task_.size.count();
      Task task;
      task.mesh = {task_.vertices + 3 * vertex, meshes_.first_vertex[n + 1] - vertex, task_.triangles + 3 * triangle,
                   meshes_.first_triangle[n + 1] - triangle};
      task.grid = meshes_.grid(n, task_.size);
      task.thickness = meshes_.places[n].thickness;
      task.output = {task_.values + sample, task_.nearest ? task_.nearest + sample : nullptr};
      task.outcome = task_.outcomes + n;
      tasks.push_back(task);
    }
    return tasks;
  }
  /// Makes the workspace large enough for each of these tasks.
  void make_room_for(const std::vector<Task>& tasks) {
    std::int64_t bytes = workspace_bytes_;
    for (const Task& t : tasks)
      bytes = std::max(bytes, STANDOFF_PLATFORM::workspace_bytes(
                                  t.mesh.triangle_count, t.grid, t.thickness, t.method,
                                  2 * cuda::likely_entries(t.mesh.triangle_count, t.grid, t.thickness, t.method)));
    make_workspace(bytes);
  }

  /// The fields' outcomes, and the total behind them.
  std::vector<Outcome> outcomes() const {
    std::vector<Outcome> outcomes(static_cast<std::size_t>(task_.count + 1));
    copy_out(outcomes.data(), task_.outcomes, static_cast<std::int64_t>(outcomes.size() * sizeof(Outcome)));
    return outcomes;
  }
  std::vector<float> values(std::int64_t n) const { return field(task_.values, n); }
  std::vector<std::uint32_t> nearest(std::int64_t n) const { return field(task_.nearest, n); }

  const BatchTask& task() const { return task_; }
  void* workspace() const { return workspace_.as<void>(); }
  std::int64_t workspace_bytes() const { return workspace_bytes_; }

 private:
  template <class T>
  static Memory copy_of(const std::vector<T>& all) {
    const auto bytes = static_cast<std::int64_t>(all.size() * sizeof(T));
    Memory memory(std::max<std::int64_t>(1, bytes));
    copy_in(memory.as<void>(), all.data(), bytes);
    return memory;
  }
  template <class T>
  std::vector<T> field(const T* all, std::int64_t n) const {
    std::vector<T> values(static_cast<std::size_t>(task_.size.count()));
    copy_out(values.data(), all + n * task_.size.count(), 4 * task_.size.count());
    return values;
  }
  void make_workspace(std::int64_t bytes) {
    workspace_ = Memory();
    workspace_ = Memory(bytes);
    workspace_bytes_ = bytes;
    if (poisons_workspace) fill_bytes(nullptr, workspace_.as<void>(), 0xcd, bytes);
  }

  const testing::MeshBatch& meshes_;
  Memory vertices_, triangles_, first_vertex_, first_triangle_, places_, outcomes_, values_, nearest_, workspace_;
  BatchTask task_;
  std::int64_t workspace_bytes_ = 0;
};

}  // namespace standoff::STANDOFF_PLATFORM
