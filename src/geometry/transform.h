// Rigid transforms as the kernels read them, on the CPU and on GPUs.
#pragma once

namespace standoff::collision {

/// Coordinates of one frame in another: x -> rotation * x + translation.
struct FloatPlace {
  float rotation[9];
  float translation[3];
};
struct DoublePlace {
  double rotation[9];
  double translation[3];
};

}  // namespace standoff::collision
