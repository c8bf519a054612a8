// SPDX-License-Identifier: Apache-2.0
#include "sign/make_sides.h"

#include "sign/flood/flood.h"
#include "sign/normal/normal_sides.h"
#include "sign/open_winding/open_winding.h"
#include "sign/rows/integer_winding.h"

namespace standoff {
namespace {

std::unique_ptr<Sides> winding_sides(const OrientedMesh& mesh, const SignPlan& plan, WindingRule rule,
                                     const UnsignedField& field, ProgressMeter& progress) {
  if (plan.boundary.edges.empty())
    return std::make_unique<IntegerWinding>(mesh, field.grid, rule, progress, field.crossing_bytes);
  return std::make_unique<OpenWinding>(mesh, plan.boundary, field.grid, rule, progress);
}

std::unique_ptr<Sides> flood_sides(MeshView mesh, SignPlan& plan, const SignOptions& options, const Grid& grid,
                                   ProgressMeter& progress) {
  auto sides = std::make_unique<Flood>(mesh, grid, progress);
  if (!sides->leaks()) return sides;
  plan.report.sure = false;
  plan.report.why += "; the flood comes everywhere, so nothing is inside: the gaps are too wide for this grid";
  expect_sure(plan, options);
  if (options.method != SignMethod::automatic) return sides;
  plan.report.method = SignMethod::none;
  return nullptr;
}

}  // namespace

std::unique_ptr<Sides> make_sides(MeshView mesh, SignPlan& plan, const SignOptions& options, const UnsignedField& field,
                                  ProgressMeter& progress) {
  const OrientedMesh oriented{mesh, plan.use};
  switch (plan.report.method) {
    case SignMethod::winding:
      return winding_sides(oriented, plan, options.rule, field, progress);
    case SignMethod::flood:
      return flood_sides(mesh, plan, options, field.grid, progress);
    case SignMethod::normal:
      return std::make_unique<NormalSides>(oriented, field.grid, field.thickness, field.nearest, progress);
    default:
      return std::make_unique<IntegerWinding>(oriented, field.grid, WindingRule::odd, progress, field.crossing_bytes);
  }
}

}  // namespace standoff
