// SPDX-License-Identifier: Apache-2.0
// Boxes of triangles and of packs of them, as the culling kernels read and write them.
#pragma once

#include <cstdint>

#include "field/cpu/lattice.h"

namespace standoff::cpu {

/// Boxes of entries, an array per coordinate with room for a whole register past the last.
struct BoxArrays {
  float* low[3];
  float* high[3];
  std::uint32_t* entry;
  std::int64_t count;
};

/// The boxes of up to kLanes consecutive entries, together because they are looked at together.
struct BoxPack {
  alignas(64) float low[3][kLanes];
  alignas(64) float high[3][kLanes];
};

/// What a pack holds: `count` consecutive entries from `first` on, and their boxes.
struct PackContents {
  std::uint32_t first;
  int count;
  const BoxPack* boxes;
};

}  // namespace standoff::cpu
