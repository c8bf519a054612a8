// SPDX-License-Identifier: Apache-2.0
// FCL's answers to collision queries: BVHs of OBBRSS, as in FCL's own benchmarks.
#include <fcl/fcl.h>

#include <algorithm>

#include "collision_contest.h"

namespace {

using namespace standoff;
using Bvh = fcl::BVHModel<fcl::OBBRSSd>;

void fill(Bvh& bvh, const Mesh& mesh) {
  std::vector<fcl::Vector3d> vertices;
  for (const Vec3& v : mesh.vertices) vertices.emplace_back(v.x, v.y, v.z);
  std::vector<fcl::Triangle> triangles;
  for (const Triangle& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  bvh.beginModel();
  bvh.addSubModel(vertices, triangles);
  bvh.endModel();
}

fcl::Transform3d to_fcl(const Pose& pose) {
  fcl::Transform3d transform = fcl::Transform3d::Identity();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) transform.linear()(i, j) = pose.rotation[3 * i + j];
  transform.translation() = fcl::Vector3d(pose.translation.x, pose.translation.y, pose.translation.z);
  return transform;
}

class Fcl : public bench::CollisionPeer {
 public:
  Fcl(const Mesh& a, const Mesh& b) {
    fill(a_, a);
    fill(b_, b);
  }

  bool collide(const Pose& pose) const override { return run({1, false}, pose).isCollision(); }

  std::size_t contacts(const Pose& pose, std::size_t most) const override {
    const fcl::CollisionResultd result = run({most, true}, pose);
    // Points of the same pair follow each other.
    std::size_t pairs = 0;
    for (std::size_t n = 0; n < result.numContacts(); ++n) {
      const auto& now = result.getContact(n);
      pairs += n == 0 || now.b1 != result.getContact(n - 1).b1 || now.b2 != result.getContact(n - 1).b2;
    }
    return pairs;
  }

  double distance(const Pose& pose) const override {
    const fcl::DistanceRequestd request(true);
    fcl::DistanceResultd result;
    return std::max(0.0, fcl::distance(&a_, fcl::Transform3d::Identity(), &b_, to_fcl(pose), request, result));
  }

 private:
  fcl::CollisionResultd run(const fcl::CollisionRequestd& request, const Pose& pose) const {
    fcl::CollisionResultd result;
    fcl::collide(&a_, fcl::Transform3d::Identity(), &b_, to_fcl(pose), request, result);
    return result;
  }

  Bvh a_, b_;
};

}  // namespace

int main(int argc, char** argv) {
  return bench::run_collision_contest(argc, argv, "FCL",
                                      [](const Mesh& a, const Mesh& b) { return std::make_unique<Fcl>(a, b); });
}
