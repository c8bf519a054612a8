// SPDX-License-Identifier: Apache-2.0
// Coal's answers to collision queries, with BVHs of OBBRSS, as in FCL, whose successor it is.
#include <coal/BVH/BVH_model.h>
#include <coal/collision.h>
#include <coal/distance.h>

#include <algorithm>

#include "collision_contest.h"

namespace {

using namespace standoff;
using Bvh = coal::BVHModel<coal::OBBRSS>;

void fill(Bvh& bvh, const Mesh& mesh) {
  std::vector<coal::Vec3s> vertices;
  for (const Vec3& v : mesh.vertices) vertices.emplace_back(v.x, v.y, v.z);
  std::vector<coal::Triangle> triangles;
  for (const Triangle& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  bvh.beginModel();
  bvh.addSubModel(vertices, triangles);
  bvh.endModel();
}

coal::Transform3s to_coal(const Pose& pose) {
  coal::Matrix3s rotation;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) rotation(i, j) = pose.rotation[3 * i + j];
  return {rotation, coal::Vec3s(pose.translation.x, pose.translation.y, pose.translation.z)};
}

class Coal : public bench::CollisionPeer {
 public:
  Coal(const Mesh& a, const Mesh& b) {
    fill(a_, a);
    fill(b_, b);
  }

  bool collide(const Pose& pose) const override { return run({coal::NO_REQUEST, 1}, pose) > 0; }
  std::size_t contacts(const Pose& pose, std::size_t most) const override { return run({coal::CONTACT, most}, pose); }

  double distance(const Pose& pose) const override {
    const coal::DistanceRequest request(true, false);
    coal::DistanceResult result;
    return std::max(0.0, coal::distance(&a_, coal::Transform3s(), &b_, to_coal(pose), request, result));
  }

 private:
  std::size_t run(const coal::CollisionRequest& request, const Pose& pose) const {
    coal::CollisionResult result;
    coal::collide(&a_, coal::Transform3s(), &b_, to_coal(pose), request, result);
    return result.numContacts();
  }

  Bvh a_, b_;
};

}  // namespace

int main(int argc, char** argv) {
  return bench::run_collision_contest(argc, argv, "Coal",
                                      [](const Mesh& a, const Mesh& b) { return std::make_unique<Coal>(a, b); });
}
