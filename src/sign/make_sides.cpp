// SPDX-License-Identifier: Apache-2.0
#include "sign/make_sides.h"

#include <bit>
#include <numeric>

#include "core/guarded.h"
#include "core/threads.h"
#include "sign/flood/flood.h"
#include "sign/normal/normal_sides.h"
#include "sign/open_winding/open_winding.h"
#include "sign/rows/row_crossings.h"
#include "sign/sign_field.h"
#include "standoff/error.h"
#include "standoff/occupancy.h"

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

// Occupancy: the sides alone.

std::int64_t Occupancy::count() const {
  return std::accumulate(bits.begin(), bits.end(), std::int64_t{0},
                         [](std::int64_t sum, std::uint8_t byte) { return sum + std::popcount(byte); });
}

Occupancy occupancy(MeshView mesh, const Grid& grid, const SignOptions& sign, const Execution& execution,
                    const ProgressCallback& progress) try {
  validate("occupancy", execution, Runs::on_the_cpu);
  validate(grid);
  validate(sign);
  for (const SignMethod method : {SignMethod::none, SignMethod::normal, SignMethod::shell})
    if (sign.method == method)
      throw Error(ErrorCode::usage,
                  "occupancy: this sign method decides nothing without distances; take winding, parity or flood, or "
                  "compute a field");
  validate(mesh);
  Occupancy found{grid, {}, {}};
  ProgressMeter meter(progress);
  Threads(execution.threads).run([&] {
    meter.stage("sign", 1, 0, 1);
    SignPlan plan = plan_sign(mesh, sign, meter);
    const auto sides = plan.has_sign() ? make_sides(mesh, plan, sign, {grid}, meter) : nullptr;
    found.bits = sides ? bits_of(*sides, sign.invert, grid, meter).bytes : SampleBits(grid.size).bytes;
    found.sign = plan.report;
  });
  meter.stage("done", 1, 1, 1);
  return found;
} catch (...) {
  throw_as_error("occupancy", "take fewer samples, or provide more memory");
}

}  // namespace standoff
