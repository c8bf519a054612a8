// SPDX-License-Identifier: Apache-2.0
// The kernel that makes sidecars of the nearest triangles of a tile, eight samples at once, in double: first as if all
// were over the inside of their triangles, then by regions, and at last, with more care, where that says nothing.
#pragma once

#include "geometry/closest_part.h"
#include "sidecars/cpu/kernels/sample_groups.inl"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

// The outputs of eight samples but for the gradient. A part has a point, weights and a feature, `at` is where they are.
template <class Part>
STANDOFF_INLINE void store_part(const Part& part, const DoublePoint& at, const SidecarMesh& mesh,
                                const SidecarTile& tile, const std::uint32_t* samples) {
  if (tile.closest_point) store_triples((at + part.point) * WideDouble(mesh.unscale), samples, tile.closest_point);
  if (tile.barycentric) store_triples(weights_of(part), samples, tile.barycentric);
  if (tile.feature) store_features(feature_of(part), samples, tile.feature);
}

// Fills the outputs of eight samples, and lists those whose answers are not sound (geometry/closest_part.h). `a` is the
// first corner of the triangles.
STANDOFF_INLINE void fill_quickly(const SidecarMesh& mesh, const SidecarTile& tile, const ScaledPlaces& places,
                                  const QuickTriangle<WideDouble>& triangle, const DoublePoint& a,
                                  const std::uint32_t* samples, int count, Samples& poor) {
  const DoublePoint at = places_of(places, samples);
  const auto part = quick_part(triangle, at - a);
  store_part(part, at, mesh, tile, samples);
  if (tile.gradient)
    store_triples(part.point * (-gradient_signs(mesh, tile, samples) / sqrt(part.distance_sq)), samples, tile.gradient);
  for (std::uint32_t left = ~part.is_sound.to_bits() & ((1u << count) - 1); left != 0; left &= left - 1)
    poor.add(samples[__builtin_ctz(left)]);
}

// One of eight triangles, in all lanes.
STANDOFF_INLINE QuickFace<WideDouble> face_of_lane(const QuickFace<WideDouble>& eight, int lane) {
  return {of_lane(eight.to_b, lane), of_lane(eight.to_c, lane), of_lane(eight.normal, lane),
          of_lane(eight.least_sq, lane)};
}

// Fills the outputs of eight samples as if all were over the inside of one triangle, and lists those in use that are
// not. The feature is that of cleared memory. Sixteen samples can be read.
STANDOFF_INLINE void fill_face(const SidecarMesh& mesh, const SidecarTile& tile, const ScaledPlaces& places,
                               const QuickFace<WideDouble>& face, const DoublePoint& a, const std::uint32_t* samples,
                               std::uint32_t used, Samples& others) {
  const DoublePoint place = places_of(places, samples);
  const auto at = quick_face_at(face, place - a);
  if (tile.closest_point)
    store_triples(minus_scaled(place, face.normal, at.height) * WideDouble(mesh.unscale), samples, tile.closest_point);
  if (tile.barycentric)
    store_triples(DoublePoint{(WideDouble(1.0) - at.v) - at.w, at.v, at.w}, samples, tile.barycentric);
  if (tile.gradient) {
    const WideDouble sign = gradient_signs(mesh, tile, samples);
    store_triples(face.normal * select(less(at.height, WideDouble(0.0)), -sign, sign), samples, tile.gradient);
  }
  others.count +=
      store_packed(others.at + others.count, mask_from_bits(~at.is_inside.to_bits() & used), WideUint::load(samples));
}

// The square of what no sample of the tile is farther away from a point.
STANDOFF_INLINE WideDouble reach_sq(const ScaledPlaces& places, const DoublePoint& point) {
  const auto along = [&](int axis, const WideDouble& at) __attribute__((always_inline)) {
    const WideDouble low = at - WideDouble(places.at[axis][0]),
                     high = WideDouble(places.at[axis][SidecarTile::kSide - 1]) - at;
    const WideDouble most = max(low, high);
    return most * most;
  };
  return along(0, point.x) + along(1, point.y) + along(2, point.z);
}

