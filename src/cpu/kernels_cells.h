// The kernels for thick bands and full fields, where each sample has many candidates and needs few. Included like
// kernels_body.h, after it.
//
// Culling. With the cell's centre as origin, its half extents h and a point q of the surface, a candidate whose box
// holds p can be nearer than q to the sample x only if |x-p|^2 < |x-q|^2, that is |p|^2 - |q|^2 < 2 x.(p-q). The right
// side is at most 2 sum h_a |p_a - q_a| over the cell, so the candidate is out when
//     sum over axes a of min over p_a in its box of (p_a^2 - 2 h_a |p_a - q_a|)  >=  |q|^2.
// The axes part. On one axis -|d| is the smaller of -d and d, and each of the two parabolas has its least value where
// p_a = +-h_a, clamped to the box. Far from a flat sheet this leaves a patch a few cells wide; distance alone, a disc
// that grows with the distance.

// The least of p^2 - 2h|p - q| over low <= p <= high.
DIFI_INLINE WideFloat least_on_axis(const WideFloat& low, const WideFloat& high, float h, float q) {
  const WideFloat plus(h), minus(-h), twice(2 * h), shift(2 * h * q);
  const WideFloat a = min(max(plus, low), high), b = min(max(minus, low), high);
  const WideFloat on_a = fma(a, a, shift - twice * a), on_b = fma(b, b, twice * b - shift);
  return min(on_a, on_b);
}

