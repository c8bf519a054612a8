// The kernels' source, included by each kernels_*.cpp in a namespace of its own: plain loops over 16 lanes, which the
// compiler turns into vectors. Nothing is fused, so all instruction sets round alike.

// Wide values are passed within this file alone: how others would pass them is of no account.
#pragma GCC diagnostic ignored "-Wpsabi"

inline float least(float a, float b) { return a < b ? a : b; }
inline float most(float a, float b) { return a > b ? a : b; }

// Bit n: flags[n] is all ones (they are all ones or zero).
inline std::uint32_t bits_of(const std::int32_t* flags) {
#if defined(__AVX512F__)
  const __m512i all = _mm512_load_si512(flags);
  return _mm512_test_epi32_mask(all, all);
#elif defined(__AVX2__)
  const auto low = _mm256_load_si256(reinterpret_cast<const __m256i*>(flags));
  const auto high = _mm256_load_si256(reinterpret_cast<const __m256i*>(flags + 8));
  return static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_castsi256_ps(low))) |
         static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_castsi256_ps(high))) << 8;
#else
  std::uint32_t bits = 0;
  for (int n = 0; n < kLanes; ++n) bits |= static_cast<std::uint32_t>(flags[n] & 1) << n;
  return bits;
#endif
}

// The least and the most of sixteen.
inline float least_of(const float* values) {
#if defined(__AVX512F__)
  return _mm512_reduce_min_ps(_mm512_load_ps(values));
#else
  float result = values[0];
  for (int n = 1; n < kLanes; ++n) result = least(result, values[n]);
  return result;
#endif
}
inline float most_of(const float* values) {
#if defined(__AVX512F__)
  return _mm512_reduce_max_ps(_mm512_load_ps(values));
#else
  float result = values[0];
  for (int n = 1; n < kLanes; ++n) result = most(result, values[n]);
  return result;
#endif
}

void gaps_at(const FieldView& f, const float (*center)[kLanes], const float* radius, float enough, float* gap) {
  alignas(64) std::int32_t coarse_at[kLanes], tile[kLanes], within[kLanes];
  alignas(64) float coarse_off[kLanes], fine_off[kLanes], outside[kLanes];
  for (int n = 0; n < kLanes; ++n) {
    const BallSamples at = samples_near(f, center[0][n], center[1][n], center[2][n], radius[n]);
    outside[n] = at.outside, coarse_off[n] = at.coarse_off, fine_off[n] = at.fine_off;
    coarse_at[n] = at.coarse, tile[n] = at.tile, within[n] = at.within;
  }
  alignas(64) float bound[kLanes];
  for (int n = 0; n < kLanes; ++n) bound[n] = f.coarse[coarse_at[n]];
  alignas(64) std::int32_t asked[kLanes];
  for (int n = 0; n < kLanes; ++n) {
    gap[n] = most(outside[n], bound[n] - coarse_off[n]);
    asked[n] = -!(gap[n] > enough);
  }
  for (std::uint32_t mask = bits_of(asked); mask != 0; mask &= mask - 1) {
    const int n = __builtin_ctz(mask);
    gap[n] = most(gap[n], static_cast<float>(fine_sample(f, tile[n], within[n])) * f.step - fine_off[n]);
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
    meets[n] = -((boxes.min[0][n] <= box.max[0]) & (boxes.max[0][n] >= box.min[0]) & (boxes.min[1][n] <= box.max[1]) &
                 (boxes.max[1][n] >= box.min[1]) & (boxes.min[2][n] <= box.max[2]) & (boxes.max[2][n] >= box.min[2]));
  return bits_of(meets);
}

void place_faces(const FloatPlace& place, const Faces& faces, float by, Faces& placed, Boxes& boxes, FloatBox& all) {
  const float* r = place.rotation;
  for (int axis = 0; axis < 3; ++axis) {
    for (int k = 0; k < 3; ++k)
      for (int n = 0; n < kLanes; ++n)
        placed.corner[k][axis][n] = r[3 * axis] * faces.corner[k][0][n] + r[3 * axis + 1] * faces.corner[k][1][n] +
                                    r[3 * axis + 2] * faces.corner[k][2][n] + place.translation[axis];
    for (int n = 0; n < kLanes; ++n) {
      const float a = placed.corner[0][axis][n], b = placed.corner[1][axis][n], c = placed.corner[2][axis][n];
      boxes.min[axis][n] = least(a, least(b, c)) - by;
      boxes.max[axis][n] = most(a, most(b, c)) + by;
    }
    all.min[axis] = least_of(boxes.min[axis]), all.max[axis] = most_of(boxes.max[axis]);
  }
}

// Sixteen floats; the compiler makes of them what the instruction set has.
using Wide = float __attribute__((vector_size(4 * kLanes)));
using WideInts = std::int32_t __attribute__((vector_size(4 * kLanes)));
inline Wide wide(const float* from) { return *reinterpret_cast<const Wide*>(from); }
inline Wide wide(float value) { return Wide{} + value; }
inline Wide least(const Wide& a, const Wide& b) { return a < b ? a : b; }
inline Wide most(const Wide& a, const Wide& b) { return a > b ? a : b; }
inline Wide size(const Wide& a) { return most(a, -a); }
inline std::uint32_t bits_of(const WideInts& flags) {
#if defined(__AVX512F__)
  return _mm512_movepi32_mask(reinterpret_cast<__m512i>(flags));
#else
  alignas(64) std::int32_t each[kLanes];
  *reinterpret_cast<WideInts*>(each) = flags;
  return bits_of(each);
#endif
}

// Two triangles are apart where their shadows on some axis are. The axes tried are the two normals. They are rounded,
// and a sliver's may point anywhere: any axis will do, so long as the shadows of both triangles are measured on it, for
// a sliver is no point on its own rounded normal. Shadows are off by a few roundings of products no larger than
// |normal| (the sum of its magnitudes) times the span of the corners, and by what underflows, also in programs that
// have denormals flushed to zero.
constexpr float kShadowRounding = 4e-6f, kShadowUnderflow = 1e-36f;

// Sixteen triangles, their normals, and their own shadows on these, relative to the first corners.
struct Planes {
  Wide corner[3][3];
  Wide normal[3], normal_size;
  Wide low, high;
};
inline Planes planes_of(const Faces& faces) {
  Planes p;
  for (int k = 0; k < 3; ++k)
    for (int axis = 0; axis < 3; ++axis) p.corner[k][axis] = wide(faces.corner[k][axis]);
  Wide edge[2][3], shadow[2] = {};
  for (int k = 0; k < 2; ++k)
    for (int axis = 0; axis < 3; ++axis) edge[k][axis] = p.corner[k + 1][axis] - p.corner[0][axis];
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    p.normal[axis] = edge[0][u] * edge[1][v] - edge[0][v] * edge[1][u];
    for (int k = 0; k < 2; ++k) shadow[k] += p.normal[axis] * edge[k][axis];
  }
  p.normal_size = size(p.normal[0]) + size(p.normal[1]) + size(p.normal[2]);
  p.low = least(Wide{}, least(shadow[0], shadow[1]));
  p.high = most(Wide{}, most(shadow[0], shadow[1]));
  return p;
}

