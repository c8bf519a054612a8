// SPDX-License-Identifier: Apache-2.0
// Exact collision, distance, contact and sweep queries between two rigid bodies (docs/collision.md).
//
// A body is its surface: any triangles, open or closed. A body inside another one counts as free unless the surfaces
// touch, or CollideOptions::containment asks for it. Answers refer to the corners in world coordinates:
// `apply(pose, corner)`, rounded to double.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "standoff/error.h"
#include "standoff/execution.h"
#include "standoff/existing.h"
#include "standoff/export.h"
#include "standoff/field.h"
#include "standoff/grid.h"
#include "standoff/mesh.h"
#include "standoff/pose.h"
#include "standoff/progress.h"

namespace standoff {

namespace collision {
struct BodyData;
struct BodyAccess;
}  // namespace collision

/// The sizes that a body's mesh may have: the longest side of its box, world units. Single precision carries such
/// lengths and their squares. A mesh that is a single point has size 0, and is valid too.
inline constexpr double kMinBodySize = 1e-12, kMaxBodySize = 1e12;
/// The largest margin and sweep tolerance, world units.
inline constexpr double kMaxMargin = 1e30;

struct BodyOptions {
  double spacing = 0;        ///< spacing of the body's fine field, world units; 0: chosen from the mesh
  Execution execution = {};  ///< where the body is built; its fields may be computed on a GPU
  ProgressCallback progress = {};
};

/// A body prepared for queries: its mesh, a sparse distance field near the surface, a coarse one around it (signed if
/// the mesh is closed), and a bounding volume hierarchy (BVH) of the triangles. Copies share the data and are cheap. A
/// moved-from body stays usable. Many threads may use a body at the same time.
class STANDOFF_API Body {
 public:
  /// Copies the mesh, and builds the fields and the BVH. Errors: input (an invalid mesh, a size outside kMinBodySize
  /// to kMaxBodySize, or a box whose centre has a coordinate beyond kMaxPosition), usage (options), limit (memory, or
  /// a field of too many samples), interrupted.
  explicit Body(MeshView mesh, const BodyOptions& options = {});
  // There are no moves, because they would leave an empty body behind.
  Body(const Body&) = default;
  Body& operator=(const Body&) = default;
  ~Body() = default;

  /// The mesh the body was built from.
  MeshView mesh() const;
  Box bounds() const;
  /// The grid of the fine field, and its thickness; world units.
  Grid grid() const;
  double thickness() const;
  /// Whether the body has an inside that is known: its mesh is closed as it is oriented, each edge used as often in one
  /// direction as in the other. The inside is then where the winding number is positive, as by SignMethod::winding with
  /// SignOptions::as_oriented, and the fields have a sign. A mesh that is turned inside out has nothing inside. Unlike
  /// MeshReport::closed() nothing is repaired before.
  bool has_inside() const;
  /// Bytes of the body's arrays: mesh, fields and BVH. Copies of the body share them. Copies on GPUs are not counted.
  std::int64_t memory_bytes() const;

  /// Writes the body; the file appears whole or not at all. Errors: output.
  void save(const std::filesystem::path& path, Existing existing = Existing::replace) const;
  /// Reads a body that save() wrote. Errors: input (a damaged file, or one of another kind), limit.
  static Body load(const std::filesystem::path& path);

 private:
  friend struct collision::BodyAccess;
  explicit Body(std::shared_ptr<const collision::BodyData> data) : data_(std::move(data)) {}
  std::shared_ptr<const collision::BodyData> data_;
};

enum class CollideMode {
  exact,      ///< free or hit; triangles are tested where the fields cannot decide
  certified,  ///< from the fields alone: free, hit (only with a positive margin) or ambiguous
};

enum class Verdict { free, hit, ambiguous };

struct CollideOptions {
  double margin = 0;  ///< bodies within this distance are a hit; world units, 0 to kMaxMargin
  CollideMode mode = CollideMode::exact;
  /// Whether a body inside the other one is a hit too. At least one of the bodies must have an inside (has_inside());
  /// nothing is ever inside one that has none. Only for CollideMode::exact.
  bool containment = false;
};

/// What lies inside what, where the surfaces neither intersect nor come within the margin.
enum class Containment {
  none,
  b_in_a,  ///< all of b's surface is inside a
  a_in_b,
  partly,  ///< some connected components of a surface are inside the other body, but no surface as a whole
};

struct CollisionResult {
  Verdict verdict = Verdict::free;
  /// Two triangles that intersect or are within the margin; kNoTriangle if there are none, and in certified mode.
  std::uint32_t triangle_a = kNoTriangle;
  std::uint32_t triangle_b = kNoTriangle;
  /// Without CollideOptions::containment always `none`; any other value makes the verdict a hit.
  Containment containment = Containment::none;

