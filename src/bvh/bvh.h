// SPDX-License-Identifier: Apache-2.0
// The hierarchy of boxes over triangles that fields, points, signs and bodies share, and the ways through it.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "bvh/boxes16.h"
#include "core/memory.h"
#include "core/progress.h"
#include "standoff/mesh.h"

namespace standoff {

/// The coordinates in which boxes are kept in float: world units times `scale`, a power of two, less `center`.
struct BvhFrame {
  Vec3 center;       ///< scaled units
  double scale = 1;  ///< scaled units per world unit
  /// Boxes are grown on each side by kBoxError of their coordinate, or of this if it is larger; not at all where it is
  /// negative. A box that is not grown still meets all boxes that it meets in double, because rounding is monotonic;
  /// only distances from it may be too large.
  float extent = -1;

  Vec3 local(const Vec3& world) const { return world * scale - center; }
  FloatBox local(const Box& world) const;
  /// A power of two: scale, or less where the square of a length from a far point would overflow.
  double scale_at(const Vec3& point) const;
};

/// What boxes are grown by on each side, as a share of the largest coordinate: 16 units of float rounding. Their own
/// rounding takes 1, that of a culling reference sqrt(3) and that of a cell's centre sqrt(3)/2, all of coordinates
/// within the extent. References far outside are covered by kCullMargin (field/cpu/kernels/cull_boxes.inl). Decides no
/// bit while it is above that; smaller, and culling may drop the triangle that is nearest. Larger: more boxes are kept.
inline constexpr float kBoxError = 0x1p-20f;

/// Half the longest side of the mesh's box is 1 to 2, and is the extent.
BvhFrame frame_around(MeshView mesh);

/// `count` consecutive entries from `first` on, and their boxes.
struct BvhNode {
  std::uint32_t first;
  int count;
  const Boxes16* boxes;
};

/// An implicit hierarchy without pointers: triangles in an order (order.h) are the children of nodes, sixteen each;
/// nodes, sixteen each, those of nodes of the level above; and so on. An *entry* is a triangle, by its place in the
/// order (below triangles()), or from there on a node.
class Bvh {
 public:
  static constexpr int kFanout = Boxes16::kLanes, kMostLevels = 8;

  Bvh() = default;
  /// `order`: triangles of the mesh. `centroids`: where given, they are written too, in the frame's units and by place,
  /// while the corners are at hand. Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
  Bvh(MeshView mesh, std::vector<std::uint32_t> order, const BvhFrame& frame, ProgressMeter& progress,
      float (*centroids)[3] = nullptr);

  /// Takes over the corners of the triangles at some places, whose vertices moved; the order stays. Returns false where
  /// one is now more than twice the extent from the frame's center: then a new hierarchy must take this one's place.
  bool follow(MeshView mesh, std::span<const std::uint32_t> places);

  /// The number of entries that so many triangles make: they and their nodes.
  static std::int64_t entries_of(std::int64_t triangles);
  /// The bytes of a hierarchy of so many triangles.
  static std::int64_t bytes_of(std::int64_t triangles);
  std::int64_t entries() const { return std::int64_t{triangles()} + nodes(); }
  std::int64_t bytes() const { return bytes_of(triangles()); }

  std::uint32_t triangles() const { return static_cast<std::uint32_t>(order_.size()); }
  std::uint32_t nodes() const { return level_begin_.back(); }
  /// The triangle of the mesh at each place of the order.
  const std::vector<std::uint32_t>& order() const { return order_; }
  const BvhFrame& frame() const { return frame_; }
  /// The boxes of all nodes' children, and the first node of each level, that of triangles first; then the end.
  const Boxes16* boxes() const { return boxes_.data(); }
  std::span<const std::uint32_t> level_begin() const { return level_begin_; }
  int top_level() const { return static_cast<int>(level_begin_.size()) - 2; }
  std::span<const Boxes16> level(int number) const {
    const auto n = static_cast<std::size_t>(number);
    return {boxes_.data() + level_begin_[n], boxes_.data() + level_begin_[n + 1]};
  }
  /// The box around all triangles.
  FloatBox box() const;

  bool is_node(std::uint32_t entry) const { return entry >= triangles(); }
  /// The entry of the node that holds all others.
  std::uint32_t root() const { return triangles() + nodes() - 1; }
  /// The children of an entry that is a node.
  BvhNode node(std::uint32_t entry) const {
    const std::uint32_t number = entry - triangles();
    const std::size_t level = level_of(number);
    // Of a level of nodes or triangles the k-th node above it holds kFanout, from k * kFanout on.
    const std::uint32_t begin = level == 0 ? 0 : triangles() + level_begin_[level - 1];
    const std::uint32_t end = level == 0 ? triangles() : triangles() + level_begin_[level];
    const std::uint32_t first = begin + kFanout * (number - level_begin_[level]);
    return {first, static_cast<int>(std::min<std::uint32_t>(kFanout, end - first)), &boxes_[number]};
  }
  /// The first of the triangles that an entry stands for.
  std::uint32_t first_triangle(std::uint32_t entry) const {
    if (!is_node(entry)) return entry;
    const std::size_t level = level_of(entry - triangles());
    return (entry - triangles() - level_begin_[level]) << 4 * (level + 1);
  }
  /// How many triangles an entry stands for, at most: the last node of a level may hold fewer.
  std::int64_t triangles_in(std::uint32_t entry) const {
    return is_node(entry) ? std::int64_t{kFanout} << 4 * level_of(entry - triangles()) : 1;
  }
  /// Asks the memory for the boxes of a node that will be looked at soon.
  void prefetch(std::uint32_t entry) const {
    const char* const boxes = reinterpret_cast<const char*>(&boxes_[entry - triangles()]);
    for (std::size_t line = 0; line < sizeof(Boxes16); line += 64) __builtin_prefetch(boxes + line);
  }

