#include "collision_workload.h"

#include <cmath>
#include <numbers>
#include <random>

namespace difi::bench {
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

 private:
  std::mt19937_64 engine_{1};
};

}  // namespace

void add_options(CLI::App& app, CollisionSettings& settings) {
  app.add_option("--a", settings.a, "the scene that rests");
  app.add_option("--b", settings.b, "the scene that is placed");
  app.add_option("--triangles-a", settings.triangles_a);
  app.add_option("--triangles-b", settings.triangles_b);
  app.add_option("--poses", settings.poses);
  app.add_option("--hits", settings.hits, "the share of poses that collide");
  app.add_option("--way", settings.way, "length of a sweep, world units");
  app.add_option("--direction", settings.direction, "of all sweeps, a unit vector, instead of random ones")
      ->expected(3);
  app.add_option("--tolerance", settings.tolerance, "of a sweep");
}

std::vector<Pose> make_poses(const CollisionSettings& settings, const Question& question, const CollisionModel& a,
                             const CollisionModel& b) {
  if (question.place) {
    Pose pose;
    pose.translation = *question.place;
    return {pose};
  }
  Dice dice;
  std::size_t hits = static_cast<std::size_t>(settings.hits * static_cast<double>(settings.poses));
  std::size_t frees = settings.poses - hits;
  const Box box = a.bounds();
  const Vec3 middle = b.bounds().center();
  std::vector<Pose> poses;
  while (hits + frees > 0) {
    const Vec3 at{dice.between(box.min.x, box.max.x), dice.between(box.min.y, box.max.y),
                  dice.between(box.min.z, box.max.z)};
    Pose pose = make_pose(dice.direction(), dice.between(0, 2 * std::numbers::pi), {});
    pose.translation = at - rotate(pose, middle);
    std::size_t& left = collide(a, {}, b, pose).hit() ? hits : frees;
    if (left == 0) continue;
    --left;
    poses.push_back(pose);
  }
  return poses;
}

std::vector<Motion> make_motions(const CollisionSettings& settings, const std::vector<Pose>& poses) {
  Dice dice;
  std::vector<Motion> motions;
  for (const Pose& pose : poses) {
    Motion motion{pose, pose, {}};
    const Vec3 direction = settings.direction.empty()
                               ? dice.direction()
                               : Vec3{settings.direction[0], settings.direction[1], settings.direction[2]};
    motion.to.translation = pose.translation + direction * settings.way;
    motions.push_back(motion);
  }
  return motions;
}

}  // namespace difi::bench
