// The kernels that drop boxes of triangles. Included like kernels_body.h, after it.
//
// With the cell's centre as origin, its half extents h and a point q of the surface, a box that holds the nearest point
// p of some sample x must have |x-p|^2 < |x-q|^2, that is |p|^2 - |q|^2 < 2 x.(p-q). The right side is at most
// 2 sum h_a |p_a - q_a| over the cell, so the box is out when
//     sum over axes a of min over p_a in the box of (p_a^2 - 2 h_a |p_a - q_a|)  >=  |q|^2.
// The axes part. On one axis -|d| is the smaller of -d and d, and the two parabolas p^2 - 2hp + 2hq and p^2 + 2hp - 2hq
// have their least values at p = h and p = -h, clamped to the box: but for +-2hq these do not depend on q, so many
// points q cost little more than one. Far from a flat sheet, with q nearest to the cell's corners, this leaves the
// patch under the cell; comparing distances leaves a disc that grows with the distance.

// The least values of p^2 - 2hp and of p^2 + 2hp over low <= p <= high.
struct LeastOnAxis {
  WideFloat plus, minus;
};
DIFI_INLINE LeastOnAxis least_on_axis(const WideFloat& low, const WideFloat& high, float half) {
  const WideFloat h(half), twice(2 * half);
  const WideFloat a = min(max(h, low), high), b = min(max(-h, low), high);
  return {a * (a - twice), b * (b + twice)};
}

// A reference as the test needs it: 2 h_a q_a, and |q|^2 with a margin for the rounding of the sum it is compared with.
struct CullReference {
  float shift[3];
  float limit;
};

// Which boxes, relative to the cell's centre, can hold a point nearer to some sample than every reference is.
DIFI_INLINE Mask may_beat(const WidePoint& low, const WidePoint& high, const float* half,
                          const CullReference* references, int count, Mask among) {
  const LeastOnAxis x = least_on_axis(low.x, high.x, half[0]), y = least_on_axis(low.y, high.y, half[1]),
                    z = least_on_axis(low.z, high.z, half[2]);
  for (int n = 0; n < count && among.to_bits() != 0; ++n) {
    const CullReference& r = references[n];
    const WideFloat sx(r.shift[0]), sy(r.shift[1]), sz(r.shift[2]);
    const WideFloat sum =
        min(x.plus + sx, x.minus - sx) + min(y.plus + sy, y.minus - sy) + min(z.plus + sz, z.minus - sz);
    among = among & ~less(WideFloat(r.limit), sum);
  }
  return among;
}

// The squared distance from the cell's samples to boxes relative to its centre, at least.
DIFI_INLINE WideFloat gap_sq(const WidePoint& low, const WidePoint& high, const float* half) {
  const WideFloat zero(0);
  const auto gap = [&](const WideFloat& l, const WideFloat& h, float extent) __attribute__((always_inline)) {
    return max(max(l - WideFloat(extent), -h - WideFloat(extent)), zero);
  };
  const WideFloat x = gap(low.x, high.x, half[0]), y = gap(low.y, high.y, half[1]), z = gap(low.z, high.z, half[2]);
  return fma(x, x, fma(y, y, z * z));
}

std::int64_t nearest_box(const BoxArrays& boxes, const float* point) {
  float least = __builtin_inff();
  std::int64_t best = 0;
  for (std::int64_t first = 0; first < boxes.count; first += kLanes) {
    const int used = boxes.count - first < kLanes ? static_cast<int>(boxes.count - first) : kLanes;
    WideFloat distance_sq(0);
    for (int axis = 0; axis < 3; ++axis) {
      const WideFloat twice_off = load_some(boxes.low[axis] + first, used) + load_some(boxes.high[axis] + first, used) -
                                  WideFloat(2 * point[axis]);
      distance_sq = fma(twice_off, twice_off, distance_sq);
    }
    const std::uint32_t valid = (1u << used) - 1;
    if ((less(distance_sq, WideFloat(least)).to_bits() & valid) == 0) continue;
    alignas(64) float all[kLanes];
    distance_sq.store(all);
    for (int lane = 0; lane < used; ++lane)
      if (all[lane] < least) {
        least = all[lane];
        best = first + lane;
      }
  }
  return best;
}

void cull_boxes(const BoxArrays& boxes, const CullCell& cell, const References& references, BoxArrays& result) {
  CullReference prepared[References::kMost];
  const float half_sq = cell.half[0] * cell.half[0] + cell.half[1] * cell.half[1] + cell.half[2] * cell.half[2];
  for (int n = 0; n < references.count; ++n) {
    float q_sq = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float q = references.at[n][axis] - cell.center[axis];
      prepared[n].shift[axis] = 2 * cell.half[axis] * q;
      q_sq += q * q;
    }
    prepared[n].limit = q_sq + 2e-5f * (q_sq + half_sq);
  }
  const WideFloat reach_sq(cell.reach * cell.reach * (1 + kSlack) + kSlack * kSlack);
  const WidePoint center{WideFloat(cell.center[0]), WideFloat(cell.center[1]), WideFloat(cell.center[2])};
  const std::int64_t count = boxes.count;
  std::int64_t kept = 0;
  for (std::int64_t first = 0; first < count; first += kLanes) {
    const int used = count - first < kLanes ? static_cast<int>(count - first) : kLanes;
    const auto load = [&](float* const* side) __attribute__((always_inline)) {
      return WidePoint{load_some(side[0] + first, used), load_some(side[1] + first, used),
                       load_some(side[2] + first, used)};
    };
    const WidePoint low = load(boxes.low), high = load(boxes.high);
    const Mask in_reach =
        ~less(reach_sq, gap_sq(low - center, high - center, cell.half)) & mask_from_bits((1u << used) - 1);
    const Mask keep = may_beat(low - center, high - center, cell.half, prepared, references.count, in_reach);
    if (keep.to_bits() == 0) continue;
    // Packed: in place, what is written lies before what is still to be read, or in the room past the end.
    const WideFloat* const sides[6] = {&low.x, &low.y, &low.z, &high.x, &high.y, &high.z};
    for (int axis = 0; axis < 3; ++axis) {
      store_packed(result.low[axis] + kept, keep, *sides[axis]);
      store_packed(result.high[axis] + kept, keep, *sides[3 + axis]);
    }
    kept += store_packed(result.entry + kept, keep, WideUint::load(boxes.entry + first));
  }
  result.count = kept;
}
