// SPDX-License-Identifier: Apache-2.0
#include "field/sign_judge.h"

#include <cmath>
#include <utility>

#include "sign/closed.h"
#include "sign/mesh_edges.h"

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

bool contains(const Box& box, const Vec3& p) { return min(box.min, p) == box.min && max(box.max, p) == box.max; }

}  // namespace

SignJudge::SignJudge(MeshView mesh, const TriangleGroups& groups, const SignText& sign, std::vector<std::int8_t> use)
    : groups_(groups), sign_(sign), use_(std::move(use)), box_(bounds(mesh)) {
  mesh_ = {mesh, use_};
  if (sign.method == SignMethod::flood) way_ = Way::box;
  if (sign.method == SignMethod::parity && closed_in_use(mesh_).unoriented) way_ = Way::crossings;
  if (sign.method == SignMethod::winding) way_ = closed_in_use(mesh_).oriented ? Way::crossings : Way::angles;
}

bool SignJudge::is_inside(double whole) const {
  const bool odd = std::fmod(std::abs(whole), 2) == 1;
  if (sign_.method == SignMethod::parity || sign_.rule == WindingRule::odd) return odd;
  return sign_.rule == WindingRule::nonzero ? whole != 0 : whole > 0;
}

SideJudgement SignJudge::judge(const Vec3& p) const {
  if (way_ == Way::none) return {};
  if (way_ == Way::box) return {contains(box_, p) ? std::nullopt : std::optional(sign_.invert), std::nullopt};
  const ReferenceWinding winding =
      way_ == Way::crossings ? winding_by_crossings(mesh_, groups_, p) : winding_by_angles(mesh_, p);
  // All rules depend on the nearest whole number alone, so the side changes at the halves.
  const double whole = std::round(winding.value);
  if (winding.on_surface || !(std::abs(winding.value - whole) + winding.error < 0.5)) return {};
  return {is_inside(whole) != sign_.invert, winding.value};
}

}  // namespace standoff
