// SPDX-License-Identifier: Apache-2.0
// Which samples are inside: the signs alone, without a field.
#include <bit>
#include <numeric>

#include "core/guarded.h"
#include "core/threads.h"
#include "sign/methods.h"
#include "sign/sign_field.h"
#include "standoff/error.h"
#include "standoff/occupancy.h"

namespace standoff {

std::int64_t Occupancy::count() const {
  return std::accumulate(bits.begin(), bits.end(), std::int64_t{0},
                         [](std::int64_t sum, std::uint8_t byte) { return sum + std::popcount(byte); });
}

Occupancy occupancy(MeshView mesh, const Grid& grid, const OccupancyOptions& options) try {
  const SignOptions& sign = options.sign;
  validate("occupancy", options.execution, Runs::on_the_cpu);
  validate(grid);
  validate(sign);
  if (!find_info(sign.method)->at_samples)
    throw Error(ErrorCode::usage,
                "occupancy: this sign method decides nothing without distances; take another, such as winding, or "
                "compute a field");
  validate(mesh);
  Occupancy found{grid, {}, {}};
  ProgressMeter meter(options.progress);
  Threads(options.execution.threads).run([&] {
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
