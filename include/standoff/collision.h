// SPDX-License-Identifier: Apache-2.0
// Exact collision, distance, contact and sweep queries between two rigid bodies (docs/collision.md).
//
// A body is its surface: any triangles, open or closed. A body inside another one is free unless the surfaces touch.
// Answers are about the corners in the world: `apply(pose, corner)`, rounded to double.
#pragma once

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

namespace standoff {

namespace collision {
struct ModelData;
struct ModelAccess;
}  // namespace collision

struct ModelOptions {
  double spacing = 0;        ///< of the model's field, world units; 0: chosen from the mesh
  Execution execution = {};  ///< of the building: its fields may come from a GPU
};

/// What queries need of a body, built once: a sparse distance field near the surface, a coarse one around it, and a
/// bounding volume hierarchy (BVH) of the triangles. Copies share the data and are cheap; a model that was moved from
/// stays usable. Safe to use from many threads.
class STANDOFF_API CollisionModel {
 public:
  /// Errors: input (mesh; larger than 1e12 or smaller than 1e-12, or past 1e15), usage (options), limit (a field of too
  /// many samples).
  explicit CollisionModel(MeshView mesh, const ModelOptions& options = {});
  // No moves: they would leave a model of nothing behind.
  CollisionModel(const CollisionModel&) = default;
  CollisionModel& operator=(const CollisionModel&) = default;
  ~CollisionModel() = default;

  /// The mesh the model was built from.
  MeshView mesh() const;
  Box bounds() const;
  /// The samples of its field, and how far from the surface that field reaches; world units.
  Grid grid() const;
  double band() const;
  /// The memory that the model's arrays take: mesh, fields and BVH, in bytes. Copies of the model share it; copies on
  /// GPUs are not counted.
  std::int64_t memory_bytes() const;

  /// Writes the model; the file appears whole or not at all. Errors: output.
  void save(const std::filesystem::path& path, Existing existing = Existing::replace) const;
  /// Reads a model that save() wrote. Errors: input, for anything else and for damaged files.
  static CollisionModel load(const std::filesystem::path& path);

 private:
  friend struct collision::ModelAccess;
  explicit CollisionModel(std::shared_ptr<const collision::ModelData> data) : data_(std::move(data)) {}
  std::shared_ptr<const collision::ModelData> data_;
};

enum class CollideMode {
  exact,      ///< free or hit; triangles decide where the field cannot
  certified,  ///< from the field alone: free, hit (only where the margin is positive) or ambiguous
};

enum class Verdict { free, hit, ambiguous };

struct CollideOptions {
  double margin = 0;  ///< bodies within this distance are a hit; world units, finite, not negative
  CollideMode mode = CollideMode::exact;
};

struct CollisionResult {
  Verdict verdict = Verdict::free;
  /// Two triangles that intersect or are within the margin; kNoTriangle unless the mode is exact and the verdict hit.
  std::uint32_t triangle_a = kNoTriangle;
  std::uint32_t triangle_b = kNoTriangle;

