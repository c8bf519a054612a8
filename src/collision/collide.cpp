// Yes or no: balls of one body's tree against the other's field, nearest first; where the field cannot tell, triangles.
#include <algorithm>
#include <bit>
#include <cmath>

#include "collision/batch.h"
#include "collision/pair.h"

namespace difi {
namespace collision {
namespace {

class Search {
 public:
  Search(const Pair& pair, double margin)
      : pair_(pair),
        kernels_(kernels()),
        margin_(margin),
        limit_(static_cast<float>(margin) * 1.000001f + pair.slack) {}

  bool run() {
    if (pair_.root_gap() > margin_ + pair_.slack) return false;
    return visit(pair_.tree.body->tree.top(), 0);
  }

  std::uint32_t of_field = 0, of_tree = 0;  ///< the pair found, places in the trees

 private:
  bool visit(int level, std::uint32_t packet) {
    alignas(64) float gap[kLanes];
    const Level& nodes = pair_.tree.body->tree.levels[level];
    kernels_.gaps(pair_.field.body->view, pair_.place, nodes.balls[packet], limit_, gap);
    int lanes[kLanes], count = 0;
    for (int n = 0; n < kLanes; ++n)
      if (gap[n] <= limit_) lanes[count++] = n;
    if (count == 0) return false;
    if (level == 0) return test_triangles(packet, lanes, count);
    std::sort(lanes, lanes + count, [&gap](int a, int b) { return gap[a] < gap[b]; });
    for (int n = 0; n < count; ++n)
      if (visit(level - 1, packet * kLanes + lanes[n])) return true;
    return false;
  }

  // The triangles `lanes` of a packet of the tree's body against those of the field's body near them.
  bool test_triangles(std::uint32_t packet, const int* lanes, int count) {
    FloatBox boxes[kLanes], all;
    for (int n = 0; n < count; ++n) {
      boxes[n] = pair_.box_of(packet * kLanes + lanes[n]);
      boxes[n].grow(limit_);
      all.include(boxes[n]);
    }
    const Tree& tree = pair_.field.body->tree;
    return descend(tree.top(), 0, packet, lanes, count, boxes, all);
  }

  bool descend(int level, std::uint32_t node, std::uint32_t packet, const int* lanes, int count, const FloatBox* boxes,
               const FloatBox& all) {
    const Level& nodes = pair_.field.body->tree.levels[level];
    if (level > 0) {
      for (std::uint32_t mask = kernels_.overlaps(nodes.boxes[node], all); mask != 0; mask &= mask - 1)
        if (descend(level - 1, node * kLanes + std::countr_zero(mask), packet, lanes, count, boxes, all)) return true;
      return false;
    }
    for (int n = 0; n < count; ++n)
      for (std::uint32_t mask = kernels_.overlaps(nodes.boxes[node], boxes[n]); mask != 0; mask &= mask - 1)
        if (test(node * kLanes + std::countr_zero(mask), packet * kLanes + lanes[n])) return true;
    return false;
  }

  bool test(std::uint32_t field_place, std::uint32_t tree_place) {
    const Corners p = pair_.field.world(field_place), q = pair_.tree.world(tree_place);
    bool hit = triangles_touch(p, q);
    if (!hit && margin_ > 0) hit = closest_points(p, q).distance_sq <= margin_ * margin_;
    if (hit) of_field = field_place, of_tree = tree_place;
    return hit;
  }

  const Pair& pair_;
  const Kernels& kernels_;
  const double margin_;
  const float limit_;  // balls and boxes farther away than this are farther than the margin
};

}  // namespace
}  // namespace collision

namespace {

void check(const CollideOptions& options) {
  if (!(options.margin >= 0) || !(options.margin <= 1e30))
    throw Error(ErrorCode::usage, "collide: the margin must be zero or more, and finite");
}

Collided collide_checked(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b, const Pose& pose_b,
                         const CollideOptions& options) {
  const collision::Pair pair(a, pose_a, b, pose_b);
  collision::Search search(pair, options.margin);
  if (!search.run()) return {};
  std::uint32_t first = pair.field.triangle(search.of_field), second = pair.tree.triangle(search.of_tree);
  if (pair.swapped) std::swap(first, second);
  return {Contact::hit, first, second};
}

}  // namespace

Collided collide(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b, const Pose& pose_b,
                 const CollideOptions& options) {
  check(options);
  validate(pose_a);
  validate(pose_b);
  return collide_checked(a, pose_a, b, pose_b, options);
}

std::vector<Collided> collide(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                              std::span<const Pose> poses_b, const CollideOptions& options, int threads) {
  check(options);
  validate(pose_a);
  collision::validate_all(poses_b);
  return collision::for_each<Collided>(
      poses_b.size(), threads, [&](std::size_t n) { return collide_checked(a, pose_a, b, poses_b[n], options); });
}

}  // namespace difi