  bool hit() const { return verdict == Verdict::hit; }
};

/// Whether the bodies intersect (docs/collide.md). Errors of all queries: usage, for poses that are not rigid or not
/// finite, and for options. With `containment`, input if neither body has an inside.
STANDOFF_API CollisionResult collide(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b,
                                     const CollideOptions& options = {});

struct DistanceOptions {
  double tolerance = 0;  ///< the largest allowed upper - lower, apart from rounding; world units, not negative
  double limit = std::numeric_limits<double>::infinity();  ///< the search stops at this distance; world units
  /// About the most steps that a query takes, pairs of BVH nodes or of triangles; 0: no limit. A query that needs more
  /// is not finished, and returns what it has proven.
  std::int64_t max_steps = 0;
};

struct DistanceResult {
  double lower = 0;  ///< the distance is at least this; 0 if the bodies intersect
  double upper = 0;  ///< the distance of the two points; infinite if the bodies are farther apart than the limit
  Vec3 point_a;      ///< on a's surface, in the world
  Vec3 point_b;      ///< on b's surface
  std::uint32_t triangle_a = kNoTriangle;
  std::uint32_t triangle_b = kNoTriangle;
  /// False if the query ended after DistanceOptions::max_steps. The distance still lies between `lower` and `upper`,
  /// but they may be farther apart than the tolerance.
  bool finished = true;
};

/// The least distance between the surfaces (docs/distance.md). If the query is finished, upper - lower <= tolerance +
/// 1e-6 * (size of the bodies). With tolerance 0, `upper` is then the least distance over all pairs of triangles,
/// within 32 * 2^-53 of the longest side of the box around the pair. Errors: as collide.
STANDOFF_API DistanceResult distance(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b,
                                     const DistanceOptions& options = {});

/// Where a distance query of poses that follow each other begins: with the triangles that were nearest before. Pass the
/// same state to each query of two bodies. Any state is valid, whatever bodies and poses it is from, and none changes
/// an answer, not by one bit: a near pair only saves time. It is not read with a tolerance or with max_steps. The
/// numbers have no meaning for others.
struct DistanceState {
  std::uint32_t of_target = kNoTriangle;
  std::uint32_t of_probe = kNoTriangle;
  double distance = 0;
};

/// distance(), which begins with what `state` knows and leaves there what the next query may begin with.
STANDOFF_API DistanceResult distance(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b,
                                     const DistanceOptions& options, DistanceState& state);

struct ContactOptions {
  std::int64_t most = 100;  ///< the largest number of contacts to report; at least 1
  double margin = 0;        ///< pairs within this distance are contacts too; world units, 0 to kMaxMargin
};

/// A contact: two triangles that intersect or are within the margin. Point and depth err by at most 1e-9 of the
/// triangles' extent, for every shape of triangle.
struct ContactPoint {
  Vec3 point;   ///< in the world: the middle of the segment that both share, or of the shortest one between them
  Vec3 normal;  ///< unit length, from a to b
  /// How far b must move along `normal` to separate this pair. If the triangles do not intersect, minus their distance.
  /// World units.
  double depth = 0;
  std::uint32_t triangle_a = 0;
  std::uint32_t triangle_b = 0;
};

struct ContactResult {
  std::vector<ContactPoint> contacts;
  /// True if there are more pairs than the list has. The listed ones are then spread over the contact area.
  bool overflow = false;
};

/// The pairs of triangles that intersect or are within the margin (docs/contacts.md). Errors: as collide; limit.
STANDOFF_API ContactResult contacts(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b,
                                    const ContactOptions& options = {});

/// The largest angle that a motion may turn by, radians: some 1.6 million turns.
inline constexpr double kMaxTurnRad = 1e7;
/// How far an entry of the last pose's matrix may be from that of the first pose turned by a motion's axis and angle.
inline constexpr double kTurnTolerance = 1e-5;

/// A rigid motion during time 0 to 1, between two poses: the body's point `center` moves on a straight line with
/// constant velocity, and the body turns about an axis through it with constant angular velocity. Without an axis the
/// rotation between the two poses is the shorter one (at most 180 degrees). With an axis the body turns by the given
/// angle, through any number of turns: two poses alone do not say how many. screw_motion() makes such a motion.
struct RigidMotion {
  Pose start, end;
  Vec3 center;     ///< a point of the body, in body coordinates; no coordinate is beyond kMaxPosition
  Vec3 axis = {};  ///< in the world, of any length; zero: the shorter rotation
  /// The rotation from `start` to `end` about `axis`, right-handed, -kMaxTurnRad to kMaxTurnRad; 0 if there is no axis.
  /// The rotation of `end` is that of `start` turned so, within kTurnTolerance.
  double angle_rad = 0;
};

/// A motion that begins at `start`: the body turns by `angle_rad` about the axis through `point` of the world, any
/// number of turns, and moves by `along` in the direction of the axis. The rotation is right-handed; world units and
/// radians. Errors: usage (a pose that is not rigid, a zero axis, an angle beyond kMaxTurnRad, numbers that are not
/// finite, or an end or a center beyond kMaxPosition).
STANDOFF_API RigidMotion screw_motion(const Pose& start, Vec3 point, Vec3 axis, double angle_rad, double along = 0);

/// The pose at time t in [0, 1]. Errors: usage (a motion or a time that is not valid).
STANDOFF_API Pose pose_at(const RigidMotion& motion, double t);

struct SweepOptions {
  /// Surfaces within this distance count as touching; world units, 0 to kMaxMargin. 0: automatic_tolerance(a, b). A
  /// tolerance below 2^-48 of the coordinates of poses, meshes and motions counts as 2^-48 of them, because rounding
  /// may move bodies that far; where a body turns far, 4e-16 of the arc that it describes counts as well.
  double tolerance = 0;
  /// About the most steps that a sweep takes on the CPU, pairs of BVH nodes or of triangles; 0: no limit. A step takes
  /// about a microsecond. A sweep that needs more is not finished.
  std::int64_t max_steps = 0;
};

/// The default tolerance of a sweep: 2^-15 (3e-5) of the longest side of the smaller body's box, but at least 2^-40
/// (1e-12) of the larger body's. For bodies of size 3 this is 1e-4. World units.
STANDOFF_API double automatic_tolerance(const Body& a, const Body& b);

struct SweepResult {
  bool hit = false;
  /// The time of impact: the bodies do not intersect during [0, time) and are within the tolerance at `time`. 1 if
  /// there is no hit and the sweep is finished.
  double time = 1;
  std::uint32_t triangle_a = kNoTriangle;
  std::uint32_t triangle_b = kNoTriangle;
  Vec3 point;   ///< where they touch at `time`, in the world
  Vec3 normal;  ///< unit length, from a to b; zero if the bodies intersect at the start
  /// False if the sweep ended after SweepOptions::max_steps: there is no hit, and the bodies do not intersect during
  /// [0, time); what comes after is not known.
  bool finished = true;
};

/// When the moving body b first touches the resting body a, by conservative advancement (docs/sweep.md). If the bodies
/// touch during the motion, the result is a hit, at any speed. If they pass within the tolerance without touching, it
/// may be a hit. If they start within the tolerance and all of their triangles only move apart, it is not a hit.
/// Errors: as collide; usage also for motions that pose_at() does not take, and for motions some 1e14 times as long as
/// the bodies, for which rounding of the time is too large.
STANDOFF_API SweepResult sweep(const Body& a, const Pose& pose_a, const Body& b, const RigidMotion& motion,
                               const SweepOptions& options = {});

struct PathSweepResult {
  std::int64_t motion = 0;  ///< the motion in which the sweep ended, from 0; the last one if the path is free
  SweepResult sweep;        ///< of that motion; b intersects a in no motion before it
};

/// sweep() along motions, one after the other. A motion begins where the one before ends: no point of b may jump there
/// by more than a quarter of the tolerance. `max_steps` counts the steps of all motions together. A path of one motion
/// has the answer of sweep(). Errors: as sweep; usage also for a path without motions, and for the first motion that
/// does not begin where the one before ends.
STANDOFF_API PathSweepResult sweep_path(const Body& a, const Pose& pose_a, const Body& b,
                                        std::span<const RigidMotion> path, const SweepOptions& options = {});

/// A motion along a curve during time 0 to 1: the body's point `center` follows a cubic Bezier curve, and the body
/// turns about an axis through it with constant angular velocity.
struct SplineMotion {
  Pose start = {};
  Vec3 center = {};                  ///< a point of the body, in body coordinates
  std::array<Vec3, 3> control = {};  ///< the curve's other control points, in the world; `start` places the first
  Vec3 axis = {};                    ///< in the world, of any length; zero: the body does not turn
  double angle_rad = 0;              ///< right-handed about the axis; -kMaxTurnRad to kMaxTurnRad
};

/// The pose at time t in [0, 1]. Errors: usage (a start that is not rigid, an angle without an axis or beyond
/// kMaxTurnRad, coordinates that are not finite or beyond kMaxPosition, a time outside [0, 1]).
STANDOFF_API Pose spline_pose_at(const SplineMotion& motion, double t);

/// sweep() along a curve. The curve is swept in pieces, as chords, with a bound of its distance from them: no contact
/// is missed. If the bodies start within the tolerance, it is a hit at time 0. `max_steps` counts the steps of all
/// sweeps of pieces, but not the distance that each begins with. Tolerances below 2^-45 of the coordinates count as
/// that. Errors: as sweep and spline_pose_at.
STANDOFF_API SweepResult sweep_spline(const Body& a, const Pose& pose_a, const Body& b, const SplineMotion& motion,
                                      const SweepOptions& options = {});

/// How the queries of a batch were decided.
struct BatchReport {
  std::string backend;  ///< "cpu", "cuda" or "emulated"
  std::string device;   ///< the GPU's name
  /// Queries that the device decided; the CPU decided the others. Containment is always decided by the CPU, and is not
  /// counted here.
  std::int64_t on_device = 0;
  /// Queries left to the CPU because the device could not decide them: rounding hid the answer, or a sweep is not
  /// certainly free.
  std::int64_t undecided = 0;
  std::int64_t overflowed = 0;  ///< queries left to the CPU because the device's lists were too short
};

/// The results of a batch, in the order of the poses or motions.
template <class Result>
struct BatchResult {
  std::vector<Result> results;
  BatchReport report;
};

/// collide() for many poses of b. Verdicts do not depend on the backend; if
/// several pairs of triangles intersect, a GPU may report another one. Copies of the bodies stay on the GPU until the
/// bodies are destroyed. Certified queries run on the CPU only. Errors: as collide; usage also for `execution` and for
/// certified queries on a GPU; device (there is no GPU, or it failed); limit (the GPU has too little memory).
STANDOFF_API BatchResult<CollisionResult> collide_all(const Body& a, const Pose& pose_a, const Body& b,
                                                      std::span<const Pose> poses_b, const CollideOptions& options = {},
                                                      const Execution& execution = {});
/// distance() for many poses of b. The answers do not depend on the backend, not by one bit: a GPU finds the nearest
/// pairs of triangles, and the CPU takes the poses that may intersect, and those where many pairs are about equally
/// near or a plane separates the bodies (docs/distance.md). With a tolerance or max_steps it runs on the CPU, and any
/// other backend is Error{usage}. Errors: as distance; usage also for `execution`; device, limit.
STANDOFF_API BatchResult<DistanceResult> distance_all(const Body& a, const Pose& pose_a, const Body& b,
                                                      std::span<const Pose> poses_b,
                                                      const DistanceOptions& options = {},
                                                      const Execution& execution = {});
/// contacts() for many poses of b. Runs on the CPU; any other backend is Error{usage}.
STANDOFF_API BatchResult<ContactResult> contacts_all(const Body& a, const Pose& pose_a, const Body& b,
                                                     std::span<const Pose> poses_b, const ContactOptions& options = {},
                                                     const Execution& execution = {});
/// sweep() for many motions. A GPU finds motions that are certainly free; the CPU sweeps the others, so results do not
/// depend on the backend, but for sweeps that max_steps ends on the CPU. Errors: as sweep; usage also for `execution`;
/// device, limit.
STANDOFF_API BatchResult<SweepResult> sweep_all(const Body& a, const Pose& pose_a, const Body& b,
                                                std::span<const RigidMotion> motions, const SweepOptions& options = {},
                                                const Execution& execution = {});

}  // namespace standoff
