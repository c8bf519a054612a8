// SPDX-License-Identifier: Apache-2.0
#include "standoff/occupancy.h"

#include <bit>
#include <numeric>

#include "core/guarded.h"
#include "core/threads.h"
#include "sign/make_sides.h"
#include "sign/options.h"
#include "sign/sample_bits.h"
#include "standoff/error.h"

namespace standoff {
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