// Which boxes, relative to the cell's centre, can hold a point nearer to some sample than q is.
DIFI_INLINE Mask may_beat(const WidePoint& low, const WidePoint& high, const float* half, const float* q) {
  const float q_sq = q[0] * q[0] + q[1] * q[1] + q[2] * q[2];
  const float half_sq = half[0] * half[0] + half[1] * half[1] + half[2] * half[2];
  // A margin for the rounding of the terms, which are of the order of the squares on the right.
  const float limit = q_sq + 2e-5f * (q_sq + half_sq);
  const WideFloat sum = least_on_axis(low.x, high.x, half[0], q[0]) + least_on_axis(low.y, high.y, half[1], q[1]) +
                        least_on_axis(low.z, high.z, half[2], q[2]);
  return less(sum, WideFloat(limit));
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

std::int64_t cull_boxes(const BoxArrays& boxes, const CullCell& cell, const float* point) {
  const float q[3] = {point[0] - cell.center[0], point[1] - cell.center[1], point[2] - cell.center[2]};
  const WideFloat reach_sq(cell.reach * cell.reach * (1 + kSlack) + kSlack * kSlack);
  std::int64_t kept = 0;
  for (std::int64_t first = 0; first < boxes.count; first += kLanes) {
    const int used = boxes.count - first < kLanes ? static_cast<int>(boxes.count - first) : kLanes;
    const auto load = [&](float* const* side) __attribute__((always_inline)) {
      return WidePoint{load_some(side[0] + first, used), load_some(side[1] + first, used),
                       load_some(side[2] + first, used)};
    };
    const WidePoint low = load(boxes.low), high = load(boxes.high);
    const WidePoint center{WideFloat(cell.center[0]), WideFloat(cell.center[1]), WideFloat(cell.center[2])};
    const Mask near = may_beat(low - center, high - center, cell.half, q) &
                      ~less(reach_sq, gap_sq(low - center, high - center, cell.half));
    const Mask keep = near & mask_from_bits((1u << used) - 1);
    // Packed in place: what is written lies before what is still to be read, or in the room past the end.
    const WideFloat* const sides[6] = {&low.x, &low.y, &low.z, &high.x, &high.y, &high.z};
    for (int axis = 0; axis < 3; ++axis) {
      store_packed(boxes.low[axis] + kept, keep, *sides[axis]);
      store_packed(boxes.high[axis] + kept, keep, *sides[3 + axis]);
    }
    kept += store_packed(boxes.entry + kept, keep, WideUint::load(boxes.entry + first));
  }
  return kept;
}

DIFI_INLINE TriangleFrame<WideFloat> frames_of(const CandidateTable::Group& g) {
  const auto number = [&](int n) __attribute__((always_inline)) { return WideFloat::load(g.frame[n]); };
  return {{{number(0), number(1), number(2)}, number(3)},
          {{number(4), number(5), number(6)}, number(7)},
          {{number(8), number(9), number(10)}, number(11)},
          {number(12), number(13), number(14), number(15)},
          {number(16), number(17), number(18), number(19)}};
}

// One candidate's frame, in all lanes when F is wide.
template <class F>
DIFI_INLINE TriangleFrame<F> one_frame(const CandidateTable::Group& g, std::uint32_t lane) {
  const auto number = [&](int n) __attribute__((always_inline)) { return F(g.one_frame[lane][n]); };
  return {{{number(0), number(1), number(2)}, number(3)},
          {{number(4), number(5), number(6)}, number(7)},
          {{number(8), number(9), number(10)}, number(11)},
          {number(12), number(13), number(14), number(15)},
          {number(16), number(17), number(18), number(19)}};
}

// Sets up the candidates first, first + 1, ... as far as there is room; returns how many groups they are.
DIFI_INLINE int fill_table(const Lattice& lattice, const Brick& brick, const Candidates& c, std::int64_t first,
                           CandidateTable& table) {
  int groups = 0;
  for (; groups < CandidateTable::kGroups && first < c.count; ++groups, first += kLanes) {
    CandidateTable::Group& g = table.groups[groups];
    Group loaded;
    load_group(lattice, brick, c, first, loaded);
    WideFloat longest(0), farthest(0);
    for (int axis = 0; axis < 3; ++axis) {
      const WideFloat a = component(loaded.corner[0], axis), b = component(loaded.corner[1], axis),
                      d = component(loaded.corner[2], axis);
      const WideFloat low = min(a, min(b, d)), high = max(a, max(b, d));
      longest = max(longest, high - low);
      farthest = max(farthest, max(abs(low), abs(high)));
      low.store(g.low[axis]);
      high.store(g.high[axis]);
    }
    fma(farthest, WideFloat(4e-6f), WideFloat(kSlack)).store(g.slack);
    g.is_long = less(WideFloat(kLongTriangle), longest).to_bits();
    store_frames(make_frame(loaded.corner[0], loaded.corner[1], loaded.corner[2], WideFloat(kLeastLengthSq)), g.frame);
    for (int lane = 0; lane < kLanes; ++lane)
      for (int number = 0; number < CandidateTable::kFrameNumbers; ++number)
        g.one_frame[lane][number] = g.frame[number][lane];
    for (int lane = 0; lane < kLanes; ++lane) g.index[lane] = loaded.index[lane];
    const std::int64_t left = c.count - first;
    table.all[groups] = {static_cast<std::uint16_t>(groups),
                         static_cast<std::uint16_t>(left < kLanes ? (1u << left) - 1 : 0xffffu)};
  }
  return groups;
}

// A box of samples of the brick: centre relative to the brick's, half extents and half diagonal.
struct SampleBox {
  float center[3], half[3], radius;
};

// Copies to `out` the candidates that may be nearest to a sample of the box, and returns how many groups have some.
// `best_before` is what the box's samples are known to be within.
int cull_table(const Lattice& lattice, CandidateTable& table, const CandidateTable::Active* in, int count,
               const SampleBox& box, CandidateTable::Active* out) {
  const WidePoint center{WideFloat(box.center[0]), WideFloat(box.center[1]), WideFloat(box.center[2])};
  const WideFloat infinity(__builtin_inff());
  WideFloat least = infinity;
  for (int n = 0; n < count; ++n) {
    const CandidateTable::Group& g = table.groups[in[n].group];
    const WideFloat distance = sqrt(distance_sq(frames_of(g), center));
    distance.store(table.distance[n]);
    least = min(select(mask_from_bits(in[n].lanes), distance + WideFloat::load(g.slack), infinity), least);
  }
  const float best = reduce_min(least);
  // The nearest candidate, the first of equals: its closest point is a point of the surface to compare all with.
  float q[3] = {0, 0, 0};
  bool found = false;
  for (int n = 0; n < count && !found; ++n) {
    const CandidateTable::Group& g = table.groups[in[n].group];
    const std::uint32_t here =
        equal(WideFloat::load(table.distance[n]) + WideFloat::load(g.slack), WideFloat(best)).to_bits() & in[n].lanes;
    if (here == 0) continue;
    const Triple<float> p = closest_in_frame(one_frame<float>(g, static_cast<std::uint32_t>(__builtin_ctz(here))),
                                             Triple<float>{box.center[0], box.center[1], box.center[2]});
    q[0] = p.x;
    q[1] = p.y;
    q[2] = p.z;
    found = true;
  }
  const float by_best = best + 2 * box.radius * (1 + kSlack), by_reach = lattice.thickness * (1 + kSlack) + box.radius;
  const WideFloat limit(difi::min(by_best, by_reach));
  const float exact_best = best * (1 + 1e-5f);
  const WideFloat bisector(exact_best * exact_best);
  int kept = 0;
  for (int n = 0; n < count; ++n) {
    const CandidateTable::Group& g = table.groups[in[n].group];
    const Mask near = ~less(limit, WideFloat::load(table.distance[n]) - WideFloat::load(g.slack));
    // |p| is at least the distance, and |p_a - q_a| at most that of the box's farther face.
    WideFloat spread(0);
    for (int axis = 0; axis < 3; ++axis) {
      const WideFloat at(q[axis]), half(2 * box.half[axis]);
      spread = fma(max(WideFloat::load(g.high[axis]) - at, at - WideFloat::load(g.low[axis])), half, spread);
    }
    const WideFloat nearest = max(WideFloat::load(table.distance[n]) - WideFloat::load(g.slack), WideFloat(0));
    const std::uint32_t lanes = (near & less(fma(nearest, nearest, -spread), bisector)).to_bits() & in[n].lanes;
    out[kept] = {in[n].group, static_cast<std::uint16_t>(lanes)};
    kept += lanes != 0;
  }
  return kept;
}

// Cells of 4x4x4 samples: one block wide, kCellBlocks high and deep.
constexpr int kCellSide = 4, kCellBlocks = 2;
static_assert(kCellSide == kBlockX && kCellSide == kCellBlocks * kBlockY && kCellSide == kCellBlocks * kBlockZ);
// With more candidates than this a cell's blocks choose among them once more, each for itself.
constexpr int kManyCandidates = 32;

// Writes down the active candidates one by one, so that the loop over them has no branch to mispredict.
DIFI_INLINE int listed(CandidateTable& table, const CandidateTable::Active* active, int count) {
  int candidates = 0;
  for (int n = 0; n < count; ++n) {
    const WideUint first(static_cast<std::uint32_t>(active[n].group) * kLanes);
    candidates += store_packed(table.list + candidates, mask_from_bits(active[n].lanes), first + lane_numbers());
  }
  return candidates;
}

// The listed candidates against one block.
template <bool kNearest>
DIFI_INLINE void gather_block(const Lattice& lattice, const Brick& brick, const Candidates& c,
                              const CandidateTable& table, int candidates, int block, BrickState& state) {
  const WidePoint samples = block_samples(lattice, block);
  WideFloat best = WideFloat::load(state.distance_sq[block]);
  WideUint nearest(0);
  if constexpr (kNearest) nearest = WideUint::load(state.nearest[block]);
  for (int n = 0; n < candidates; ++n) {
    const CandidateTable::Group& g = table.groups[table.list[n] / kLanes];
    const std::uint32_t lane = table.list[n] % kLanes;
    WideFloat d;
    if (g.is_long >> lane & 1)
      d = distance_sq(make_lines<WideFloat>(double_frame(lattice, brick, c, g.index[lane])), samples);
    else
      d = distance_sq(one_frame<WideFloat>(g, lane), samples);
    if constexpr (kNearest) {
      const WideUint mine(g.index[lane]);
      nearest = select(less(d, best) | (equal(d, best) & less(mine, nearest)), mine, nearest);
    }
    best = min(d, best);
  }
  best.store(state.distance_sq[block]);
  if constexpr (kNearest) nearest.store(state.nearest[block]);
  state.samples_examined += std::int64_t{kLanes} * candidates;
}

// The samples [first, first + side) per axis of a brick.
DIFI_INLINE SampleBox sample_box(const Lattice& lattice, const int (&first)[3], const int (&side)[3]) {
  SampleBox box;
  float radius_sq = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float spacing = static_cast<float>(lattice.spacing[axis] * lattice.scale);
    box.center[axis] = (static_cast<float>(first[axis]) + static_cast<float>(side[axis] - kBrickSide) / 2) * spacing;
    box.half[axis] = static_cast<float>(side[axis] - 1) / 2 * spacing * (1 + kSlack);
    radius_sq += box.half[axis] * box.half[axis];
  }
  box.radius = difi::sqrt(radius_sq);
  return box;
}

