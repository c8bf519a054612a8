// SPDX-License-Identifier: Apache-2.0
#include "field/sign_judge.h"

#include <cmath>
#include <utility>

#include "sign/diagnosis/closed.h"
#include "sign/diagnosis/mesh_edges.h"

namespace standoff {
namespace {

// Edge by edge, without the hashes that compute() relies on.
Closed closed_in_use(const OrientedMesh& mesh) {
  Closed closed{true, true};
  MeshEdges(mesh.mesh).for_each([&](std::span<const EdgeUse> uses) {
    std::int64_t forward = 0, count = 0;
    for (const EdgeUse& one : uses) {
      const int use = mesh.use_of(one.triangle);
      forward += one.forward ? use : -use;
      count += use != 0;
    }
    closed.oriented = closed.oriented && forward == 0;
    closed.unoriented = closed.unoriented && count % 2 == 0;
  });
  return closed;
}

// So near to a threshold compute() leaves the side of an open mesh's sample to rounding (sign/open_winding).
constexpr double kEitherSide = 1e-9;

bool contains(const Box& box, const Vec3& p) { return min(box.min, p) == box.min && max(box.max, p) == box.max; }

}  // namespace

bool is_closed_in_use(const OrientedMesh& mesh) { return closed_in_use(mesh).oriented; }

SignJudge::SignJudge(MeshView mesh, const TriangleGroups& groups, const SignText& sign, std::vector<std::int8_t> use)
    : groups_(groups), sign_(sign), use_(std::move(use)), box_(bounds(mesh)) {
  mesh_ = {mesh, use_};
  if (sign.method == SignMethod::flood) way_ = Way::box;
  if (sign.method == SignMethod::normal) way_ = Way::nearest;
  if (sign.method == SignMethod::parity && closed_in_use(mesh_).unoriented) way_ = Way::crossings;
  if (sign.method == SignMethod::winding) way_ = closed_in_use(mesh_).oriented ? Way::crossings : Way::angles;
}

bool SignJudge::is_inside(double whole) const {
  const bool odd = std::fmod(std::abs(whole), 2) == 1;
  if (sign_.method == SignMethod::parity || sign_.rule == WindingRule::odd) return odd;
  return sign_.rule == WindingRule::nonzero ? whole != 0 : whole > 0;
}

SideJudgement SignJudge::by_winding(const Vec3& p) const {
  const ReferenceWinding winding =
      way_ == Way::crossings ? winding_by_crossings(mesh_, groups_, p) : winding_by_angles(mesh_, p);
  // All rules depend on the nearest whole number alone, so the side changes at the halves.
  const double whole = std::round(winding.value);
  const double from_whole = std::abs(winding.value - whole) + winding.error;
  if (winding.on_surface || !(from_whole < 0.5 - kEitherSide)) return {};
  return {is_inside(whole), winding.value};
}

// The normal of the nearest feature is a sum of its triangles' normals, with positive weights. If all triangles that
// may be the nearest one have p on the same side, so has every such sum.
std::optional<bool> SignJudge::behind_nearest(const Vec3& p, double allowed) const {
  bool front = false, back = false;
  groups_.for_each_within(p, groups_.distance(p) + allowed, [&](std::uint32_t triangle) {
    if (mesh_.use_of(triangle) == 0) return;
    const auto [a, b, c] = mesh_.corners(triangle);
    const Vec3 normal = cross(b - a, c - a);
    // Not a number for a triangle without an area, which has no side.
    const double height = dot(p - a, normal) / length(normal);
    front = front || height > allowed;
    back = back || height < -allowed;
  });
  return front == back ? std::nullopt : std::optional(back);
}

SideJudgement SignJudge::judge(const Vec3& p, double allowed) const {
  SideJudgement side;
  if (way_ == Way::nearest) side.inside = behind_nearest(p, allowed);
  if (way_ == Way::box && !contains(box_, p)) side.inside = false;
  if (way_ == Way::crossings || way_ == Way::angles) side = by_winding(p);
  if (side.inside) side.inside = *side.inside != sign_.invert;
  return side;
}

}  // namespace standoff
