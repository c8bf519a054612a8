// SPDX-License-Identifier: Apache-2.0
#include "collision/body/model.h"

#include <cmath>

#include "collision/body/components.h"
#include "core/guarded.h"
#include "core/mesh_copy.h"
#include "core/number_text.h"
#include "core/progress.h"
#include "core/threads.h"

namespace standoff {
namespace collision {
void ModelData::finish(ProgressMeter& progress) {
  constexpr std::size_t kCheckEvery = std::size_t{1} << 16;  // triangles
  view = field.view();
  corners.reserve(bvh.order.size());
  for (const std::uint32_t t : bvh.order) {
    if (corners.size() % kCheckEvery == 0) progress.check();
    corners.push_back({mesh.vertices[mesh.triangles[t][0]], mesh.vertices[mesh.triangles[t][1]],
                       mesh.vertices[mesh.triangles[t][2]]});
    for (const Vec3& v : corners.back()) radius = std::max(radius, length(v - middle));
  }
}

void ModelData::prepare(double spacing) {
  validate(mesh);
  if (!(spacing >= 0) || !std::isfinite(spacing))
    throw Error(ErrorCode::usage, "model: the spacing must be positive and finite; give zero to have it chosen");
  box = bounds(mesh);
  middle = box.center();
  const double size = box.longest_side();
  if (!(size <= kMaxModelSize) || (size > 0 && size < kMinModelSize) || !(length(middle) < kMaxPosition))
    throw Error(ErrorCode::input, "model: the mesh is " + number_text(size) + " across; scale it to between " +
                                      number_text(kMinModelSize) + " and " + number_text(kMaxModelSize) +
                                      ", and nearer than " + number_text(kMaxPosition) + " to the origin");
  field.box = {box.min - middle, box.max - middle};
}

std::int64_t ModelData::memory_bytes() const {
  const auto bytes = [](const auto& array) { return array.size() * sizeof(array[0]); };
  std::size_t sum = bytes(mesh.vertices) + bytes(mesh.triangles) + bytes(field.slots) + bytes(field.samples) +
                    bytes(field.coarse) + bytes(field.inside) + bytes(field.coarse_inside) + bytes(corners) +
                    bytes(components) + bytes(bvh.order) + bytes(bvh.triangles);
  for (const BvhLevel& level : bvh.levels) sum += bytes(level.spheres) + bytes(level.boxes);
  return static_cast<std::int64_t>(sum);
}

}  // namespace collision

CollisionModel::CollisionModel(MeshView mesh, const ModelOptions& options) try {
  validate("model", options.execution, Runs::everywhere);
  const auto data = std::make_shared<collision::ModelData>();
  validate(mesh);
  data->mesh = copy_of(mesh);
  data->prepare(options.spacing);
  const double spacing = options.spacing > 0 ? options.spacing : collision::default_spacing(mesh, data->box);
  ProgressMeter progress(options.progress);
  Threads(options.execution.threads).run([&] {
    progress.stage("fields", 2, 0, 0.7);
    data->field = collision::build_field_bounds(mesh, data->middle, spacing, options.execution, progress);
    progress.stage("bvh", 1, 0.7, 0.9);
    data->bvh = collision::build_bvh(mesh, data->middle, progress);
    progress.stage("components", 1, 0.9, 1);
    data->components = collision::first_of_components(mesh, progress);
    data->finish(progress);
  });
  progress.stage("done", 1, 1, 1);
  data_ = data;
} catch (...) {
  throw_as_error("model", "take a larger spacing, or provide more memory");
}

MeshView CollisionModel::mesh() const { return data_->mesh; }
Box CollisionModel::bounds() const { return data_->box; }
Grid CollisionModel::grid() const {
  const double h = data_->field.spacing;
  return {data_->field.size, data_->field.origin + data_->middle, {h, h, h}};
}
double CollisionModel::thickness() const { return data_->field.thickness(); }
bool CollisionModel::closed() const { return data_->field.has_sign(); }

std::int64_t CollisionModel::memory_bytes() const { return data_->memory_bytes(); }

}  // namespace standoff