// One cell, from the candidates of its tile.
template <bool kNearest>
void gather_cell(const Lattice& lattice, const Brick& brick, const Candidates& c, CandidateTable& table, int in_tile,
                 const int (&at)[3], BrickState& state) {
  const int in_cell = cull_table(lattice, table, table.of_tile, in_tile,
                                 sample_box(lattice, at, {kCellSide, kCellSide, kCellSide}), table.of_cell);
  int candidates = listed(table, table.of_cell, in_cell);
  const int bx = at[0] / kBlockX, by = at[1] / kBlockY, bz = at[2] / kBlockZ;
  const bool many = candidates > kManyCandidates;
  for (int n = 0; n < kCellBlocks * kCellBlocks; ++n) {
    const int y = n % kCellBlocks, z = n / kCellBlocks;
    if (many) {
      const int corner[3] = {at[0], at[1] + y * kBlockY, at[2] + z * kBlockZ};
      const int in_block = cull_table(lattice, table, table.of_cell, in_cell,
                                      sample_box(lattice, corner, {kBlockX, kBlockY, kBlockZ}), table.of_block);
      candidates = listed(table, table.of_block, in_block);
    }
    gather_block<kNearest>(lattice, brick, c, table, candidates, block_index(bx, by + y, bz + z), state);
  }
}

