// SPDX-License-Identifier: Apache-2.0
// Two bodies, where the second one is, and what is asked: shared by the drivers that measure collision queries.
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

/// A scene made by code, or a mesh file where the name has a slash.
struct BodySource {
  std::string name;
  std::int64_t triangles = 0;  ///< of a scene; a file's edges are halved until there are so many. 0: as they are
  double size = 0;             ///< scaled until the longest side of its box is this, about its middle. 0: as it is
};
/// Errors: usage and input, as the library's.
Mesh make_body(const BodySource& source);

struct CollisionSettings {
  BodySource a{"labyrinth"}, b{"fly"};
  std::size_t poses = 10'000;
  double hits = 0.45;             ///< the share of poses that collide
  double way = 0.5;               ///< of a sweep
  std::vector<double> direction;  ///< of all sweeps; random where empty
  double tolerance = 1e-4;        ///< of a sweep
};
void add_options(CLI::App& app, CollisionSettings& settings);

/// At most so many contacts are asked for, unless all are.
inline constexpr std::int64_t kContacts = 100, kAllContacts = 1'000'000'000;

/// Poses of b where a question says (question.h); drawn, but always the same ones. Keeps references.
class PosesDrawn {
 public:
  PosesDrawn(const CollisionSettings& settings, const CollisionModel& a, const CollisionModel& b)
      : settings_(settings), a_(a), b_(b) {}
  /// Errors: runtime_error where there seems to be no such pose.
  std::vector<Pose> of(const Question& question);

 private:
  const CollisionSettings& settings_;
  const CollisionModel &a_, &b_;
  /// The last ones drawn for a placing: to bring a pose to a gap takes longer than to ask about it.
  std::map<std::string, std::vector<Pose>> known_;
};
/// A straight way from each pose.
std::vector<RigidMotion> make_motions(const CollisionSettings& settings, const Question& question,
                                      const std::vector<Pose>& poses);

}  // namespace standoff::bench
