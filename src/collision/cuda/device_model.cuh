// SPDX-License-Identifier: Apache-2.0
// A collision model in device memory.
#pragma once

#include "collision/device.h"
#include "geometry/triple.h"
#include "gpu/devices.h"
#include "gpu/platform.cuh"

namespace standoff::STANDOFF_PLATFORM {

using collision::kLanes;

// Levels of a BVH over as many triangles as there may be: sixteen to the eighth power.
inline constexpr int kMostLevels = 8;

/// What kernels read of a model. What it points to lies in device memory.
struct DeviceModelView {
  collision::FieldView field;
  const collision::Sphere16* spheres[kMostLevels];  ///< by level, as in Bvh16
  const collision::Aabb16* boxes[kMostLevels];
  const collision::Triangle16* triangles;
  const double* corners;  ///< nine a triangle, by index in the BVH
  Triple<double> middle;
  std::uint32_t triangle_count;
  int top;  ///< level
};

/// Corners of a triangle, by its index in the BVH, in the model's own coordinates.
STANDOFF_DEVICE void load_corners(const DeviceModelView& model, std::uint32_t index, Triple<double> (&corner)[3]) {
  const double* const at = model.corners + 9 * std::int64_t{index};
  for (int k = 0; k < 3; ++k) corner[k] = {at[3 * k], at[3 * k + 1], at[3 * k + 2]};
}

class DeviceModel : public gpu::DeviceCopy {
 public:
  explicit DeviceModel(const collision::ModelData& data) {
    static_assert(sizeof(standoff::Corners) == 9 * sizeof(double));
    gpu::Workspace measure(nullptr);
    lay_out(data, measure, [](auto*, const auto*, std::int64_t) {});
    memory_ = Memory(measure.used());
    gpu::Workspace arrays(memory_.as<void>());
    lay_out(data, arrays, [](auto* to, const auto* from, std::int64_t bytes) { copy_in(to, from, bytes); });
  }
  const DeviceModelView& view() const { return view_; }

 private:
  template <class Copy>
  void lay_out(const collision::ModelData& data, gpu::Workspace& arrays, Copy copy) {
    const auto put = [&]<class Values>(const Values& values) {
      using Value = typename Values::value_type;
      const auto count = static_cast<std::int64_t>(values.size());
      Value* const to = arrays.take<Value>(count);
      copy(to, values.data(), count * static_cast<std::int64_t>(sizeof(Value)));
      return to;
    };
    view_.field = data.view;
    view_.field.slots = put(data.field.slots);
    view_.field.samples = put(data.field.samples);
    view_.field.coarse = put(data.field.coarse);
    view_.top = data.bvh.top();
    for (int level = 0; level <= view_.top; ++level) {
      view_.spheres[level] = put(data.bvh.levels[level].spheres);
      view_.boxes[level] = put(data.bvh.levels[level].boxes);
    }
    view_.triangles = put(data.bvh.triangles);
    view_.corners = reinterpret_cast<const double*>(put(data.corners));
    view_.middle = {data.middle.x, data.middle.y, data.middle.z};
    view_.triangle_count = static_cast<std::uint32_t>(data.bvh.order.size());
  }

  Memory memory_;
  DeviceModelView view_{};
};

/// The model's copy on a device, which must be the current one.
inline std::shared_ptr<const DeviceModel> device_model_of(const collision::ModelData& data, Backend backend,
                                                          int device) {
  return std::static_pointer_cast<const DeviceModel>(
      data.device_models.get(backend, device, [&] { return std::make_shared<DeviceModel>(data); }));
}

}  // namespace standoff::STANDOFF_PLATFORM
