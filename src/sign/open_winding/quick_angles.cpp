// SPDX-License-Identifier: Apache-2.0
#include "sign/open_winding/quick_angles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "simd/dispatch.h"

namespace standoff {

using cpu::AngleChunk;
using cpu::AngleTriangles;

QuickAngles::QuickAngles(const Rims& rims, const RimTree& tree, ProgressMeter& progress)
    : rims_(rims), tree_(tree), kernels_(dispatch_of<cpu::SignKernels>().best()) {
  Box box;
  std::size_t triangles = 0;
  for (std::size_t n = 0; n < rims.size(); ++n) {
    box.include(rims[n].apex);
    for (const Vec3& corner : rims[n].corners) box.include(corner);
    if (rims[n].weight == 1) triangles += rims[n].corners.size() == 3 ? 1 : rims[n].corners.size();
  }
  sources_.reserve(triangles);
  for (auto& corner : corners_)
    for (std::vector<float>& axis : corner) axis.reserve(triangles + AngleTriangles::kLanes);
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

// Sums at a point.

namespace {

// Nodes of so few triangles are not opened: to sum up their angles is quicker.
constexpr std::int32_t kFewTriangles = AngleChunk::kMost;

}  // namespace

bool PointSum::begin(const Vec3& p, NodeStack::Part nodes, const Interval& others) {
  constexpr double kFarthest = 0x1p20;  // products of three lengths are far within the range of float
  const Vec3 local = (p - caps_.center_) * caps_.scale_;
  if (!(max_norm(local) < kFarthest) || caps_.tree_.nodes().empty()) return false;
  point_ = p;
  local_ = {static_cast<float>(local.x), static_cast<float>(local.y), static_cast<float>(local.z)};
  coordinates_ = caps_.extent_ + max_norm(local);
  fields_.clear();
  for (std::size_t n = nodes.begin; n < nodes.end; ++n)
    fields_.push_back({0, std::numeric_limits<double>::infinity(), stack_[n]});
  angles_ = cpu::AngleSums::none();
  angle_error_ = 0;
  sum_ = others;
  return true;
}

Interval PointSum::refine(double tolerance) {
  const FieldTolerance allowed(tolerance);
  std::swap(fields_, before_);
  fields_.clear();
  for (const Field& field : before_) {
    if (field.error <= tolerance)
      fields_.push_back(field);
    else if (std::isinf(field.error))
      add(field.node, allowed);
    else
      open(field.node, allowed);
  }
  Interval sum{sum_.value + angles_.turns(), sum_.error + angle_error_ + 1e-12};
  for (const Field& field : fields_) {
    sum.value += field.value;
    sum.error += field.error;
  }
  return sum;
}

void PointSum::add(std::int32_t number, const FieldTolerance& tolerance) {
  stack_.count(1);
  if (const auto field = far_field_at(caps_.tree_[number].caps, point_, tolerance))
    fields_.push_back({field->value, field->error, number});
  else
    open(number, tolerance);
}

void PointSum::open(std::int32_t number, const FieldTolerance& tolerance) {
  const RimTree::Node& node = caps_.tree_[number];
  const QuickAngles::Range& range = caps_.ranges_[static_cast<std::size_t>(number)];
  if (node.is_leaf() || range.size() <= kFewTriangles) return add_angles(range);
  add(number + 1, tolerance);
  add(node.right, tolerance);
}

void PointSum::add_angles(const QuickAngles::Range& range) {
  const auto add_exactly = [&](const CapAngle& angle) {
    sum_.value += angle.value;
    sum_.error += angle.error;
  };
  for (std::int32_t n = range.first_weighted; n < range.past_weighted; ++n)
    add_exactly(cap_angle(caps_.rims_[static_cast<std::size_t>(caps_.weighted_[static_cast<std::size_t>(n)])], point_));
  AngleTriangles triangles;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t axis = 0; axis < 3; ++axis) triangles.corner[k][axis] = caps_.corners_[k][axis].data();
  const auto least_length = static_cast<float>(cpu::kLeastLength * coordinates_);
  for (std::int32_t first = range.first_triangle; first < range.past_triangle; first += AngleChunk::kMost) {
    const int count = std::min<int>(AngleChunk::kMost, range.past_triangle - first);
    stack_.count(static_cast<std::size_t>(count / 8));
    AngleChunk chunk;
    caps_.kernels_.add_solid_angles(triangles, first, count, local_.data(), least_length, angles_, chunk);
    if (chunk.left_count < count)
      angle_error_ += (count - chunk.left_count) / (2 * std::numbers::pi) *
                      cpu::angle_error(coordinates_, chunk.least_length, std::sqrt(chunk.least_sq));
    for (int n = 0; n < chunk.left_count; ++n) {
      const QuickAngles::Source& source = caps_.sources_[static_cast<std::size_t>(first) + chunk.left[n]];
      const Rim rim = caps_.rims_[static_cast<std::size_t>(source.rim)];
      add_exactly(source.edge < 0 ? cap_angle(rim, point_)
                                  : edge_angle(rim, static_cast<std::size_t>(source.edge), point_));
    }
  }
}

}  // namespace standoff
