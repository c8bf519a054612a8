// Yes or no.
#include "collision/batch.h"
#include "collision/touching.h"

namespace difi {
namespace {

void check(const CollideOptions& options) {
  if (!(options.margin >= 0) || !(options.margin <= 1e30))
    throw Error(ErrorCode::usage, "collide: the margin must be zero or more, and finite");
}

Collided collide_checked(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b, const Pose& pose_b,
                         const CollideOptions& options) {
  const collision::Pair pair(a, pose_a, b, pose_b);
  if (options.mode == CollideMode::certified) return {.contact = collision::certify(pair, options.margin)};
  const auto found = collision::find_touching(pair, options.margin);
  if (!found) return {};
  std::uint32_t first = pair.field.triangle(found->of_field), second = pair.tree.triangle(found->of_tree);
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

std::vector<Collided> collide_all(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                                  std::span<const Pose> poses_b, const CollideOptions& options, int threads) {
  check(options);
  validate(pose_a);
  collision::validate_all(poses_b);
  return collision::for_each<Collided>(
      poses_b.size(), threads, [&](std::size_t n) { return collide_checked(a, pose_a, b, poses_b[n], options); });
}

}  // namespace difi
