// SPDX-License-Identifier: Apache-2.0
// What a field may carry beside its distances: arrays with some numbers for each stored sample.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace standoff {

/// An array beside a field. The numbers of sample n (x fastest, below DistanceField::kTileSamples) of the tile in slot
/// s are values[(512 * s + n) * components] and those after it; slots are those of DistanceField::slots(). Samples
/// without an answer, beyond the band or the grid, have 0, as all samples of tiles that are not stored.
struct Sidecar {
  std::string name;    ///< "closest_point", also the name of the array in files; letters, digits and underscores
  int components = 1;  ///< numbers per sample
  std::variant<std::vector<float>, std::vector<std::uint8_t>> values;
};

}  // namespace standoff
