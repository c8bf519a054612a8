// Which of a cell's candidates its blocks have to look at. Included like kernels_body.h, after kernels_candidates.h.
//
// Between the corners of a cell many candidates may be nearest to some point, but there are few samples. Each candidate
// holds a point, so none of the samples is farther from the surface than from that; and a candidate is out for a block
// when its box is farther from each of the block's samples.

// Lists the chosen candidates, one by one, so that the loop over them has no branch to mispredict.
DIFI_INLINE void list_chosen(CandidateTable& table) {
  table.list.count = 0;
  for (int n = 0; n < table.active_groups; ++n) {
    const CandidateTable::Active& active = table.active[n];
    const Mask lanes = mask_from_bits(active.lanes);
    const WideUint first(static_cast<std::uint32_t>(active.group) * kLanes);
    table.list.count += store_packed(table.list.candidate + table.list.count, lanes, first + lane_numbers());
  }
}

// The same for their extents. What fills up the last register lies far from everything.
DIFI_INLINE void list_extents(CandidateTable& table) {
  constexpr float kFarAway = 0x1p60f;
  int count = 0;
  for (int n = 0; n < table.active_groups; ++n) {
    const CandidateTable::Active& active = table.active[n];
    const Mask lanes = mask_from_bits(active.lanes);
    for (int k = 0; k < CandidateTable::kExtentNumbers; ++k)
      store_packed(table.listed_extent[k] + count, lanes, WideFloat::load(table.groups[active.group].extent[k]));
    count += __builtin_popcount(active.lanes);
  }
  for (float* const numbers : table.listed_extent) WideFloat(kFarAway).store(numbers + count);
}

// What is known of the distances of a cell's samples before candidates are measured.
struct Known {
  WideFloat distance_sq[kCellBlocks * kCellBlocks];  // of each block, at most
  float lowered_by;                                  // what squared distances from boxes are lowered by
};

// No sample is farther from the surface than from a point of each candidate, or from the references.
DIFI_INLINE Known known_distances(const Lattice& lattice, const CandidateTable& table, const CellCorners& cell, int bx,
                                  int by, int bz, const BrickState& state) {
  const WideFloat x = WideFloat::load(lattice.x[bx]);
  WideFloat y[kCellBlocks], z[kCellBlocks], least[kCellBlocks * kCellBlocks];
  for (int n = 0; n < kCellBlocks; ++n) {
    y[n] = WideFloat::load(lattice.y[by + n]);
    z[n] = WideFloat::load(lattice.z[bz + n]);
  }
  for (WideFloat& l : least) l = WideFloat(__builtin_inff());
  const auto look_at = [&](const float& px, const float& py, const float& pz) __attribute__((always_inline)) {
    const WideFloat dx = x - WideFloat(px), dx_sq = dx * dx;
    for (int k = 0; k < kCellBlocks; ++k) {
      const WideFloat dz = z[k] - WideFloat(pz), dxz_sq = fma(dz, dz, dx_sq);
      for (int j = 0; j < kCellBlocks; ++j) {
        const WideFloat dy = y[j] - WideFloat(py);
        least[j + kCellBlocks * k] = min(least[j + kCellBlocks * k], fma(dy, dy, dxz_sq));
      }
    }
  };
  for (int n = 0; n < table.list.count; ++n)
    look_at(table.listed_extent[6][n], table.listed_extent[7][n], table.listed_extent[8][n]);
  for (const CandidateTable::Corner* reference : cell.reference)
    look_at(reference->point[0], reference->point[1], reference->point[2]);

  WideFloat slack(0);
  for (int n = 0; n < table.active_groups; ++n)
    slack = max(slack, WideFloat::load(table.groups[table.active[n].group].slack));
  for (const CandidateTable::Corner* reference : cell.reference) slack = max(slack, WideFloat(reference->slack));
  const float slack_sq = reduce_max(slack * slack);
  Known known;
  known.lowered_by = slack_sq / kSlackShare;
  // The surface passes within the slack of the points: (d+s)^2 <= d^2 (1+a) + s^2 (1+1/a).
  const WideFloat added(slack_sq * (1 + 1 / kSlackShare));
  const float within = lattice.thickness * (1 + kSlack);
  for (int n = 0; n < kCellBlocks * kCellBlocks; ++n) {
    const int block = block_index(bx, by + n % kCellBlocks, bz + n / kCellBlocks);
    const WideFloat before = min(WideFloat(within * within), WideFloat::load(state.distance_sq[block]));
    known.distance_sq[n] = min(before, fma(least[n], WideFloat(1 + kSlackShare), added));
  }
  return known;
}

// Lists for each block of the cell the candidates whose boxes are no farther from some sample than is known of it:
// sixteen candidates at a time, and all samples, whose squared distances from a box are sums of three numbers of which
// there are four for each axis.
DIFI_INLINE void choose_for_blocks(const Lattice& lattice, CandidateTable& table, const CellCorners& cell, int bx,
                                   int by, int bz, const BrickState& state) {
  list_extents(table);
  const Known known = known_distances(lattice, table, cell, bx, by, bz, state);
  // A box is out when gap^2 (1-a) - lowered > known, and 1/(1-a) < 1 + 2a.
  alignas(64) float limit[kCellBlocks * kCellBlocks][kLanes];
  for (int n = 0; n < kCellBlocks * kCellBlocks; ++n) {
    ((known.distance_sq[n] + WideFloat(known.lowered_by)) * WideFloat(1 + 2 * kSlackShare)).store(limit[n]);
    table.block_list[n].count = 0;
  }
  for (int first = 0; first < table.list.count; first += kLanes) {
    WideFloat gap_sq[3][kCellSide];
    for (int axis = 0; axis < 3; ++axis) {
      const WideFloat low = WideFloat::load(table.listed_extent[axis] + first),
                      high = WideFloat::load(table.listed_extent[3 + axis] + first);
      for (int n = 0; n < kCellSide; ++n) {
        const float at = axis == 0   ? lattice.x[bx][n]
                         : axis == 1 ? lattice.y[by + n / kBlockY][n % kBlockY * kBlockX]
                                     : lattice.z[bz + n / kBlockZ][n % kBlockZ * kBlockX * kBlockY];
        const WideFloat gap = max(max(low - WideFloat(at), WideFloat(at) - high), WideFloat(0));
        gap_sq[axis][n] = gap * gap;
      }
    }
    const WideUint candidates = WideUint::load(table.list.candidate + first);
    const int left = table.list.count - first;
    const Mask used = mask_from_bits(left < kLanes ? (1u << left) - 1 : 0xffffu);
    for (int block = 0; block < kCellBlocks * kCellBlocks; ++block) {
      WideFloat beyond(__builtin_inff());  // by how much the farthest limit is missed
      for (int row = 0; row < kBlockY * kBlockZ; ++row) {
        const WideFloat yz = gap_sq[1][block % kCellBlocks * kBlockY + row % kBlockY] +
                             gap_sq[2][block / kCellBlocks * kBlockZ + row / kBlockY];
        for (int i = 0; i < kBlockX; ++i)
          beyond = min(beyond, (gap_sq[0][i] + yz) - WideFloat(limit[block][row * kBlockX + i]));
      }
      CandidateTable::List& list = table.block_list[block];
      list.count += store_packed(list.candidate + list.count, ~less(WideFloat(0), beyond) & used, candidates);
    }
  }
}
