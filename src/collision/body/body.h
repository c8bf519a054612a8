// SPDX-License-Identifier: Apache-2.0
// The data of a Body: a mesh, bounds of the distance to it, a BVH over its triangles and its connected
// components; and the functions that make them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "bvh/bvh.h"
#include "collision/body/kernel_data.h"
#include "core/memory.h"
#include "core/progress.h"
#include "geometry/triangle_pair.h"
#include "gpu/devices.h"
#include "standoff/collision.h"
#include "standoff/execution.h"
#include "standoff/field.h"
#include "standoff/mesh.h"

namespace standoff {

class FileView;
enum class ArrayChecksum;

namespace collision {

/// The half-width of the fine field's band, and the coarse field's spacing, in fine spacings. The band must reach past
/// the coarse field's error, sqrt(3)/2 * 4 spacings, so that the coarse bound is used only where it is better.
inline constexpr int kBandSamples = 4;
inline constexpr int kCoarseStep = 4;

/// Lower bounds of the distance to a surface, everywhere: a fine sparse field near it, and a coarse field around it. If
/// the surface is closed, also the signs of the samples, which are stored separately because distance bounds need none.
/// Samples are stored in 255 steps of the band's half-width, rounded down: so they stay lower bounds. Positions are
/// relative to the body's middle.
struct FieldBounds {
  double spacing = 1;
  Size3 size, coarse_size;
  Vec3 origin;
  Box box;                             ///< around the surface
  HugePageVector<std::int32_t> slots;  ///< by tile; tile 0 of the samples is all clamped
  HugePageVector<std::uint8_t> samples;
  HugePageVector<float> coarse;  ///< distances, rounded down, not clamped
  /// One bit per sample, set if its winding number is positive. In the order of `samples` and of `coarse`, the lowest
  /// bit of a byte first. Empty if the surface is not closed; the bits of tile 0 mean nothing.
  HugePageVector<std::uint8_t> inside, coarse_inside;

  bool has_sign() const { return !inside.empty(); }
  double thickness() const { return kBandSamples * spacing; }
  FieldView view() const;
};

/// The BVH over the triangles of a body, with spheres and triangles beside its boxes. Coordinates are relative to the
/// middle.
struct BodyBvh {
  Bvh tree;
  std::vector<HugePageVector<Sphere16>> spheres;  ///< by level, by node: the spheres around its children
  /// By level, from 1 on: oriented boxes around the children of each node; the last level holds only the root's.
  std::vector<HugePageVector<Obb16>> oriented;
  HugePageVector<Triangle16> triangles;  ///< by node of the lowest level; lanes left over repeat the last triangle

  const std::vector<std::uint32_t>& order() const { return tree.order(); }
  const Boxes16* boxes(int level) const { return tree.level(level).data(); }
  int top() const { return tree.top_level(); }
  /// How many children a node has: triangles if it is a leaf, which are of level 0.
  int children_of(int level, std::uint32_t number) const {
    const std::size_t below = level == 0 ? tree.triangles() : tree.level(level - 1).size();
    return static_cast<int>(std::min<std::size_t>(kLanes, below - std::size_t{number} * kLanes));
  }
  /// The oriented box of node `number` of a level.
  Obb box_of(int level, std::uint32_t number) const {
    return oriented[static_cast<std::size_t>(level) + 1][number / kLanes].lane(static_cast<int>(number % kLanes));
  }
};

struct BodyData {
  Mesh mesh;
  Box box;            ///< around the corners
  Vec3 middle;        ///< the origin of BVH and fields
  double radius = 0;  ///< of a sphere about the middle that holds all corners
  FieldBounds field;
  FieldView view{};  ///< a view of `field`
  BodyBvh bvh;
  HugePageVector<Corners> corners;        ///< the triangles in the order of the BVH
  std::vector<std::uint32_t> components;  ///< the first triangle of each connected component
  gpu::DeviceCopies device_bodies;        ///< copies in the memory of GPUs

  /// The first step of building and of loading: checks the mesh, and sets box and middle. A spacing of 0 means that it
  /// is chosen later. Throws Error{input} or Error{usage}.
  void prepare(double spacing);
  /// The last step: makes everything that follows from mesh, field and the order of the BVH.
  void finish(ProgressMeter& progress);
  std::int64_t memory_bytes() const;
};

/// Gives this library access to a body's data.
struct BodyAccess {
  static const BodyData& data(const Body& body) { return *body.data_; }
  static Body body(std::shared_ptr<const BodyData> data) { return Body(std::move(data)); }
};
inline const BodyData& data_of(const Body& body) { return BodyAccess::data(body); }

/// The default spacing for a mesh: it gives 6 to 12 million samples in the box, but is at least a quarter of the mean
/// edge, below which a finer field gives no better bound.
double default_spacing(MeshView mesh, const Box& box);

/// The grids of the fields for a mesh in this box, without samples. Throws Error{limit}.
FieldBounds plan_field_bounds(const Box& box, double spacing);

/// Builds the fields through compute(); they have a sign if the mesh is closed and consistently oriented. Throws
/// Error{limit}.
FieldBounds build_field_bounds(MeshView mesh, Vec3 middle, double spacing, const Execution& execution,
                               ProgressMeter& progress);

/// Builds the BVH over triangles in halving_order(), with coordinates relative to `middle`. The result does not depend
/// on the number of threads. The progress may interrupt it.
BodyBvh build_bvh(MeshView mesh, Vec3 middle, ProgressMeter& progress);

/// The same in a given order, which is a permutation of the triangles.
BodyBvh bvh_in_order(std::vector<std::uint32_t> order, MeshView mesh, Vec3 middle, ProgressMeter& progress);

/// The lowest index of a triangle of each connected component, in ascending order. Triangles are connected if they have
/// a corner at the same position, so a mesh need not be welded. Requires a valid mesh. The progress may interrupt it.
std::vector<std::uint32_t> first_of_components(MeshView mesh, ProgressMeter& progress);

/// Reads a body; for load(), and for the fuzzer, whose bytes never match the checksum. Throws Error{input}.
Body read_body(const FileView& file, ArrayChecksum checksum);

}  // namespace collision
}  // namespace standoff
