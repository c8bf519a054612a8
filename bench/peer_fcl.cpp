// Collision queries beside FCL's (BVHs of OBBRSS, as FCL's own benchmarks): both in one process, taking turns over
// all poses, so that a noisy machine disturbs both alike. Times are processor time of one thread, medians of the
// rounds.
#include <fcl/fcl.h>

#include <algorithm>
#include <ctime>
#include <iostream>
#include <memory>
#include <numbers>
#include <random>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "difi/collision.h"
#include "scenes/scenes.h"

namespace {

using namespace difi;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Settings {
  std::string query = "collide", a = "labyrinth", b = "fly";
  std::int64_t triangles_a = 0, triangles_b = 0;
  std::size_t poses = 10'000;
  double hits = 0.45;  ///< the share of poses that collide
  double way = 0.5;    ///< of a sweep
  double tolerance = 1e-4;
  double height = -1;  ///< one pose instead: b so far above where it is made
};

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

/// Poses drawn evenly from a's box, turned at random, until so many collide and so many do not.
std::vector<Pose> draw_poses(const Settings& settings, const CollisionModel& a, const CollisionModel& b) {
  if (settings.height >= 0) {
    Pose pose;
    pose.translation.y = settings.height;
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

using Bvh = fcl::BVHModel<fcl::OBBRSSd>;

std::shared_ptr<Bvh> make_bvh(const Mesh& mesh) {
  std::vector<fcl::Vector3d> vertices;
  for (const Vec3& v : mesh.vertices) vertices.emplace_back(v.x, v.y, v.z);
  std::vector<fcl::Triangle> triangles;
  for (const Triangle& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  auto bvh = std::make_shared<Bvh>();
  bvh->beginModel();
  bvh->addSubModel(vertices, triangles);
  bvh->endModel();
  return bvh;
}

fcl::Transform3d to_fcl(const Pose& pose) {
  fcl::Transform3d transform = fcl::Transform3d::Identity();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) transform.linear()(i, j) = pose.rotation[3 * i + j];
  transform.translation() = fcl::Vector3d(pose.translation.x, pose.translation.y, pose.translation.z);
  return transform;
}

/// A query both answer: a number, which must agree, and whether `difi`'s may stand beside `fcl`'s.
struct Contest {
  const Settings& settings;
  const CollisionModel &a, &b;
  const Bvh &bvh_a, &bvh_b;
  std::vector<Vec3> ways;  ///< of the sweeps, by pose

  double difi(const Pose& pose, std::size_t n) const {
    if (settings.query == "collide") return collide(a, {}, b, pose).hit();
    if (settings.query == "contacts") return static_cast<double>(contacts(a, {}, b, pose).contacts.size());
    if (settings.query == "distance") return distance(a, {}, b, pose).upper;
    Motion motion{pose, pose, {}};
    motion.to.translation = pose.translation + ways[n];
    const Swept swept = sweep(a, {}, b, motion, {settings.tolerance});
    return swept.hit ? swept.time : 2;
  }

  double fcl_distance(const fcl::Transform3d& at) const {
    const fcl::DistanceRequestd request(true);
    fcl::DistanceResultd result;
    return std::max(0.0, fcl::distance(&bvh_a, fcl::Transform3d::Identity(), &bvh_b, at, request, result));
  }

  double fcl(const Pose& pose, std::size_t n) const {
    fcl::Transform3d at = to_fcl(pose);
    if (settings.query == "distance") return fcl_distance(at);
    if (settings.query == "sweep") {
      // Conservative advancement: the way is straight, so no point is faster than it is long.
      const fcl::Vector3d from = at.translation(), way(ways[n].x, ways[n].y, ways[n].z);
      for (double t = 0; t <= 1;) {
        at.translation() = from + way * t;
        const double apart = fcl_distance(at);
        if (apart <= settings.tolerance) return t;
        t += (apart - settings.tolerance / 2) / settings.way;
      }
      return 2;
    }
    const bool all = settings.query == "contacts";
    const fcl::CollisionRequestd request(all ? 100 : 1, all);
    fcl::CollisionResultd result;
    fcl::collide(&bvh_a, fcl::Transform3d::Identity(), &bvh_b, at, request, result);
    return static_cast<double>(result.numContacts());
  }

  bool agree(double ours, double theirs) const {
    if (settings.query == "distance") return std::abs(ours - theirs) <= 1e-6 * (1 + theirs);
    if (settings.query == "contacts") return (ours > 0) == (theirs > 0);
    // A sweep stops anywhere within the tolerance, so times differ; one that ends free where FCL found the bodies
    // within half the tolerance would be a miss.
    if (settings.query == "sweep") return ours <= 1 || theirs > 1;
    return ours == theirs;
  }
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

nlohmann::json run(const Settings& settings) {
  const Mesh mesh_a = scenes::make(settings.a, settings.triangles_a),
             mesh_b = scenes::make(settings.b, settings.triangles_b);
  double start = cpu_seconds();
  const CollisionModel a(mesh_a), b(mesh_b);
  const double build = cpu_seconds() - start;
  start = cpu_seconds();
  const auto bvh_a = make_bvh(mesh_a), bvh_b = make_bvh(mesh_b);
  const double fcl_build = cpu_seconds() - start;
  const std::vector<Pose> poses = draw_poses(settings, a, b);
  Contest contest{settings, a, b, *bvh_a, *bvh_b, {}};
  Dice dice;
  for (std::size_t n = 0; n < poses.size(); ++n) contest.ways.push_back(dice.direction() * settings.way);

  // Whole rounds: in shorter turns each would first have to fetch what the other drove out of the caches.
  constexpr int kRounds = 5;
  std::vector<double> ours_s, theirs_s, ours(poses.size()), theirs(poses.size());
  std::int64_t differ = 0, hits = 0;
  for (int round = 0; round < kRounds; ++round) {
    start = cpu_seconds();
    for (std::size_t n = 0; n < poses.size(); ++n) ours[n] = contest.difi(poses[n], n);
    const double between = cpu_seconds();
    for (std::size_t n = 0; n < poses.size(); ++n) theirs[n] = contest.fcl(poses[n], n);
    theirs_s.push_back(cpu_seconds() - between);
    ours_s.push_back(between - start);
  }
  for (std::size_t n = 0; n < poses.size(); ++n) {
    differ += !contest.agree(ours[n], theirs[n]);
    hits += settings.query == "distance" ? theirs[n] == 0 : settings.query == "sweep" ? theirs[n] <= 1 : theirs[n] > 0;
  }
  const auto count = static_cast<double>(poses.size());
  return {{"query", settings.query},
          {"a", settings.a},
          {"b", settings.b},
          {"triangles", {mesh_a.triangles.size(), mesh_b.triangles.size()}},
          {"poses", poses.size()},
          {"hits", hits},
          {"differ", differ},
          {"difi_per_s", count / median(ours_s)},
          {"fcl_per_s", count / median(theirs_s)},
          {"ratio", median(theirs_s) / median(ours_s)},
          {"difi_build_s", build},
          {"fcl_build_s", fcl_build}};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("collision queries beside FCL, in turns", "peer_fcl");
  Settings settings;
  app.add_option("--query", settings.query)->check(CLI::IsMember({"collide", "contacts", "distance", "sweep"}));
  app.add_option("--a", settings.a, "the scene that rests");
  app.add_option("--b", settings.b, "the scene that is placed");
  app.add_option("--triangles-a", settings.triangles_a);
  app.add_option("--triangles-b", settings.triangles_b);
  app.add_option("--poses", settings.poses);
  app.add_option("--hits", settings.hits, "the share of poses that collide");
  app.add_option("--way", settings.way, "length of a sweep, world units");
  app.add_option("--tolerance", settings.tolerance, "of a sweep");
  app.add_option("--height", settings.height, "one pose: b so far above its own place");
  CLI11_PARSE(app, argc, argv);
  try {
    std::cout << run(settings).dump() << std::endl;
  } catch (const std::exception& error) {
    std::cerr << "peer_fcl: " << error.what() << "\n";
    return 1;
  }
}
