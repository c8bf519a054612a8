// SPDX-License-Identifier: Apache-2.0
// Exact answers at arbitrary points: distance, closest point, inside or outside, winding number (docs/points.md).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "standoff/execution.h"
#include "standoff/existing.h"
#include "standoff/export.h"
#include "standoff/feature.h"
#include "standoff/mesh.h"
#include "standoff/progress.h"
#include "standoff/sign.h"
#include "standoff/vec.h"

namespace standoff {

/// The point of a mesh's surface that is nearest to a query point.
struct ClosestPoint {
  /// From the query point to `point`, world units; negative inside if the query has a sign.
  double distance = std::numeric_limits<double>::infinity();
  Vec3 point;                            ///< on the surface
  std::uint32_t triangle = kNoTriangle;  ///< the triangle that contains `point`; the lowest index on ties
  Feature feature = Feature::face;       ///< what part of the triangle `point` lies on
  /// Barycentric coordinates of `point`, in the order of the triangle's corners; each from 0 to 1, with sum 1 up to
  /// rounding.
  std::array<double, 3> barycentric = {};
};

struct MeshQueryOptions {
  /// How inside is decided. SignMethod::flood needs a grid and is an error; where `automatic` would take it there is no
  /// sign. `outer` and `shell` are as in compute().
  SignOptions sign = {};
  Execution execution = {};  ///< where the query is built
  ProgressCallback progress = {};
};

/// How points are answered.
struct PointOptions {
  Execution execution = {};
  ProgressCallback progress = {};
};

/// A mesh, prepared for questions at arbitrary points. Building takes about as long as reading the mesh; each answer is
/// then found in logarithmic time, and many points that are asked together share most of it. Answers are exact: the
/// nearest triangle is the one that a comparison with every triangle in double precision finds, of equally near ones
/// that of lowest index, and the error of the distance is a few 1e-16 of the extent of point and triangle together; of
/// slivers it may be 1e-8 of their length. They have the same bits for any number of threads, any instruction set, any
/// backend, and any order or batch of points. Calls of const members may run at the same time. Copies share the
/// prepared mesh and are cheap; a moved-from query stays usable.
class STANDOFF_API MeshQuery {
 public:
  /// Copies the mesh. Errors: input (mesh; a sign method that does not fit it), doubt (`strict`), usage (options),
  /// limit (a coordinate beyond kMaxCoordinate; memory), interrupted.
  explicit MeshQuery(MeshView mesh, const MeshQueryOptions& options = {});
  // There are no moves, because they would leave an empty query behind.
  MeshQuery(const MeshQuery&) = default;
  MeshQuery& operator=(const MeshQuery&) = default;
  ~MeshQuery() = default;

  MeshView mesh() const;
  /// How inside is decided; its method is `none` if distances have no sign.
  const SignReport& sign() const;
  /// What this takes, bytes.
  std::int64_t memory_bytes() const;

  /// out[n] is the distance of points[n], world units, negative inside if there is a sign. Errors: usage (a point that
  /// is not finite; lengths that differ; execution), limit (a coordinate beyond kMaxCoordinate; memory), interrupted;
  /// `out` is then unspecified.
  void distances(std::span<const Vec3> points, std::span<double> out, const PointOptions& options = {}) const;
  /// The same with the closest point, its triangle, feature and barycentric coordinates.
  void closest(std::span<const Vec3> points, std::span<ClosestPoint> out, const PointOptions& options = {}) const;
  /// The generalised winding number of the mesh, in the orientation that the sign was decided with, at each point: an
  /// integer if the mesh is closed. On the surface it is that of one of the sides. Errors: as above.
  void winding_numbers(std::span<const Vec3> points, std::span<double> out, const PointOptions& options = {}) const;
  /// The unit gradient of the distance at a point whose answer is `at`: away from the surface, or, if there is a sign,
  /// towards the outside. Where several triangles are nearest it is that of at.triangle; on the surface, within
  /// rounding, it is the normal of that triangle, in the orientation of the sign. Errors: usage (a triangle that the
  /// mesh does not have).
  Vec3 gradient(Vec3 point, const ClosestPoint& at) const;

  /// Writes the query as a file, by convention with the extension `.query`; it appears whole or not at all. Errors:
  /// output.
  void save(const std::filesystem::path& path, Existing existing = Existing::replace) const;
  /// Reads a query that save() wrote. Errors: input (`FILE:WHERE: what; what to do`), limit (memory).
  static MeshQuery load(const std::filesystem::path& path);

  struct Data;

 private:
  friend struct QueryAccess;
  explicit MeshQuery(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
  std::shared_ptr<const Data> data_;
};

/// The closest point for each of `points`, in this order, without a sign: a MeshQuery for a single call. Errors: as
/// MeshQuery and closest().
STANDOFF_API std::vector<ClosestPoint> closest_points(MeshView mesh, std::span<const Vec3> points,
                                                      const PointOptions& options = {});

}  // namespace standoff
