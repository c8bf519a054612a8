// SPDX-License-Identifier: Apache-2.0
#include "sign/make_signs.h"

#include <bit>
#include <numeric>

#include "core/guarded.h"
#include "core/threads.h"
#include "sign/flood/flood.h"
#include "sign/normal/normal_signs.h"
#include "sign/open_winding/open_winding.h"
#include "sign/rows/row_crossings.h"
#include "sign/sign_field.h"
#include "standoff/error.h"
#include "standoff/occupancy.h"

namespace standoff {
namespace {

std::unique_ptr<SampleSigns> winding_signs(const OrientedMesh& mesh, const SignPlan& plan, WindingRule rule,
                                           const UnsignedField& field, ProgressMeter& progress) {
  if (plan.boundary.edges.empty())
    return std::make_unique<IntegerWinding>(mesh, field.grid, rule, progress, field.crossing_bytes);
  return std::make_unique<OpenWinding>(mesh, plan.boundary, field.grid, rule, progress);
}

std::unique_ptr<SampleSigns> flood_signs(MeshView mesh, SignPlan& plan, const SignOptions& options, const Grid& grid,
                                         ProgressMeter& progress) {
  auto signs = std::make_unique<Flood>(mesh, grid, progress);
  if (!signs->leaks()) return signs;
  plan.report.sure = false;
  plan.report.why += "; the flood comes everywhere, so nothing is inside: the gaps are too wide for this grid";
  expect_sure(plan, options);
  if (options.method != SignMethod::automatic) return signs;
  plan.report.method = SignMethod::none;
  return nullptr;
}

}  // namespace

std::unique_ptr<SampleSigns> make_signs(MeshView mesh, SignPlan& plan, const SignOptions& options,
                                        const UnsignedField& field, ProgressMeter& progress) {
  const OrientedMesh oriented{mesh, plan.use};
  switch (plan.report.method) {
    case SignMethod::winding:
      return winding_signs(oriented, plan, options.rule, field, progress);
    case SignMethod::flood:
      return flood_signs(mesh, plan, options, field.grid, progress);
    case SignMethod::normal:
      return std::make_unique<NormalSigns>(oriented, field.grid, field.thickness, field.nearest, progress);
    default:
      return std::make_unique<IntegerWinding>(oriented, field.grid, WindingRule::odd, progress, field.crossing_bytes);
  }
}

// Occupancy: the signs alone.

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
    const auto signs = plan.has_sign() ? make_signs(mesh, plan, sign, {grid}, meter) : nullptr;
    found.bits = signs ? bits_of(*signs, sign.invert, grid, meter).bytes : SampleBits(grid.size).bytes;
    found.sign = plan.report;
  });
  meter.stage("done", 1, 1, 1);
  return found;
} catch (...) {
  throw_as_error("occupancy", "take fewer samples, or provide more memory");
}

}  // namespace standoff