template <bool kNearest>
void gather_cells(const Lattice& lattice, const Brick& brick, const Candidates& c, CandidateTable& table,
                  BrickState& state) {
  constexpr int tile_side = DistanceField::kTileSide, cells = tile_side / kCellSide;
  const int size[3] = {inside(lattice, brick, 0), inside(lattice, brick, 1), inside(lattice, brick, 2)};
  for (std::int64_t first = 0; first < c.count; first += std::int64_t{CandidateTable::kGroups} * kLanes) {
    const int groups = fill_table(lattice, brick, c, first, table);
    for (int tile = 0; tile < kBrickTiles; ++tile) {
      const int corner[3] = {(tile & 1) * tile_side, (tile >> 1 & 1) * tile_side, (tile >> 2) * tile_side};
      if (corner[0] >= size[0] || corner[1] >= size[1] || corner[2] >= size[2]) continue;
      const int in_tile = cull_table(lattice, table, table.all, groups,
                                     sample_box(lattice, corner, {tile_side, tile_side, tile_side}), table.of_tile);
      if (in_tile == 0) continue;
      for (int cell = 0; cell < cells * cells * cells; ++cell) {
        const int at[3] = {corner[0] + (cell & 1) * kCellSide, corner[1] + (cell >> 1 & 1) * kCellSide,
                           corner[2] + (cell >> 2) * kCellSide};
        if (at[0] >= size[0] || at[1] >= size[1] || at[2] >= size[2]) continue;
        gather_cell<kNearest>(lattice, brick, c, table, in_tile, at, state);
      }
    }
  }
}

void gather_cells_any(const Lattice& lattice, const Brick& brick, const Candidates& c, bool with_nearest,
                      CandidateTable& table, BrickState& state) {
  if (with_nearest)
    gather_cells<true>(lattice, brick, c, table, state);
  else
    gather_cells<false>(lattice, brick, c, table, state);
}
