// SPDX-License-Identifier: Apache-2.0
// Round numbers along a scale, and numbers as words.
#pragma once

#include <string>
#include <vector>

namespace standoff {

struct Tick {
  double value = 0;
  std::string label;
};

/// Multiples of 1, 2 or 5 times a power of ten from `least` to `greatest`, rising: as many as possible, but no more
/// than fit `most` steps. All labels have the same number of decimals, or all are multiples of one power of ten. None
/// where doubles are too coarse for them, or the range is empty or not finite.
std::vector<Tick> even_ticks(double least, double greatest, int most);

/// A number in at most so many significant digits: "0.3", "−12.5", "1.235×10⁶".
std::string short_text(double number, int digits);

}  // namespace standoff
