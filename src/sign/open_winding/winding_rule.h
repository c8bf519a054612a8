// SPDX-License-Identifier: Apache-2.0
// Which winding numbers are inside, and how near generalised ones are to the other side.
#pragma once

#include <cmath>
#include <cstdint>

#include "standoff/sign.h"

namespace standoff {

/// Exactly at a threshold, a half-integer, the value of smaller magnitude decides.
inline bool is_inside(double winding, WindingRule rule) {
  switch (rule) {
    case WindingRule::positive:
      return winding > 0.5;
    case WindingRule::nonzero:
      return std::abs(winding) > 0.5;
    case WindingRule::odd:
      return std::fmod(std::ceil(std::abs(winding) - 0.5), 2) == 1;
  }
  return false;
}

/// Whether samples with this winding number are inside.
inline bool is_inside(std::int32_t winding, WindingRule rule) {
  switch (rule) {
    case WindingRule::positive:
      return winding > 0;
    case WindingRule::nonzero:
      return winding != 0;
    case WindingRule::odd:
      return (winding & 1) != 0;
  }
  return false;
}

/// The distance of the nearest threshold.
inline double margin(double winding, WindingRule rule) {
  switch (rule) {
    case WindingRule::positive:
      return std::abs(winding - 0.5);
    case WindingRule::nonzero:
      return std::abs(std::abs(winding) - 0.5);
    case WindingRule::odd:
      return std::abs(winding - std::floor(winding) - 0.5);
  }
  return 0;
}

}  // namespace standoff
