// SPDX-License-Identifier: Apache-2.0
// Which side of a surface is inside (docs/sign.md).
#pragma once

namespace standoff {

/// How the sign of a field is decided. The sign never changes the magnitude of a value.
enum class SignMethod {
  none,     ///< no sign: all values are positive
  winding,  ///< by the winding number of the mesh, an exact integer; the mesh must be closed and oriented
  parity,   ///< by the parity of the winding number; the mesh must be closed, its orientation does not matter
};

/// Which winding numbers are inside, for SignMethod::winding.
enum class WindingRule {
  positive,  ///< above 0: overlapping solids are united, and a solid turned inside out is a cavity
  nonzero,   ///< not 0: the orientation of a whole solid does not matter
  odd,       ///< odd: a solid inside a solid is a cavity
};

struct SignOptions {
  SignMethod method = SignMethod::none;
  WindingRule rule = WindingRule::positive;
  bool invert = false;  ///< exchange inside and outside, for example for the scan of a room
};

}  // namespace standoff
