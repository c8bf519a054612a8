// SPDX-License-Identifier: Apache-2.0
// Stand-in until the engine is here.
#include <memory>

#include "standoff/error.h"
#include "standoff/points.h"

namespace standoff {

struct MeshQuery::Data {
  Mesh mesh;
  SignReport sign;
};

MeshQuery::MeshQuery(MeshView mesh, const MeshQueryOptions& options) {
  validate(mesh);
  auto data = std::make_shared<Data>();
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) data->mesh.vertices.push_back(mesh.vertices[v]);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) data->mesh.triangles.push_back(mesh.triangles[t]);
  data->sign.method = options.sign.method;
  data_ = data;
}
MeshView MeshQuery::mesh() const { return data_->mesh; }
const SignReport& MeshQuery::sign() const { return data_->sign; }
std::int64_t MeshQuery::memory_bytes() const { return 0; }
void MeshQuery::closest(std::span<const Vec3> points, std::span<ClosestPoint> out, const Execution& execution,
                        const ProgressCallback&) const {
  const auto found = closest_points(mesh(), points, execution);
  for (std::size_t n = 0; n < found.size(); ++n) out[n] = found[n];
}
void MeshQuery::distances(std::span<const Vec3> points, std::span<double> out, const Execution& execution,
                          const ProgressCallback&) const {
  const auto found = closest_points(mesh(), points, execution);
  for (std::size_t n = 0; n < found.size(); ++n) out[n] = found[n].distance;
}
void MeshQuery::winding_numbers(std::span<const Vec3>, std::span<double> out, const Execution&,
                                const ProgressCallback&) const {
  for (double& w : out) w = 0;
}
Vec3 MeshQuery::gradient(Vec3 point, const ClosestPoint& at) const {
  const Vec3 v = point - at.point;
  return length(v) > 0 ? v / Vec3{length(v), length(v), length(v)} : Vec3{0, 0, 1};
}

}  // namespace standoff
