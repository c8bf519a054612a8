// SPDX-License-Identifier: Apache-2.0
// Rigid transforms as the kernels read them, on the CPU and on GPUs.
#pragma once

namespace standoff {

/// Coordinates of one frame in another: x -> rotation * x + translation.
struct FloatTransform {
  float rotation[9];
  float translation[3];
};
struct DoubleTransform {
  double rotation[9];
  double translation[3];
};

}  // namespace standoff
