// SPDX-License-Identifier: Apache-2.0
// Algorithm 2 of the thesis on a GPU: fields and moving meshes in its memory, and the rows of the table of devices
// (thesis/algorithm_2.h). nvcc compiles this file for CUDA; algorithm_2_emulated.cpp compiles it for the emulation.
#include "thesis/algorithm_2.cuh"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "backends/cuda/fields.h"
#include "field/prepare.h"
#include "gpu/platform.cuh"
#include "standoff/thesis.h"

namespace standoff::STANDOFF_PLATFORM {
namespace {

// A mesh in device memory, as it was given and as it was moved, and the field of the latter.
class MovingOnDevice final : public thesis::MovingField {
 public:
  // For the current device.
  MovingOnDevice(const Mesh& mesh, const thesis::MinimumRule& rule, int device) : rule_(rule), device_(device) {
    gpu::Workspace measure(nullptr);
    lay_out(mesh, measure);
    memory_ = Memory(measure.used());
    gpu::Workspace arrays(memory_.as<void>());
    lay_out(mesh, arrays);
    copy_in(vertices_, mesh.vertices.data(), static_cast<std::int64_t>(mesh.vertices.size() * sizeof(Vec3)));
    copy_in(triangles_, mesh.triangles.data(), static_cast<std::int64_t>(mesh.triangles.size() * sizeof(Triangle)));
  }

  const thesis::HeldField& move_to(const Pose& pose) override {
    const DeviceScope scope(device_);
    Task task;
    task.mesh = {moved_, vertex_count_, triangles_, triangle_count_};
    task.thickness = rule_.thickness;
    task.method = Method::thesis;
    task.outcome = &found_->outcome;
    launch(nullptr, "move vertices", move_vertices, striding_blocks(vertex_count_), kThreads, vertices_, vertex_count_,
           pose, moved_);
    const Box box = found_box(task.mesh);
    task.grid = minimum_grid(box, rule_.thickness, rule_.e, rule_.speed);
    check_domain(box, task.grid);
    held_.grid = task.grid;
    held_.thickness = rule_.thickness;
    held_.values = task.output.values = held_.memory.room_for<float>(task.grid.sample_count());
    char* const workspace = workspace_.room_for<char>(
        STANDOFF_PLATFORM::workspace_bytes(triangle_count_, task.grid, task.thickness, task.method, 0));
    STANDOFF_PLATFORM::enqueue(task, workspace, workspace_.bytes(), nullptr);
    Outcome outcome{};
    copy_out(&outcome, task.outcome, sizeof outcome);
    cuda::check(outcome, task);
    return held_;
  }

 private:
  void lay_out(const Mesh& mesh, gpu::Workspace& arrays) {
    static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Triangle) == 3 * sizeof(std::uint32_t));
    vertex_count_ = static_cast<std::int64_t>(mesh.vertices.size());
    triangle_count_ = static_cast<std::int64_t>(mesh.triangles.size());
    vertices_ = arrays.take<double>(3 * vertex_count_);
    moved_ = arrays.take<double>(3 * vertex_count_);
    triangles_ = arrays.take<std::uint32_t>(3 * triangle_count_);
    found_ = arrays.take<Found>(1);
  }

  // The host needs the box: the grid's size is the size of the work.
  Box found_box(const DeviceMesh& mesh) const {
    fill_bytes(nullptr, found_, 0xff, sizeof(Found));
    find_box(mesh, found_, nullptr);
    Found found;
    copy_out(&found, found_, sizeof found);
    return box_of(found);
  }

  thesis::MinimumRule rule_;
  int device_;
  Memory memory_;
  std::int64_t vertex_count_ = 0, triangle_count_ = 0;
  double *vertices_ = nullptr, *moved_ = nullptr;
  std::uint32_t* triangles_ = nullptr;
  Found* found_ = nullptr;
  Growing workspace_;
  FieldOnDevice held_;
};

std::shared_ptr<const thesis::HeldField> hold_field(DistanceField field, int device) {
  const DeviceScope scope(device);
  auto held = std::make_shared<FieldOnDevice>();
  held->grid = field.grid();
  held->thickness = field.thickness();
  held->values = held->memory.room_for<float>(held->grid.sample_count());
  // In parts: the values of all samples may take far more memory than the field's tiles.
  constexpr std::int64_t kSamplesAtOnce = std::int64_t{1} << 22;
  const Size3& size = held->grid.size;
  const std::int64_t in_slice = size.x * size.y, most = std::max<std::int64_t>(1, kSamplesAtOnce / in_slice);
  std::vector<float> part;
  for (std::int64_t first = 0; first < size.z; first += most) {
    const std::int64_t slices = std::min(most, size.z - first);
    part.resize(static_cast<std::size_t>(slices * in_slice));
    field.copy_slices(first, slices, part);
    copy_in(held->values + first * in_slice, part.data(), static_cast<std::int64_t>(part.size() * sizeof(float)));
  }
  return held;
}

std::unique_ptr<thesis::MovingField> moving_field(const Mesh& mesh, const thesis::MinimumRule& rule,
                                                  const Execution& execution) {
  const DeviceScope scope(execution.device);
  return std::make_unique<MovingOnDevice>(mesh, rule, execution.device);
}

std::int64_t first_below(const thesis::Algorithm2Job& job, double threshold) {
  const DeviceScope scope(job.device);
  const Counter found = found_by<false>(job, threshold);
  return found == kNotFound ? thesis::kNoSample : static_cast<std::int64_t>(found);
}

double least_sum(const thesis::Algorithm2Job& job) {
  const DeviceScope scope(job.device);
  return unordered(found_by<true>(job, 0));
}

}  // namespace

const thesis::Algorithm2Functions kAlgorithm2{hold_field, moving_field, first_below, least_sum};

}  // namespace standoff::STANDOFF_PLATFORM
