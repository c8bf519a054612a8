// The kernels' source, included by each kernels_*.cpp in a namespace of its own: plain loops over 16 lanes, which the
// compiler turns into vectors. Nothing is fused, so all instruction sets round alike.
//
// The bounds (docs/collision.md): distance is 1-Lipschitz, so a sample s at x_i gives d(x) >= s - |x - x_i| for every
// x, and a ball (x, r) is at least d(x) - r away. The nearest sample is taken, of the coarse field and then of the fine
// one; a sample clamped by the band's half-width is still a lower bound. So is the distance to the surface's box.

inline float least(float a, float b) { return a < b ? a : b; }
inline float most(float a, float b) { return a > b ? a : b; }

void gaps_at(const FieldView& f, const float (*center)[kLanes], const float* radius, float enough, float* gap) {
  alignas(64) std::int32_t coarse_at[kLanes], tile[kLanes], within[kLanes];
  alignas(64) float coarse_off[kLanes], fine_off[kLanes], outside[kLanes];
  for (int n = 0; n < kLanes; ++n) {
    float box_sq = 0, coarse_sq = 0, fine_sq = 0;
    std::int32_t coarse_index[3], fine_index[3];
    for (int axis = 0; axis < 3; ++axis) {
      const float x = center[axis][n];
      const float out = most(most(f.min[axis] - x, x - f.max[axis]), 0.0f);
      box_sq += out * out;
      const float u = (x - f.origin[axis]) * f.per_coarse_spacing;
      coarse_index[axis] = static_cast<std::int32_t>(least(most(u, 0.0f), f.coarse_last[axis]) + 0.5f);
      const float du = u - static_cast<float>(coarse_index[axis]);
      coarse_sq += du * du;
      const float v = (x - f.origin[axis]) * f.per_spacing;
      fine_index[axis] = static_cast<std::int32_t>(least(most(v, 0.0f), f.last[axis]) + 0.5f);
      const float dv = v - static_cast<float>(fine_index[axis]);
      fine_sq += dv * dv;
    }
    outside[n] = __builtin_sqrtf(box_sq) - radius[n];
    coarse_off[n] = __builtin_sqrtf(coarse_sq) * f.coarse_spacing + radius[n];
    fine_off[n] = __builtin_sqrtf(fine_sq) * f.spacing + radius[n];
    coarse_at[n] = (coarse_index[2] * f.coarse_size[1] + coarse_index[1]) * f.coarse_size[0] + coarse_index[0];
    tile[n] = ((fine_index[2] >> 3) * f.tiles[1] + (fine_index[1] >> 3)) * f.tiles[0] + (fine_index[0] >> 3);
    within[n] = (fine_index[2] & 7) << 6 | (fine_index[1] & 7) << 3 | (fine_index[0] & 7);
  }
  for (int n = 0; n < kLanes; ++n) gap[n] = most(outside[n], f.coarse[coarse_at[n]] - coarse_off[n]);
  for (int n = 0; n < kLanes; ++n) {
    if (gap[n] > enough) continue;
    const std::uint8_t sample = f.samples[(static_cast<std::int64_t>(f.slots[tile[n]]) << 9) + within[n]];
    gap[n] = most(gap[n], static_cast<float>(sample) * f.step - fine_off[n]);
  }
}

void gaps(const FieldView& f, const FloatPlace& place, const Balls& balls, float enough, float* gap) {
  alignas(64) float center[3][kLanes];
  const float* r = place.rotation;
  for (int axis = 0; axis < 3; ++axis)
    for (int n = 0; n < kLanes; ++n)
      center[axis][n] = r[3 * axis] * balls.center[0][n] + r[3 * axis + 1] * balls.center[1][n] +
                        r[3 * axis + 2] * balls.center[2][n] + place.translation[axis];
  gaps_at(f, center, balls.radius, enough, gap);
}

std::uint32_t overlaps(const Boxes& boxes, const FloatBox& box) {
  alignas(64) std::int32_t meets[kLanes];
  for (int n = 0; n < kLanes; ++n)
    meets[n] = (boxes.min[0][n] <= box.max[0]) & (boxes.max[0][n] >= box.min[0]) & (boxes.min[1][n] <= box.max[1]) &
               (boxes.max[1][n] >= box.min[1]) & (boxes.min[2][n] <= box.max[2]) & (boxes.max[2][n] >= box.min[2]);
  std::uint32_t mask = 0;
  for (int n = 0; n < kLanes; ++n) mask |= static_cast<std::uint32_t>(meets[n]) << n;
  return mask;
}

void distances_sq(const Boxes& boxes, const FloatBox& box, float* distance_sq) {
  for (int n = 0; n < kLanes; ++n) {
    float sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float out = most(most(boxes.min[axis][n] - box.max[axis], box.min[axis] - boxes.max[axis][n]), 0.0f);
      sum += out * out;
    }
    distance_sq[n] = sum;
  }
}
