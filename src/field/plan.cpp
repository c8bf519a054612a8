// SPDX-License-Identifier: Apache-2.0
#include "field/plan.h"

#include <algorithm>

#include "core/number_text.h"
#include "core/threads.h"
#include "field/options.h"
#include "sign/shell.h"

namespace standoff {

namespace {

// How far distances must be known. Beyond the limit float could not tell them from half of the shell.
double reach(const Grid& grid, double thickness, const SignOptions& sign) {
  if (sign.method != SignMethod::shell) return thickness;
  const double most = std::min(0x1p20 * grid.max_spacing(), 0x1p120);
  if (sign.shell > most)
    throw Error(ErrorCode::limit,
                "compute: a shell of thickness " + number_text(sign.shell) + " is more than " + number_text(most) +
                    " thick, where values in float would be coarser than the grid; give a thinner one");
  return Shell::reach(sign.shell, thickness);
}

}  // namespace

Plan make_plan(std::int64_t triangles, const Grid& grid, double thickness, const ComputeOptions& options,
               bool is_dense) {
  return {&find_backend(options.execution.backend, options.method, triangles, grid),
          effective_rule(options),
          triangles,
          grid,
          reach(grid, thickness, options.sign),
          thickness,
          thread_count(options.execution.threads),
          options.nearest_triangle || options.sign.method == SignMethod::normal,
          options.sign.method != SignMethod::none,
          is_dense,
          options.bytes_beside};
}

}  // namespace standoff
