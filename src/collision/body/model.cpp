#include "collision/body/model.h"

#include <cmath>

#include "core/execution.h"
#include "core/guarded.h"
#include "core/number_text.h"
#include "core/threads.h"

namespace standoff {
namespace {

// Single precision carries lengths, and their squares, in this range; the trees' coordinates are single.
constexpr double kLeastSize = 1e-12, kMostSize = 1e12;

}  // namespace

void CollisionModel::Data::finish() {
  view = field.view();
  corners.reserve(tree.order.size());
  for (const std::uint32_t t : tree.order) {
    corners.push_back({mesh.vertices[mesh.triangles[t][0]], mesh.vertices[mesh.triangles[t][1]],
                       mesh.vertices[mesh.triangles[t][2]]});
    for (const Vec3& v : corners.back()) radius = std::max(radius, length(v - middle));
  }
}

// What follows from mesh and spacing before there is a field: box and middle, and whether they will do.
void CollisionModel::place(Data& data, double spacing) {
  validate(data.mesh);
  if (!(spacing >= 0) || !std::isfinite(spacing))
    throw Error(ErrorCode::usage, "model: the spacing must be positive and finite; give zero to have it chosen");
  data.box = standoff::bounds(data.mesh);
  data.middle = data.box.center();
  const Vec3 extent = data.box.extent();
  const double size = std::max({extent.x, extent.y, extent.z});
  if (!(size <= kMostSize) || (size > 0 && size < kLeastSize) || !(length(data.middle) < 1e15))
    throw Error(ErrorCode::input,
                "model: the mesh is " + collision::number_text(size) +
                    " across; scale it to between 1e-12 and 1e12, and nearer than 1e15 to the origin");
  data.field.box = {data.box.min - data.middle, data.box.max - data.middle};
}

CollisionModel::CollisionModel(MeshView mesh, const ModelOptions& options) try {
  validate("model", options.execution, Runs::everywhere);
  const auto data = std::make_shared<Data>();
  data->mesh = {{mesh.vertices.begin(), mesh.vertices.end()}, {mesh.triangles.begin(), mesh.triangles.end()}};
  place(*data, options.spacing);
  const double spacing = options.spacing > 0 ? options.spacing : collision::default_spacing(mesh, data->box);
  Threads(options.execution.threads).run([&] {
    data->field = collision::build_field_bounds(mesh, data->middle, spacing, options.execution);
    data->tree = collision::build_tree(mesh, data->middle);
    data->finish();
  });
  data_ = data;
} catch (...) {
  throw_as_error("model", "take a larger spacing, or a machine with more");
}

MeshView CollisionModel::mesh() const { return data_->mesh; }
Box CollisionModel::bounds() const { return data_->box; }
Grid CollisionModel::grid() const {
  const double h = data_->field.spacing;
  return {data_->field.size, data_->field.origin + data_->middle, {h, h, h}};
}
double CollisionModel::band() const { return data_->field.band(); }

std::int64_t CollisionModel::memory_bytes() const {
  const Data& d = *data_;
  std::size_t bytes = d.mesh.vertices.size() * sizeof(Vec3) + d.mesh.triangles.size() * sizeof(Triangle) +
                      d.field.slots.size() * sizeof(std::int32_t) + d.field.samples.size() +
                      d.field.coarse.size() * sizeof(float) + d.corners.size() * sizeof(Corners) +
                      d.tree.order.size() * sizeof(std::uint32_t);
  for (const auto& level : d.tree.levels)
    bytes += level.balls.size() * sizeof(collision::Balls) + level.boxes.size() * sizeof(collision::Boxes);
  return static_cast<std::int64_t>(bytes);
}

}  // namespace standoff