// Those of triangles that have several each: eight triangles are prepared at once, and then taken one by one. A
// triangle's last group goes on with samples of the next ones, whose outputs are filled again after it.
template <bool kPacked>
STANDOFF_INLINE void fill_by_triangle(const SidecarMesh& mesh, const SidecarTile& tile, const ScaledPlaces& places,
                                      SamplesByTriangle& sorted) {
  for (int begin = 0; begin < sorted.triangles; begin += kSamplesAtOnce) {
    const int count = sorted.triangles - begin < kSamplesAtOnce ? sorted.triangles - begin : kSamplesAtOnce;
    DoublePoint corner[3];
    load_corners<kPacked>(mesh, sorted.triangle + begin, count, corner);
    const QuickFace<WideDouble> eight = quick_face(corner[0], corner[1], corner[2], reach_sq(places, corner[0]));
    for (int lane = 0; lane < count; ++lane) {
      const int end = sorted.first[begin + lane + 1];
      const QuickFace<WideDouble> face = face_of_lane(eight, lane);
      const DoublePoint a = of_lane(corner[0], lane);
      for (int first = sorted.first[begin + lane]; first < end; first += kSamplesAtOnce) {
        const std::uint32_t used = end - first < kSamplesAtOnce ? (1u << (end - first)) - 1 : 0xff;
        fill_face(mesh, tile, places, face, a, sorted.samples.at + first, used, sorted.others);
      }
    }
  }
}

// Each with a triangle of its own.
template <bool kPacked>
STANDOFF_INLINE void fill_others(const SidecarMesh& mesh, const SidecarTile& tile, const ScaledPlaces& places,
                                 const Samples& samples, Samples& poor) {
  for_each_group(
      samples.at, samples.count, [&](const std::uint32_t* some, int used) __attribute__((always_inline)) {
        DoublePoint corner[3];
        load_nearest<kPacked>(mesh, tile, some, corner);
        fill_quickly(mesh, tile, places, quick_triangle(corner[0], corner[1], corner[2]), corner[0], some, used, poor);
      });
}

STANDOFF_INLINE WideDouble orientations(const SidecarMesh& mesh, const SidecarTile& tile,
                                        const std::uint32_t* samples) {
  alignas(64) double orientation[kSamplesAtOnce];
  for (int lane = 0; lane < kSamplesAtOnce; ++lane) {
    const bool reversed = (mesh.use && mesh.use[tile.nearest[samples[lane]]] < 0) != mesh.turned;
    orientation[lane] = !mesh.has_sign ? 0.0 : reversed ? -1.0 : 1.0;
  }
  return WideDouble::load(orientation);
}

// The same for any triangles. Returns how many samples are on the surface, or kTooFar.
template <bool kPacked>
STANDOFF_INLINE int fill_exactly(const SidecarMesh& mesh, const SidecarTile& tile, const ScaledPlaces& places,
                                 const Samples& samples) {
  int near = 0;
  bool too_far = false;
  for_each_group(
      samples.at, samples.count, [&](const std::uint32_t* some, int used) __attribute__((always_inline)) {
        DoublePoint corner[3];
        load_nearest<kPacked>(mesh, tile, some, corner);
        const DoublePoint at = places_of(places, some);
        for (DoublePoint& one : corner) one = one - at;
        const ClosestPart<WideDouble> part = closest_part(corner[0], corner[1], corner[2]);
        // Squares of squares are finite; where something overflowed, one of these is no number or infinite.
        const WideDouble most(0x1p200);
        too_far |= (less(part.distance_sq, most) & less(part.side_sq, most)).to_bits() != 0xff;
        store_part(part, at, mesh, tile, some);
        if (!tile.gradient) return;
        const Slope<WideDouble> slope = slope_of(part, corner[0], orientations(mesh, tile, some));
        const DoubleMask is_near = less(WideDouble(0.5), slope.is_near);
        const WideDouble sign = select(is_near, WideDouble(1.0), gradient_signs(mesh, tile, some));
        store_triples(slope.direction * sign, some, tile.gradient);
        near += __builtin_popcount(is_near.to_bits() & ((1u << used) - 1));
      });
  return too_far ? SidecarKernels::kTooFar : near;
}

template <bool kPacked>
STANDOFF_INLINE int fill_sorted(const SidecarMesh& mesh, const SidecarTile& tile, SamplesByTriangle& sorted) {
  ScaledPlaces places;
  set_places(mesh, tile, places);
  fill_by_triangle<kPacked>(mesh, tile, places, sorted);
  Samples poor;
  fill_others<kPacked>(mesh, tile, places, sorted.others, poor);
  return fill_exactly<kPacked>(mesh, tile, places, poor);
}

int fill(const SidecarMesh& mesh, const SidecarTile& tile) {
  SamplesByTriangle sorted;
  if (!sort_by_triangle(mesh, tile, sorted)) return SidecarKernels::kNoSuchTriangle;
  return mesh.memory.packed ? fill_sorted<true>(mesh, tile, sorted) : fill_sorted<false>(mesh, tile, sorted);
}

}  // namespace

extern const SidecarKernels kSidecarKernels;
const SidecarKernels kSidecarKernels{.fill = fill};

}  // namespace standoff::cpu::STANDOFF_TARGET
