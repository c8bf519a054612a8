// SPDX-License-Identifier: Apache-2.0
// What a CollisionModel holds.
#pragma once

#include <vector>

#include "collision/body/bvh16.h"
#include "collision/body/field_bounds.h"
#include "gpu/devices.h"
#include "standoff/collision.h"

namespace standoff {

namespace collision {

struct ModelData {
  Mesh mesh;
  Box box;            ///< of the corners
  Vec3 middle;        ///< BVH and fields are relative to it
  double radius = 0;  ///< of a sphere about the middle that holds all corners
  FieldBounds field;
  FieldView view{};  ///< of `field`
  Bvh16 bvh;
  HugePageVector<Corners> corners;        ///< of the triangles, in the order of the BVH
  std::vector<std::uint32_t> components;  ///< the first triangle of each connected component
  gpu::DeviceCopies device_models;        ///< what GPUs keep of all this

  /// The first step of building and of loading: checks the mesh, and sets box and middle. A spacing of 0 is chosen
  /// later. Errors: input, usage.
  void prepare(double spacing);
  /// The last step: everything that follows from mesh, field and the order of the BVH.
  void finish(ProgressMeter& progress);
  std::int64_t memory_bytes() const;
};

/// A model's data, for this library alone.
struct ModelAccess {
  static const ModelData& data(const CollisionModel& model) { return *model.data_; }
  static CollisionModel model(std::shared_ptr<const ModelData> data) { return CollisionModel(std::move(data)); }
};
inline const ModelData& data_of(const CollisionModel& model) { return ModelAccess::data(model); }

}  // namespace collision
}  // namespace standoff
