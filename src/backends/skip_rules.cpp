// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "field/skip.h"
#include "thesis/skip_neighbour.h"

namespace standoff {
namespace {

constexpr std::array kSkipRows{
    SkipRow{SkipRule::Kind::neighbour,
            [](MeshView mesh, const Grid&, double thickness, double fraction) {
              return kept_by_neighbour_rule(mesh, thickness, fraction);
            },
            sizeof(std::uint32_t)},
    SkipRow{SkipRule::Kind::exact,
            [](MeshView mesh, const Grid& grid, double thickness, double) {
              return kept_by_exact_rule(mesh, grid, thickness);
            },
            kExactRuleBytes},
};

}  // namespace

const SkipRow* find_skip_rule(SkipRule::Kind kind) {
  for (const SkipRow& row : kSkipRows)
    if (row.kind == kind) return &row;
  return nullptr;
}

}  // namespace standoff
