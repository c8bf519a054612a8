// A body of collision queries in device memory.
#pragma once

#include "collision/device.h"
#include "geometry/triple.h"
#include "gpu/platform.cuh"
#include "gpu/workspace.h"

namespace standoff::STANDOFF_PLATFORM {

using collision::kLanes;

// Levels of a tree over as many triangles as there may be: sixteen to the eighth power.
inline constexpr int kMostLevels = 8;

/// What kernels read of a body. What it points to lies in device memory.
struct BodyView {
  collision::FieldView field;
  const collision::Balls* balls[kMostLevels];  ///< by level, as in Tree
  const collision::Boxes* boxes[kMostLevels];
  const collision::Faces* faces;
  const double* corners;  ///< nine a triangle, by place in the tree
  Triple<double> middle;
  std::uint32_t triangles;
  int top;  ///< level
};

/// Corners of the triangle at a place in the tree, in the body's own coordinates.
STANDOFF_DEVICE void load_corners(const BodyView& body, std::uint32_t place, Triple<double> (&corner)[3]) {
  const double* const at = body.corners + 9 * std::int64_t{place};
  for (int k = 0; k < 3; ++k) corner[k] = {at[3 * k], at[3 * k + 1], at[3 * k + 2]};
}

class BodyOnDevice : public collision::OnDevice {
 public:
  explicit BodyOnDevice(const collision::ModelData& data) {
    static_assert(sizeof(standoff::Corners) == 9 * sizeof(double));
    gpu::Workspace measure(nullptr);
    place(data, measure, [](auto*, const auto*, std::int64_t) {});
    memory_ = Memory(measure.used());
    gpu::Workspace arrays(memory_.as<void>());
    place(data, arrays, [](auto* to, const auto* from, std::int64_t bytes) { copy_in(to, from, bytes); });
  }
  const BodyView& view() const { return view_; }

 private:
  template <class Copy>
  void place(const collision::ModelData& data, gpu::Workspace& arrays, Copy copy) {
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
    view_.top = data.tree.top();
    for (int level = 0; level <= view_.top; ++level) {
      view_.balls[level] = put(data.tree.levels[level].balls);
      view_.boxes[level] = put(data.tree.levels[level].boxes);
    }
    view_.faces = put(data.tree.faces);
    view_.corners = reinterpret_cast<const double*>(put(data.corners));
    view_.middle = {data.middle.x, data.middle.y, data.middle.z};
    view_.triangles = static_cast<std::uint32_t>(data.tree.order.size());
  }

  Memory memory_;
  BodyView view_{};
};

/// The body's copy on a device, which is the current one.
inline std::shared_ptr<const BodyOnDevice> on_device(const collision::ModelData& data, Backend backend, int device) {
  return std::static_pointer_cast<const BodyOnDevice>(
      data.copies.get(backend, device, [&] { return std::make_shared<BodyOnDevice>(data); }));
}

}  // namespace standoff::STANDOFF_PLATFORM
