// Two bodies, where the second one is, and what is asked: shared by the drivers that measure collision queries.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "difi/collision.h"
#include "question.h"

namespace difi::bench {

struct CollisionSettings {
  std::string a = "labyrinth", b = "fly";
  std::int64_t triangles_a = 0, triangles_b = 0;
  std::size_t poses = 10'000;
  double hits = 0.45;             ///< the share of poses that collide
  double way = 0.5;               ///< of a sweep
  std::vector<double> direction;  ///< of all sweeps; random where empty
  double tolerance = 1e-4;        ///< of a sweep
};
void add_options(CLI::App& app, CollisionSettings& settings);

/// At most so many contacts are asked for, unless all are.
inline constexpr std::int64_t kContacts = 100, kAllContacts = 1'000'000'000;

/// Poses of b drawn evenly from a's box, turned at random, until so many collide and so many do not; or b's one place.
std::vector<Pose> make_poses(const CollisionSettings& settings, const Question& question, const CollisionModel& a,
                             const CollisionModel& b);
/// A straight way from each pose.
std::vector<Motion> make_motions(const CollisionSettings& settings, const std::vector<Pose>& poses);

}  // namespace difi::bench
