// Do two rigid bodies touch, how near are they, where do they touch, and when will they? (docs/collision.md)
//
// A body is its surface: any triangles, open or closed. Bodies inside one another without touching surfaces are free.
// Answers are exact for the triangles as they stand in the world: each corner `apply(pose, corner)`, rounded to double.
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
  double spacing = 0;   ///< of the model's field, world units; 0: chosen from the mesh
  Execution execution;  ///< of the building: its fields may come from a GPU
};

/// What queries need of a body, built once: a sparse distance field near the surface, a coarse one around it, and a
/// bounding volume hierarchy (BVH) of the triangles. Copies share the data and are cheap; a model that was moved from
/// stays usable. Safe to use from many threads.
class CollisionModel {
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
  exact,      ///< free or hit, decided by triangles where the field cannot
  certified,  ///< from the field alone: free, hit (only where the margin is positive) or ambiguous
};

enum class Verdict { free, hit, ambiguous };

struct CollideOptions {
  double margin = 0;  ///< nearer than this, or as near, is a hit; world units, finite, not negative
  CollideMode mode = CollideMode::exact;
};

struct CollisionResult {
  Verdict verdict = Verdict::free;
  /// A pair of triangles that touch, or are within the margin; kNoTriangle unless an exact hit.
  std::uint32_t triangle_a = kNoTriangle;
  std::uint32_t triangle_b = kNoTriangle;

  bool hit() const { return verdict == Verdict::hit; }
};

/// Do the bodies touch? Errors of all queries: usage, for poses that are not rigid or not finite, and for options.
CollisionResult collide(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b, const Pose& pose_b,
                        const CollideOptions& options = {});

struct DistanceOptions {
  double tolerance = 0;  ///< upper - lower may be this much more than rounding; world units
  double limit = std::numeric_limits<double>::infinity();  ///< nothing farther than this is looked for
};

struct DistanceResult {
  double lower = 0;  ///< the distance is at least this; 0 where the bodies touch
  double upper = 0;  ///< and at most this: that of the two points. Infinite where nothing lies within the limit
  Vec3 point_a;      ///< on a's surface, in the world
  Vec3 point_b;      ///< on b's
  std::uint32_t triangle_a = kNoTriangle;
  std::uint32_t triangle_b = kNoTriangle;
};

/// The least distance between the surfaces. `lower` is within `tolerance` and 1e-6 * (size of the bodies) of `upper`;
/// where the tolerance is 0, `upper` itself is the least distance of all pairs of triangles, within 32 * 2^-53 of the
/// longest side of the box around the pair.
DistanceResult distance(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b, const Pose& pose_b,
                        const DistanceOptions& options = {});

struct ContactOptions {
  std::int64_t most = 100;  ///< contacts to report, at least 1
  double margin = 0;        ///< pairs within this distance are contacts too
};

/// Two triangles that touch, whatever their shape. Point and depth err by 1e-9 of their extent at the most.
struct ContactPoint {
  Vec3 point;   ///< in the world: the middle of the segment both share, or of the shortest segment between them
  Vec3 normal;  ///< unit length, the way b has to go
  /// How far b has to move along `normal` until this pair is apart; minus their distance where the pair is apart.
  double depth = 0;
  std::uint32_t triangle_a = 0;
  std::uint32_t triangle_b = 0;
};

struct ContactResult {
  std::vector<ContactPoint> contacts;
  /// There are more pairs than `contacts` holds; what it holds is then spread over the contact area.
  bool overflow = false;
};

ContactResult contacts(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b, const Pose& pose_b,
                       const ContactOptions& options = {});

/// A rigid motion during time 0 to 1: the rotation turns evenly about one axis through the body's point `center`, which
/// itself moves evenly on a straight line. At both ends the body is at the poses given. Poses do not tell how often a
/// body turns: it takes the shorter way round, half a turn at the most; ask for longer ones in parts.
struct RigidMotion {
  Pose from, to;
  Vec3 center;  ///< of the body; at most 1e15 from its origin
};

/// The pose at time t in [0, 1].
Pose pose_at(const RigidMotion& motion, double t);

struct SweepOptions {
  /// Surfaces within this distance count as touching; world units, not negative. 0: automatic_tolerance(a, b). At least
  /// 2^-48 of the coordinates of poses, meshes and motions: rounding alone moves bodies by that.
  double tolerance = 0;
};

/// The tolerance of a sweep that names none: 2^-15 (3e-5) of the longest side of the smaller body's box, but no less
/// than 2^-40 (1e-12) of the larger body's. Bodies of size 3 get 1e-4.
double automatic_tolerance(const CollisionModel& a, const CollisionModel& b);

struct SweepResult {
  bool hit = false;
  /// The bodies are apart during [0, time); where there is a hit they are within the tolerance at `time`. 1 where free.
  double time = 1;
  std::uint32_t triangle_a = kNoTriangle;
  std::uint32_t triangle_b = kNoTriangle;
  Vec3 point;   ///< where they meet, in the world
  Vec3 normal;  ///< unit length, from a to b; zero where the bodies touch at the start
};

/// When b, in motion, first comes within the tolerance of a, which rests. Never free where the bodies touch on the way,
/// at any speed; a hit may be told where they pass within the tolerance. Bodies that are within it at the start, but do
/// not touch, are free to part. Errors: usage, also for motions some 1e14 times as long as the bodies, on which
/// rounding hides where they are.
SweepResult sweep(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b, const RigidMotion& motion,
                  const SweepOptions& options = {});

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
std::vector<CollisionResult> collide_all(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                                         std::span<const Pose> poses_b, const CollideOptions& options = {},
                                         const Execution& execution = {}, BatchReport* report = nullptr);
/// The same for many poses, on the CPU: other backends are Error{usage}.
std::vector<DistanceResult> distance_all(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                                         std::span<const Pose> poses_b, const DistanceOptions& options = {},
                                         const Execution& execution = {});
/// The same for many poses, on the CPU: other backends are Error{usage}.
std::vector<ContactResult> contacts_all(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                                        std::span<const Pose> poses_b, const ContactOptions& options = {},
                                        const Execution& execution = {});
/// The same for many motions. A GPU finds those that are certainly free; the CPU sweeps the others. Errors: as sweep,
/// and usage (execution), device, limit.
std::vector<SweepResult> sweep_all(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                                   std::span<const RigidMotion> motions, const SweepOptions& options = {},
                                   const Execution& execution = {}, BatchReport* report = nullptr);

/// Algorithm 2 of the 2008 thesis, for comparison: samples of one field that lie in the other's grid are visited, and
/// where both fields have a value (below their thickness) at the sample and at the sample nearest to it, the bodies are
/// said to collide if the sum of both is below `threshold`. It may be wrong either way: docs/collision.md tells how
/// often.
struct ThesisCollisionResult {
  bool hit = false;
  std::int64_t samples = 0;  ///< visited
};
ThesisCollisionResult collide_thesis(const DistanceField& a, const Pose& pose_a, const DistanceField& b,
                                     const Pose& pose_b, double threshold);
/// The least such sum, with which the threshold can be chosen; infinite where no sample counts.
double thesis_sum(const DistanceField& a, const Pose& pose_a, const DistanceField& b, const Pose& pose_b);

}  // namespace standoff
