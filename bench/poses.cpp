// SPDX-License-Identifier: Apache-2.0
// Draws the poses and the motions of the second of two bodies.
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <random>
#include <stdexcept>

#include "collision_workload.h"

namespace standoff::bench {
namespace {

class Dice {
 public:
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  Vec3 direction() {
    const double z = between(-1, 1), angle = between(0, 2 * std::numbers::pi), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }
  /// A point on a random triangle.
  Vec3 point_of(MeshView mesh) {
    const auto n = static_cast<std::size_t>(between(0, static_cast<double>(mesh.triangles.size())));
    const Triangle& t = mesh.triangles[n];
    double u = between(0, 1), v = between(0, 1);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Vec3 corner = mesh.vertices[t[0]];
    return corner + (mesh.vertices[t[1]] - corner) * u + (mesh.vertices[t[2]] - corner) * v;
  }

 private:
  std::mt19937_64 engine_{1};
};

using Draw = std::function<std::optional<Pose>(Dice&)>;

/// Draws again if a draw fails, but not for ever.
std::vector<Pose> draw_poses(std::size_t count, const Draw& draw) {
  Dice dice;
  std::vector<Pose> poses;
  for (std::size_t draws = 0; poses.size() < count; ++draws) {
    if (draws == 1000 + 100 * count) throw std::runtime_error("no such poses; ask for others");
    if (const std::optional<Pose> pose = draw(dice)) poses.push_back(*pose);
  }
  return poses;
}

std::vector<Pose> in_the_box(std::size_t count, double share, const Body& a, const Body& b) {
  std::size_t hits = static_cast<std::size_t>(share * static_cast<double>(count));
  std::size_t frees = count - hits;
  const Box box = a.bounds();
  const Vec3 middle = b.bounds().center();
  return draw_poses(count, [&](Dice& dice) -> std::optional<Pose> {
    const Vec3 at{dice.between(box.min.x, box.max.x), dice.between(box.min.y, box.max.y),
                  dice.between(box.min.z, box.max.z)};
    Pose pose = make_pose(dice.direction(), dice.between(0, 2 * std::numbers::pi), {});
    pose.translation = at - rotate(pose, middle);
    std::size_t& left = collide(a, {}, b, pose).hit() ? hits : frees;
    if (left == 0) return {};
    --left;
    return pose;
  });
}

/// Rotated at random, b approaches from far away on a straight line, along which a point of its surface would meet a
/// point of a's surface. It stops where the bodies are `gap` apart, within 1 %, for the first time.
struct Approach {
  Pose pose;
  Vec3 back;  ///< unit length, the direction that it came from
};

std::optional<Approach> approach(Dice& dice, double gap, const Body& a, const Body& b) {
  constexpr int kSteps = 300;  // a grazing line takes more; then another one is drawn
  Pose pose = make_pose(dice.direction(), dice.between(0, 2 * std::numbers::pi), {});
  const Vec3 meeting = dice.point_of(a.mesh()) - rotate(pose, dice.point_of(b.mesh()));
  const Vec3 back = dice.direction(), sides = a.bounds().extent() + b.bounds().extent();
  double away = std::sqrt(dot(sides, sides)) + gap;  // beyond the reach of both
  for (int step = 0; step < kSteps; ++step) {
    pose.translation = meeting + back * away;
    const double apart = distance(a, {}, b, pose).upper;
    if (apart <= 1.01 * gap) return Approach{pose, back};
    away -= apart - gap;  // no point is faster, so this keeps them `gap` apart
  }
  return {};
}

std::vector<Pose> near_each_other(std::size_t count, double gap, const Body& a, const Body& b) {
  return draw_poses(count, [&](Dice& dice) -> std::optional<Pose> {
    const std::optional<Approach> found = approach(dice, gap, a, b);
    if (!found) return {};
    return found->pose;
  });
}

std::vector<Pose> in_each_other(std::size_t count, double depth, const Body& a, const Body& b) {
  const double gap = depth / 10;  // near enough to count as touching
  return draw_poses(count, [&](Dice& dice) -> std::optional<Pose> {
    std::optional<Approach> found = approach(dice, gap, a, b);
    if (!found) return {};
    found->pose.translation = found->pose.translation - found->back * (gap + depth);
    if (!collide(a, {}, b, found->pose).hit()) return {};  // it passes an edge that it only came near to
    return found->pose;
  });
}

std::vector<Pose> turned_in_place(std::size_t count, double degrees, const Body& a, const Body& b) {
  return draw_poses(count, [&](Dice& dice) {
    const double most = degrees * std::numbers::pi / 180;
    Pose pose = make_pose(dice.direction(), dice.between(0, most), {});
    pose.translation = a.bounds().center() - rotate(pose, b.bounds().center());
    return std::optional(pose);
  });
}

std::vector<Pose> spun_in_place(std::size_t count, const Question& question) {
  return draw_poses(count, [&](Dice& dice) {
    const double most = *question.spin_degrees * std::numbers::pi / 180;
    const auto to_either_side = [&](const std::optional<double>& by) {
      const double length = by.value_or(0);
      return dice.between(-length, length);
    };
    const double angle = dice.between(-most, most), x = to_either_side(question.dx), y = to_either_side(question.dy),
                 z = to_either_side(question.dz);
    return std::optional(make_pose({0, 1, 0}, angle, {x, y, z}));
  });
}

}  // namespace

std::vector<Pose> PosesDrawn::of(const Question& question) {
  if (question.place) {
    Pose pose{.translation = *question.place};
    return {pose};
  }
  const std::size_t count = question.poses.value_or(settings_.poses);
  std::vector<Pose>& poses = known_[question.placing];
  const bool in_box = !question.gap && !question.depth && !question.turn_degrees && !question.spin_degrees;
  if (in_box ? poses.size() != count : poses.size() < count)
    poses = question.gap            ? near_each_other(count, *question.gap, a_, b_)
            : question.depth        ? in_each_other(count, *question.depth, a_, b_)
            : question.turn_degrees ? turned_in_place(count, *question.turn_degrees, a_, b_)
            : question.spin_degrees ? spun_in_place(count, question)
                                    : in_the_box(count, question.hits.value_or(settings_.hits), a_, b_);
  return {poses.begin(), poses.begin() + static_cast<std::ptrdiff_t>(count)};
}

std::vector<RigidMotion> make_motions(const CollisionSettings& settings, const Question& question,
                                      const std::vector<Pose>& poses) {
  Dice dice;
  const double way = question.way.value_or(settings.way);
  std::vector<RigidMotion> motions;
  for (const Pose& pose : poses) {
    RigidMotion motion{pose, pose, {}};
    if (question.rotate_degrees) {
      const Pose turn = make_pose({0, 1, 0}, *question.rotate_degrees * std::numbers::pi / 180, {});
      motion.end = compose(pose, turn);
    }
    const Vec3 direction = settings.direction.empty()
                               ? dice.direction()
                               : Vec3{settings.direction[0], settings.direction[1], settings.direction[2]};
    motion.end.translation = pose.translation + direction * way;
    motions.push_back(motion);
  }
  return motions;
}

}  // namespace standoff::bench