 private:
  static_assert(kFanout == 1 << 4);
  std::size_t level_of(std::uint32_t node) const {
    std::size_t level = 0;
    while (node >= level_begin_[level + 1]) ++level;
    return level;
  }
  FloatBox grown_box(const std::array<Vec3, 3>& corners) const;
  void set_box(std::uint32_t node, int lane, const FloatBox& box);
  void box_triangles(MeshView mesh, ProgressMeter& progress, float (*centroids)[3]);
  void box_node(std::uint32_t number);
  void box_nodes(ProgressMeter& progress);

  BvhFrame frame_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint32_t> level_begin_{0};
  HugePageArray<Boxes16> boxes_;
};

// The ways through a hierarchy. Entries that wait are kept on the stack: sixteen children of each level.

inline constexpr std::size_t kMostWaiting = std::size_t{Bvh::kFanout} * (Bvh::kMostLevels + 1);

/// Calls visit(place) for all triangles whose boxes meet this one, which is finite. `meets`: overlapping(), or its
/// kernel.
template <class Meets, class Visit>
void for_each_overlap(const Bvh& bvh, const FloatBox& box, const Meets& meets, const Visit& visit) {
  if (bvh.triangles() == 0) return;
  std::array<std::uint32_t, kMostWaiting> waiting;
  std::size_t count = 0;
  waiting[count++] = bvh.root();
  while (count != 0) {
    const std::uint32_t entry = waiting[--count];
    if (!bvh.is_node(entry)) {
      visit(entry);
      continue;
    }
    const BvhNode node = bvh.node(entry);
    for (std::uint32_t met = meets(*node.boxes, box); met != 0; met &= met - 1)
      waiting[count++] = node.first + static_cast<std::uint32_t>(std::countr_zero(met));
  }
}
template <class Visit>
void for_each_overlap(const Bvh& bvh, const FloatBox& box, const Visit& visit) {
  for_each_overlap(bvh, box, overlapping, visit);
}

namespace detail {

template <class Visit>
bool visit_later(const Bvh& bvh, std::uint32_t entry, int level, std::uint32_t place, const FloatBox& box,
                 std::int64_t& boxes, const Visit& visit) {
  const BvhNode node = bvh.node(entry);
  boxes -= node.count;
  if (boxes < 0) return false;
  for (std::uint32_t met = overlapping(*node.boxes, box); met != 0; met &= met - 1) {
    const std::uint32_t child = node.first + static_cast<std::uint32_t>(std::countr_zero(met));
    if (level == 0) {
      if (child > place && !visit(child)) return false;
      continue;
    }
    // All triangles below a node come before the first of the next one.
    const std::uint64_t next = std::uint64_t{child - (bvh.triangles() + bvh.level_begin()[level - 1])} + 1;
    if (next << 4 * level > std::uint64_t{place} + 1 && !visit_later(bvh, child, level - 1, place, box, boxes, visit))
      return false;
  }
  return true;
}

}  // namespace detail

/// Calls visit(other) for all places after `place` whose boxes meet that of `place`, in their order, until it returns
/// false. Each box compared takes one from `boxes`; returns false if it was stopped, or none was left.
template <class Visit>
bool for_each_later_overlap(const Bvh& bvh, std::uint32_t place, std::int64_t& boxes, const Visit& visit) {
  const FloatBox box = lane_of(bvh.boxes()[place / Bvh::kFanout], static_cast<int>(place % Bvh::kFanout));
  return detail::visit_later(bvh, bvh.root(), bvh.top_level(), place, box, boxes, visit);
}

/// A triangle of the mesh, and how far it is, world units.
struct NearestTriangle {
  double distance = std::numeric_limits<double>::infinity();
  std::uint32_t triangle = kNoTriangle;
};

/// The triangle that is nearest to a point, which may be anywhere; the one of the lowest index of equally near ones. In
/// double. Takes logarithmic time where few triangles are about as near; at the worst it looks at all. Requires the
/// mesh that the hierarchy was made of, and a frame with an extent.
NearestTriangle nearest_triangle(const Bvh& bvh, MeshView mesh, const Vec3& point);

}  // namespace standoff
