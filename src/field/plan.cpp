// SPDX-License-Identifier: Apache-2.0
#include "field/plan.h"

#include <algorithm>

#include "core/number_text.h"
#include "core/threads.h"
#include "field/lattice.h"
#include "field/options.h"
#include "sign/shell.h"

namespace standoff {

namespace {

// 0 where one slab would hold the whole grid.
std::int64_t layers_of_slab(const Grid& grid, std::int64_t slab_samples) {
  const std::int64_t layers = std::max<std::int64_t>(1, slab_samples / (grid.size.x * grid.size.y) / kBrickSide);
  return layers < (grid.size.z + kBrickSide - 1) / kBrickSide ? layers : 0;
}

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

bool is_decided_in_slabs(SignMethod method) { return method != SignMethod::flood && method != SignMethod::normal; }

Plan make_plan(std::int64_t triangles, const Grid& grid, double thickness, const ComputeOptions& options, bool is_dense,
               std::int64_t slab_samples) {
  const BackendRow& row = find_backend(options.execution.backend, options.method, triangles, grid);
  const bool in_slabs = slab_samples != 0 && row.in_layers && is_decided_in_slabs(options.sign.method);
  return {&row,
          effective_rule(options),
          options.method == Method::tiles && options.skip.kind == SkipRule::Kind::automatic,
          triangles,
          grid,
          reach(grid, thickness, options.sign),
          thickness,
          thread_count(options.execution.threads),
          options.nearest_triangle || options.sign.method == SignMethod::normal,
          options.sign.method != SignMethod::none,
          is_dense,
          options.bytes_beside,
          slab_samples,
          in_slabs ? layers_of_slab(grid, slab_samples) : 0};
}

}  // namespace standoff
