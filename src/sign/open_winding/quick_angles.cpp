// SPDX-License-Identifier: Apache-2.0
#include "sign/open_winding/quick_angles.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sign/open_winding/cap_angle.h"

namespace standoff {
namespace {

using cpu::AngleChunk;
using cpu::AngleTriangles;

// Nodes of so few triangles are not opened: their angles are quicker.
constexpr std::int32_t kFewTriangles = AngleChunk::kMost;

}  // namespace

struct QuickAngles::Sum {
  Vec3 p;
  std::array<float, 3> local;
  double coordinates;  // of triangles and point together, scaled
  double tolerance;
  NodeStack& stack;
  cpu::AngleSums angles;
  LinearField far;
  Interval exact{0, 0};  // of rims that are summed up one by one
  double error = 0;      // of the angles, in turns
};

QuickAngles::QuickAngles(const Rims& rims, const RimTree& tree, ProgressMeter& progress)
    : rims_(rims), tree_(tree), kernels_(cpu::sign_kernels_for(Simd::automatic)) {
  Box box;
  for (std::size_t n = 0; n < rims.size(); ++n) {
    box.include(rims[n].apex);
    for (const Vec3& corner : rims[n].corners) box.include(corner);
  }
  if (rims.size() > 0) center_ = box.center();
  const double reach = rims.size() > 0 ? max_norm(box.max - center_) : 0;
  if (reach > 0 && std::isfinite(reach)) scale_ = std::ldexp(1.0, -std::ilogb(reach) - 1);
  extent_ = reach * scale_;

  WorkCheck check(progress, 1 << 16);
  ranges_.resize(tree.nodes().size());
  const auto past = [&] { return static_cast<std::int32_t>(sources_.size()); };
  const auto past_weighted = [&] { return static_cast<std::int32_t>(weighted_.size()); };
  for (std::size_t n = 0; n < ranges_.size(); ++n) {
    check.add(1);
    Range& range = ranges_[n];
    range.first_triangle = past();
    range.first_weighted = past_weighted();
    const RimTree::Node& node = tree.nodes()[n];
    if (!node.is_leaf()) continue;
    const Rim rim = rims[static_cast<std::size_t>(node.rim)];
    const std::size_t size = rim.corners.size();
    if (rim.weight != 1) {
      weighted_.push_back(node.rim);
    } else if (size == 3) {
      add_triangle(rim.corners[0], rim.corners[1], rim.corners[2], {node.rim, -1});
    } else {
      for (std::size_t edge = 0; edge < size; ++edge)
        add_triangle(rim.apex, rim.corners[edge], rim.corners[(edge + 1) % size],
                     {node.rim, static_cast<std::int32_t>(edge)});
    }
    range.past_triangle = past();
    range.past_weighted = past_weighted();
  }
  for (std::size_t n = ranges_.size(); n > 0; --n)
    if (const RimTree::Node& node = tree.nodes()[n - 1]; !node.is_leaf()) {
      const Range& last = ranges_[static_cast<std::size_t>(node.right)];
      ranges_[n - 1].past_triangle = last.past_triangle;
      ranges_[n - 1].past_weighted = last.past_weighted;
    }
  for (auto& corner : corners_)
    for (std::vector<float>& axis : corner) axis.resize(axis.size() + AngleTriangles::kLanes);
}

void QuickAngles::add_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Source& source) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 local = ((k == 0 ? a : k == 1 ? b : c) - center_) * scale_;
    corners_[k][0].push_back(static_cast<float>(local.x));
    corners_[k][1].push_back(static_cast<float>(local.y));
    corners_[k][2].push_back(static_cast<float>(local.z));
  }
  sources_.push_back(source);
}

std::optional<Interval> QuickAngles::at(const Vec3& p, double tolerance, NodeStack& stack) const {
  constexpr double kFarthest = 0x1p20;  // products of three lengths are far within the range of float
  const Vec3 local = (p - center_) * scale_;
  if (!(max_norm(local) < kFarthest) || tree_.nodes().empty()) return std::nullopt;
  Sum sum{p,
          {static_cast<float>(local.x), static_cast<float>(local.y), static_cast<float>(local.z)},
          extent_ + max_norm(local),
          tolerance,
          stack,
          {},
          {},
          {0, 0},
          0};
  std::ranges::fill(sum.angles.re, 1.0f);
  std::ranges::fill(sum.angles.im, 0.0f);
  std::ranges::fill(sum.angles.around, 0.0f);
  sum.far.center = p;
  add(0, sum);
  double turns = 0;
  for (std::size_t n = 0; n < AngleTriangles::kLanes; ++n)
    turns += double{sum.angles.around[n]} +
             std::atan2(double{sum.angles.im[n]}, double{sum.angles.re[n]}) / (2 * std::numbers::pi);
  return Interval{turns + sum.exact.value + sum.far.value, sum.error + sum.exact.error + sum.far.error + 1e-12};
}

void QuickAngles::add(std::int32_t number, Sum& sum) const {
  sum.stack.count(1);
  const RimTree::Node& node = tree_[number];
  if (add_far_field(node.caps, {sum.p, {}, 0}, sum.tolerance, sum.far)) return;
  const Range& range = ranges_[static_cast<std::size_t>(number)];
  if (node.is_leaf() || range.size() <= kFewTriangles) return add_angles(range, sum);
  add(number + 1, sum);
  add(node.right, sum);
}

void QuickAngles::add_angles(const Range& range, Sum& sum) const {
  const auto add_exactly = [&](const CapAngle& angle) {
    sum.exact.value += angle.value;
    sum.exact.error += angle.error;
  };
  for (std::int32_t n = range.first_weighted; n < range.past_weighted; ++n)
    add_exactly(cap_angle(rims_[static_cast<std::size_t>(weighted_[static_cast<std::size_t>(n)])], sum.p));
  AngleTriangles triangles;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t axis = 0; axis < 3; ++axis) triangles.corner[k][axis] = corners_[k][axis].data();
  const auto least_length = static_cast<float>(cpu::kLeastLength * sum.coordinates);
  for (std::int32_t first = range.first_triangle; first < range.past_triangle; first += AngleChunk::kMost) {
    const int count = std::min<int>(AngleChunk::kMost, range.past_triangle - first);
    sum.stack.count(static_cast<std::size_t>(count / 8));
    AngleChunk chunk;
    kernels_.add_solid_angles(triangles, first, count, sum.local.data(), least_length, sum.angles, chunk);
    if (chunk.left_count < count)
      sum.error += (count - chunk.left_count) / (2 * std::numbers::pi) *
                   cpu::angle_error(sum.coordinates, chunk.least_length, std::sqrt(chunk.least_sq));
    for (int n = 0; n < chunk.left_count; ++n) {
      const Source& source = sources_[static_cast<std::size_t>(first) + chunk.left[n]];
      const Rim rim = rims_[static_cast<std::size_t>(source.rim)];
      add_exactly(source.edge < 0 ? cap_angle(rim, sum.p)
                                  : edge_angle(rim, static_cast<std::size_t>(source.edge), sum.p));
    }
  }
}

}  // namespace standoff
