// SPDX-License-Identifier: Apache-2.0
// Two bodies, the poses of the second one, and the queries: shared by the drivers that measure collision queries.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "question.h"
#include "standoff/collision.h"

namespace CLI {
class App;
}

namespace standoff::bench {

/// A scene or a body of conforming.h, both made by code, or a mesh file if the name has a slash.
struct BodySource {
  std::string name;
  std::int64_t triangles = 0;  ///< of a scene; a file's edges are halved until it has this many. 0: unchanged
  double size = 0;             ///< scales the body about its middle to this longest side of its box. 0: unchanged
};
/// Throws the library's errors: usage and input.
Mesh make_body(const BodySource& source);

struct CollisionSettings {
  BodySource a{"labyrinth"}, b{"fly"};
  std::size_t poses = 10'000;
  double hits = 0.45;             ///< the share of poses that collide
  double way = 0.5;               ///< the length of a sweep
  std::vector<double> direction;  ///< the direction of all sweeps; random if empty
  double tolerance = 1e-4;        ///< the tolerance of a sweep
};
void add_options(CLI::App& app, CollisionSettings& settings);

/// The most contacts of a query, unless it asks for all.
inline constexpr std::int64_t kContacts = 100, kAllContacts = 1'000'000'000;

/// Random poses of b as a question places it (question.h), the same in every run. Keeps references.
class PosesDrawn {
 public:
  PosesDrawn(const CollisionSettings& settings, const Body& a, const Body& b) : settings_(settings), a_(a), b_(b) {}
  /// Throws runtime_error if there seems to be no such pose.
  std::vector<Pose> of(const Question& question);

 private:
  const CollisionSettings& settings_;
  const Body &a_, &b_;
  /// The last poses of each placing: moving a pose to a gap takes longer than a query.
  std::map<std::string, std::vector<Pose>> known_;
};
/// A motion from each pose: straight, and turning about b's y axis if the question says so.
std::vector<RigidMotion> make_motions(const CollisionSettings& settings, const Question& question,
                                      const std::vector<Pose>& poses);

}  // namespace standoff::bench
