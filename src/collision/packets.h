// Sixteen balls or boxes at a time: what the kernels work on. Lanes without content hold an empty ball or box.
#pragma once

#include <cstdint>
#include <limits>

namespace difi::collision {

inline constexpr int kLanes = 16;
inline constexpr float kNothing = std::numeric_limits<float>::infinity();

struct alignas(64) Balls {
  float center[3][kLanes];
  float radius[kLanes];  ///< minus infinity: no ball
};

struct alignas(64) Boxes {
  float min[3][kLanes];
  float max[3][kLanes];
};

/// Triangles: corner, axis, lane.
struct alignas(64) Faces {
  float corner[3][3][kLanes];
};

/// One box.
struct FloatBox {
  float min[3] = {kNothing, kNothing, kNothing};
  float max[3] = {-kNothing, -kNothing, -kNothing};

  void include(const float* p) {
    for (int axis = 0; axis < 3; ++axis) {
      min[axis] = p[axis] < min[axis] ? p[axis] : min[axis];
      max[axis] = p[axis] > max[axis] ? p[axis] : max[axis];
    }
  }
  void include(const FloatBox& box) {
    include(box.min);
    include(box.max);
  }
  void grow(float by) {
    for (int axis = 0; axis < 3; ++axis) min[axis] -= by, max[axis] += by;
  }
};

/// Coordinates of one frame in another: x -> rotation * x + translation.
struct FloatPlace {
  float rotation[9];
  float translation[3];
};

/// The fields of a body, as the kernels read them (field_bounds.h). Positions are relative to the body's middle.
struct FieldView {
  float origin[3];                        ///< of sample (0,0,0) of both grids
  float spacing, coarse_spacing;          ///< of the fine and the coarse grid
  float per_spacing, per_coarse_spacing;  ///< their reciprocals
  float last[3], coarse_last[3];          ///< the largest index per axis
  std::int32_t tiles[2];                  ///< of the fine grid along x and y
  std::int32_t coarse_size[2];            ///< of the coarse grid along x and y
  float step;                             ///< what one unit of a fine sample stands for
  float min[3], max[3];                   ///< the box of the surface
  const std::int32_t* slots;              ///< per tile: where its 512 samples start, in tiles
  const std::uint8_t* samples;
  const float* coarse;
};

}  // namespace difi::collision