  bool hit() const { return verdict == Verdict::hit; }
};

/// Whether the bodies intersect (docs/collide.md). Errors of all queries: usage, for poses that are not rigid or not
/// finite, and for options.
STANDOFF_API CollisionResult collide(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                                     const Pose& pose_b, const CollideOptions& options = {});

struct DistanceOptions {
  double tolerance = 0;  ///< upper - lower may be this large, beside rounding; world units
  double limit = std::numeric_limits<double>::infinity();  ///< nothing farther than this is searched for
};

struct DistanceResult {
  double lower = 0;  ///< the distance is at least this; 0 where the bodies touch
  double upper = 0;  ///< and at most this: that of the two points; infinite where nothing lies within the limit
  Vec3 point_a;      ///< on a's surface, in the world
  Vec3 point_b;      ///< on b's
  std::uint32_t triangle_a = kNoTriangle;
  std::uint32_t triangle_b = kNoTriangle;
};

/// The least distance between the surfaces (docs/distance.md). `lower` is within `tolerance` and 1e-6 * (size of the
/// bodies) of `upper`; where the tolerance is 0, `upper` itself is the least distance of all pairs of triangles, within
/// 32 * 2^-53 of the longest side of the box around the pair.
STANDOFF_API DistanceResult distance(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                                     const Pose& pose_b, const DistanceOptions& options = {});

struct ContactOptions {
  std::int64_t most = 100;  ///< contacts to report, at least 1
  double margin = 0;        ///< pairs within this distance are contacts too
};

/// Two triangles that intersect, of any shape. Point and depth err by at most 1e-9 of their extent.
struct ContactPoint {
  Vec3 point;   ///< in the world: the middle of the segment both share, or of the shortest segment between them
  Vec3 normal;  ///< unit length, from a to b
  /// How far b has to move along `normal` until this pair is separated; minus their distance where it is.
  double depth = 0;
  std::uint32_t triangle_a = 0;
  std::uint32_t triangle_b = 0;
};

struct ContactResult {
  std::vector<ContactPoint> contacts;
  /// There are more pairs than `contacts` holds; what it holds is then spread over the contact area.
  bool overflow = false;
};

/// Where the surfaces intersect (docs/contacts.md).
STANDOFF_API ContactResult contacts(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                                    const Pose& pose_b, const ContactOptions& options = {});

/// A rigid motion during time 0 to 1, between two poses: the body's point `center` moves on a straight line with
/// constant velocity, and the body turns about an axis through it with constant angular velocity. The rotation between
/// the two poses is the shorter one (at most 180 degrees); split longer rotations.
struct RigidMotion {
  Pose from, to;
  Vec3 center;  ///< of the body; at most 1e15 from its origin
};

/// The pose at time t in [0, 1].
STANDOFF_API Pose pose_at(const RigidMotion& motion, double t);

struct SweepOptions {
  /// Surfaces within this distance count as touching; world units, not negative. 0: automatic_tolerance(a, b). At least
  /// 2^-48 of the coordinates of poses, meshes and motions: rounding moves bodies by that.
  double tolerance = 0;
};

/// The tolerance of a sweep that names none: 2^-15 (3e-5) of the longest side of the smaller body's box, but no less
/// than 2^-40 (1e-12) of the larger body's. Bodies of size 3 get 1e-4.
STANDOFF_API double automatic_tolerance(const CollisionModel& a, const CollisionModel& b);

struct SweepResult {
  bool hit = false;
  /// The time of impact: the bodies do not intersect during [0, time) and are within the tolerance at `time`. 1: free.
  double time = 1;
  std::uint32_t triangle_a = kNoTriangle;
  std::uint32_t triangle_b = kNoTriangle;
  Vec3 point;   ///< of contact, in the world
  Vec3 normal;  ///< unit length, from a to b; zero where the bodies touch at the start
};

/// When b, in motion, first touches a, which rests (docs/sweep.md): conservative advancement. Never free where the
/// bodies touch on the motion, at any speed; a hit may be reported where they pass within the tolerance. If they start
/// closer than the tolerance without touching, separating motion is not a hit. Errors: usage, also for motions some
/// 1e14 times as long as the bodies, where rounding hides the path.
STANDOFF_API SweepResult sweep(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                               const RigidMotion& motion, const SweepOptions& options = {});

/// What a batch did.
struct BatchReport {
  std::string backend;         ///< "cpu", "cuda" or "emulated"
  std::string device;          ///< the GPU's name
  std::int64_t on_device = 0;  ///< queries that the device decided; the CPU decided the others
  /// Of these, those that the device could not decide: rounding hid the answer, or a sweep is not certainly free.
  std::int64_t undecided = 0;
  std::int64_t overflowed = 0;  ///< and those for which its lists were too short
};

/// The same for many poses of b. The same verdicts in the same order, wherever they are computed. A GPU keeps what it
/// needs of the bodies for as long as they live; of several pairs of triangles that touch it may report another one.
/// Certified answers come from the CPU alone. Errors: as collide, and usage (execution, certified answers from a GPU),
/// device (none there, or it failed), limit (too little memory on it).
STANDOFF_API std::vector<CollisionResult> collide_all(const CollisionModel& a, const Pose& pose_a,
                                                      const CollisionModel& b, std::span<const Pose> poses_b,
                                                      const CollideOptions& options = {},
                                                      const Execution& execution = {}, BatchReport* report = nullptr);
/// The same for many poses, on the CPU: other backends are Error{usage}.
STANDOFF_API std::vector<DistanceResult> distance_all(const CollisionModel& a, const Pose& pose_a,
                                                      const CollisionModel& b, std::span<const Pose> poses_b,
                                                      const DistanceOptions& options = {},
                                                      const Execution& execution = {});
/// The same for many poses, on the CPU: other backends are Error{usage}.
STANDOFF_API std::vector<ContactResult> contacts_all(const CollisionModel& a, const Pose& pose_a,
                                                     const CollisionModel& b, std::span<const Pose> poses_b,
                                                     const ContactOptions& options = {},
                                                     const Execution& execution = {});
/// The same for many motions. A GPU finds those that are certainly free; the CPU sweeps the others. Errors: as sweep,
/// and usage (execution), device, limit.
STANDOFF_API std::vector<SweepResult> sweep_all(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                                                std::span<const RigidMotion> motions, const SweepOptions& options = {},
                                                const Execution& execution = {}, BatchReport* report = nullptr);

}  // namespace standoff