// Normals and shadows on them of sixteen triangles, for one lane at a time.
struct Shadows {
  alignas(64) float normal[3][kLanes], normal_size[kLanes], low[kLanes], high[kLanes];
};
inline Shadows shadows_of(const Faces& faces) {
  const Planes p = planes_of(faces);
  Shadows s;
  const auto store = [](const Wide& value, float* to) { *reinterpret_cast<Wide*>(to) = value; };
  for (int axis = 0; axis < 3; ++axis) store(p.normal[axis], s.normal[axis]);
  store(p.normal_size, s.normal_size);
  store(p.low, s.low);
  store(p.high, s.high);
  return s;
}

inline std::uint32_t not_parted(const Planes& planes, const Faces& others, const Shadows& shadows, int lane,
                                float apart) {
  Wide span{}, shadow[3], back[3];
  for (int k = 0; k < 3; ++k) {
    shadow[k] = back[k] = Wide{};
    for (int axis = 0; axis < 3; ++axis) {
      const Wide d = others.corner[k][axis][lane] - planes.corner[0][axis],
                 o = planes.corner[k][axis] - others.corner[0][axis][lane];
      shadow[k] += planes.normal[axis] * d;
      back[k] += shadows.normal[axis][lane] * o;
      span = most(span, most(size(d), size(o)));
    }
  }
  const Wide keep = apart + kShadowRounding * span, by_face = planes.normal_size * keep + kShadowUnderflow,
             by_other = shadows.normal_size[lane] * keep + kShadowUnderflow;
  const auto lowest = [](const Wide(&s)[3]) { return least(s[0], least(s[1], s[2])); };
  const auto highest = [](const Wide(&s)[3]) { return most(s[0], most(s[1], s[2])); };
  const Wide on_face = most(lowest(shadow) - planes.high, planes.low - highest(shadow)),
             on_other = most(lowest(back) - shadows.high[lane], shadows.low[lane] - highest(back));
  return bits_of(most(on_face - by_face, on_other - by_other) <= Wide{});
}

int close_lanes(const Packet& a, const Packet& b, float apart, LanePair* pairs) {
  const Planes planes = planes_of(*a.faces);
  const Shadows shadows = shadows_of(*b.faces);
  int count = 0;
  for (std::uint32_t left = b.lanes; left != 0; left &= left - 1) {
    const int lane = __builtin_ctz(left);
    std::uint32_t near = overlaps(*a.boxes, lane_of(*b.boxes, lane)) & a.lanes;
    if (near != 0) near &= not_parted(planes, *b.faces, shadows, lane, apart);
    for (; near != 0; near &= near - 1)
      pairs[count++] = {static_cast<std::uint8_t>(__builtin_ctz(near)), static_cast<std::uint8_t>(lane)};
  }
  return count;
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
