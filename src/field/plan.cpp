// SPDX-License-Identifier: Apache-2.0
#include "field/plan.h"

#include "core/threads.h"
#include "field/options.h"

namespace standoff {

Plan make_plan(std::int64_t triangles, const Grid& grid, double thickness, const ComputeOptions& options,
               bool is_dense) {
  return {&find_backend(options.execution.backend, options.method, triangles, grid),
          effective_rule(options),
          triangles,
          grid,
          thickness,
          thread_count(options.execution.threads),
          options.nearest_triangle,
          options.sign.method != SignMethod::none,
          is_dense};
}

}  // namespace standoff
