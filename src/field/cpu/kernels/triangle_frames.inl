// SPDX-License-Identifier: Apache-2.0
// The common part of the field's kernels: it loads sixteen triangles at a time from the mesh and sets them up as frames
// (geometry/triangle_frame.h).
//
// Kernels may call only always-inlined functions of other folders, and nothing of the standard library: the linker may
// share a function compiled for AVX-512 with the rest of the program, which would crash older processors
// (script/check_weak_symbols).
#pragma once

#include "field/cpu/kernels.h"
#include "field/tolerances.h"
#include "geometry/triangle_frame.h"
#include "simd/points.inl"

namespace standoff::cpu::STANDOFF_TARGET {

using namespace standoff::STANDOFF_TARGET;

static_assert(kLanes == WideFloat::kLanes);

namespace {

STANDOFF_INLINE const WideFloat& component(const WidePoint& p, int axis) {
  return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

// Sixteen triangles, corners relative to the brick's centre in grid units.
struct Group {
  WidePoint corner[3];
  alignas(64) std::uint32_t index[kLanes];
};

// The corners of the triangles refs[first], refs[first + 1], ..., corner by corner and lane by lane.
using CornerRows = float[3][kLanes][4];
template <bool kPacked>
STANDOFF_INLINE void load_corners(const BlockLattice& lattice, const Brick& brick, const Candidates& c,
                                  std::int64_t first, CornerRows& rows, Group& group) {
  for (int lane = 0; lane < kLanes; ++lane) {
    const std::int64_t n = first + lane < c.count ? first + lane : c.count - 1;
    const std::uint32_t index = c.refs[n];
    group.index[lane] = index;
    for (int which = 0; which < 3; ++which) {
      double room[3];
      store_local(rows[which][lane], corner_of<kPacked>(c.mesh, index, which, room), lattice.scale, brick.center);
    }
  }
}

// Loads the triangles refs[first], refs[first + 1], ... Lanes past the end repeat the last one, which changes nothing.
STANDOFF_INLINE void load_group(const BlockLattice& lattice, const Brick& brick, const Candidates& c,
                                std::int64_t first, Group& group) {
  alignas(64) CornerRows rows;
  if (c.mesh.packed)
    load_corners<true>(lattice, brick, c, first, rows, group);
  else
    load_corners<false>(lattice, brick, c, first, rows, group);
  for (int which = 0; which < 3; ++which)
    group.corner[which] = {load_column(rows[which], 0), load_column(rows[which], 1), load_column(rows[which], 2)};
}

// The specks among the triangles (lattice.h) shrink to the middle of their boxes. Returns them.
STANDOFF_INLINE Mask shrink_specks(const BlockLattice& lattice, Group& group) {
  const BoxOf<WideFloat> box = box_of(group.corner[0], group.corner[1], group.corner[2]);
  const Mask specks = is_speck(lattice, box);
  if (specks.to_bits() == 0) return specks;
  for (WidePoint& corner : group.corner) corner = select(specks, middle_of(box), corner);
  return specks;
}

STANDOFF_INLINE TriangleFrame<WideFloat> make_frames(const Group& group) {
  return make_frame(group.corner[0], group.corner[1], group.corner[2], WideFloat(kLeastLengthSq));
}

// Bits of the triangles that are to be measured by lines.
STANDOFF_INLINE std::uint32_t long_lanes(const Group& group) {
  return is_long(box_of(group.corner[0], group.corner[1], group.corner[2])).to_bits();
}

// Store frames to lanes and load them, number by number.
STANDOFF_INLINE void store_line(const Linear<WideFloat>& line, FrameLanes::Line& to) {
  line.g.x.store(to.gx);
  line.g.y.store(to.gy);
  line.g.z.store(to.gz);
  line.c.store(to.c);
}
STANDOFF_INLINE void store_half(const HalfTriangle<WideFloat>& half, FrameLanes::Half& to) {
  half.leg.store(to.leg);
  half.length.store(to.length);
  half.nx.store(to.nx);
  half.ny.store(to.ny);
}
STANDOFF_INLINE void store_frames(const TriangleFrame<WideFloat>& f, FrameLanes& to) {
  store_line(f.q, to.q);
  store_line(f.y, to.y);
  store_line(f.z, to.z);
  store_half(f.left, to.left);
  store_half(f.right, to.right);
}

template <class F, class Read>
STANDOFF_INLINE Linear<F> read_line(const FrameLanes::Line& line, Read read) {
  return {{read(line.gx), read(line.gy), read(line.gz)}, read(line.c)};
}
template <class F, class Read>
STANDOFF_INLINE HalfTriangle<F> read_half(const FrameLanes::Half& half, Read read) {
  return {read(half.leg), read(half.length), read(half.nx), read(half.ny)};
}
// The frame whose numbers `read` loads from sixteen lanes.
template <class F, class Read>
STANDOFF_INLINE TriangleFrame<F> read_frame(const FrameLanes& from, Read read) {
  return {read_line<F>(from.q, read), read_line<F>(from.y, read), read_line<F>(from.z, read),
          read_half<F>(from.left, read), read_half<F>(from.right, read)};
}

// The frames of all lanes.
STANDOFF_INLINE TriangleFrame<WideFloat> load_frames(const FrameLanes& from) {
  return read_frame<WideFloat>(
      from, [](const float(&lanes)[kLanes]) __attribute__((always_inline)) { return WideFloat::load(lanes); });
}
// One triangle's frame, in all lanes if F is wide.
template <class F>
STANDOFF_INLINE TriangleFrame<F> frame_of_lane(const FrameLanes& from, std::uint32_t lane) {
  return read_frame<F>(
      from, [&](const float(&lanes)[kLanes]) __attribute__((always_inline)) { return F(lanes[lane]); });
}

// The frame of a long triangle, in double.
STANDOFF_INLINE TriangleFrame<double> double_frame(const BlockLattice& lattice, const Brick& brick, const Candidates& c,
                                                   std::uint32_t index) {
  const Triple<double> center{brick.center[0], brick.center[1], brick.center[2]};
  Triple<double> corner[3];
  for (int which = 0; which < 3; ++which) {
    double room[3];
    const double* v = corner_of<false>(c.mesh, index, which, room);
    corner[which] = local(lattice, {v[0], v[1], v[2]}, center);
  }
  return make_frame(corner[0], corner[1], corner[2], double{kLeastLengthSq});
}

// A triangle's lines in all lanes.
STANDOFF_INLINE Linear<WideFloat> in_all_lanes(const Linear<float>& f) {
  return {{WideFloat(f.g.x), WideFloat(f.g.y), WideFloat(f.g.z)}, WideFloat(f.c)};
}
STANDOFF_INLINE HalfLines<WideFloat> in_all_lanes(const HalfLines<float>& half) {
  return {in_all_lanes(half.past), in_all_lanes(half.across), in_all_lanes(half.along), WideFloat(half.along_apex)};
}
STANDOFF_INLINE TriangleLines<WideFloat> in_all_lanes(const TriangleLines<float>& t) {
  return {in_all_lanes(t.q), in_all_lanes(t.y), in_all_lanes(t.z), in_all_lanes(t.left), in_all_lanes(t.right)};
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
