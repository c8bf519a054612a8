// SPDX-License-Identifier: Apache-2.0
// The kernel that makes sidecars of the nearest triangles of a tile, eight samples at once, in double: first as if all
// were over the inside of their triangles, then by regions, and at last, with more care, where that says nothing.
#pragma once

#include "geometry/closest_part.h"
#include "sidecars/cpu/kernels.h"
#include "simd/points.inl"
#include "simd/target.h"
#include "standoff/mesh.h"

namespace standoff::cpu::STANDOFF_TARGET {

using namespace standoff::STANDOFF_TARGET;

namespace {

// The samples of a tile that have a nearest triangle: those of one triangle together, so that it is prepared once.

constexpr int kSamplesAtOnce = WideDouble::kLanes;

// Samples of a tile, with as many more as the last group reads.
struct Samples {
  alignas(64) std::uint32_t at[SidecarTile::kSamples + WideFloat::kLanes];
  int count = 0;

  void add(std::uint32_t sample) { at[count++] = sample; }
};

// Calls use(eight samples, how many) for each group of some samples: past the end, the last one again.
template <class Use>
STANDOFF_INLINE void for_each_group(const std::uint32_t* samples, int count, const Use& use) {
  int first = 0;
  for (; first + kSamplesAtOnce <= count; first += kSamplesAtOnce) use(samples + first, kSamplesAtOnce);
  if (first == count) return;
  std::uint32_t last[kSamplesAtOnce];
  for (int n = 0; n < kSamplesAtOnce; ++n) last[n] = samples[first + n < count ? first + n : count - 1];
  use(last, count - first);
}

// Triangles and the samples that they are nearest to: those of triangle n are samples.at[first[n]] up to
// samples.at[first[n + 1]].
struct SamplesByTriangle {
  std::uint32_t triangle[SidecarTile::kSamples];
  int first[SidecarTile::kSamples + 1];
  int triangles = 0;
  Samples samples;  // and past the end, the last one again, as often as a group reads it
  Samples others;   // that are not among these, or not over the inside of their triangle
};

// Those with a nearest triangle, and these. Returns whether the mesh has all of them.
STANDOFF_INLINE bool find_samples(const SidecarMesh& mesh, const SidecarTile& tile, Samples& samples,
                                  std::uint32_t* nearest) {
  std::uint32_t wrong = 0;
  int count = 0;
  for (int n = 0; n < SidecarTile::kSamples; n += WideFloat::kLanes) {
    const WideUint triangle = WideUint::load(tile.nearest + n);
    const Mask has_one = less(triangle, WideUint(kNoTriangle)), exists = less(triangle, WideUint(mesh.triangles));
    wrong |= (has_one & ~exists).to_bits();
    store_packed(nearest + count, has_one, triangle);
    count += store_packed(samples.at + count, has_one, WideUint(static_cast<std::uint32_t>(n)) + lane_numbers());
  }
  samples.count = count;
  return wrong == 0;
}

// Sorts the samples by triangle as long as that pays: it takes a look at all samples for each triangle. Returns whether
// the mesh has all of these triangles.
STANDOFF_INLINE bool sort_by_triangle(const SidecarMesh& mesh, const SidecarTile& tile, SamplesByTriangle& sorted) {
  constexpr int kLanes = WideFloat::kLanes;
  constexpr int kTriangles = 8, kLeastSamples = 5;  // stops where these triangles or more have fewer samples each
  alignas(64) std::uint32_t nearest[SidecarTile::kSamples + kLanes];
  Samples all;
  if (!find_samples(mesh, tile, all, nearest)) return false;
  const int vectors = (all.count + kLanes - 1) / kLanes;
  std::uint32_t left[SidecarTile::kSamples / kLanes];
  for (int v = 0; v < vectors; ++v) left[v] = 0xffff;
  if (all.count % kLanes != 0) left[vectors - 1] = (1u << all.count % kLanes) - 1;
  const auto move = [&](int v, std::uint32_t which, Samples& to) __attribute__((always_inline)) {
    left[v] ^= which;
    to.count += store_packed(to.at + to.count, mask_from_bits(which), WideUint::load(all.at + v * kLanes));
  };
  Samples& samples = sorted.samples;
  const auto pays = [&] { return sorted.triangles < kTriangles || samples.count >= kLeastSamples * sorted.triangles; };
  sorted.first[0] = 0;
  for (int v = 0; v < vectors; ++v) {
    while (left[v] != 0 && pays()) {
      const std::uint32_t triangle = nearest[v * kLanes + __builtin_ctz(left[v])];
      prefetch_indices(mesh.memory, triangle);
      for (int other = v; other < vectors; ++other)
        move(other, equal(WideUint::load(nearest + other * kLanes), WideUint(triangle)).to_bits() & left[other],
             samples);
      sorted.triangle[sorted.triangles++] = triangle;
      sorted.first[sorted.triangles] = samples.count;
    }
    move(v, left[v], sorted.others);
  }
  for (int n = 0; n < kSamplesAtOnce && samples.count > 0; ++n)
    samples.at[samples.count + n] = samples.at[samples.count - 1];
  return true;
}

// Eight samples of a tile at once: their places and the corners of triangles in, what is beside them out.

// The coordinates of a tile's samples along each axis, scaled.
struct ScaledPlaces {
  alignas(64) double at[3][SidecarTile::kSide];
};

STANDOFF_INLINE void set_places(const SidecarMesh& mesh, const SidecarTile& tile, ScaledPlaces& places) {
  for (int n = 0; n < SidecarTile::kSide; ++n) {
    places.at[0][n] = tile.x[n] * mesh.scale;
    places.at[1][n] = tile.y[n] * mesh.scale;
    places.at[2][n] = tile.z[n] * mesh.scale;
  }
}

STANDOFF_INLINE DoublePoint places_of(const ScaledPlaces& places, const std::uint32_t* samples) {
  static_assert(SidecarTile::kSide == 8);
  return {look_up<0>(places.at[0], samples), look_up<3>(places.at[1], samples), look_up<6>(places.at[2], samples)};
}

// The corners of eight triangles, scaled. Past the `count`, the last one again.
template <bool kPacked>
STANDOFF_INLINE void load_corners(const SidecarMesh& mesh, const std::uint32_t* triangles, int count,
                                  DoublePoint (&corner)[3]) {
  constexpr double kOrigin[4] = {};
  alignas(64) double rows[3][kSamplesAtOnce][4];
  for (int lane = 0; lane < kSamplesAtOnce; ++lane)
    for (int which = 0; which < 3; ++which) {
      double room[3];
      store_local(rows[which][lane],
                  corner_of<kPacked>(mesh.memory, triangles[lane < count ? lane : count - 1], which, room), mesh.scale,
                  kOrigin);
    }
  for (int which = 0; which < 3; ++which)
    corner[which] = {load_column(rows[which], 0), load_column(rows[which], 1), load_column(rows[which], 2)};
}

// Those of the nearest triangles of eight samples.
template <bool kPacked>
STANDOFF_INLINE void load_nearest(const SidecarMesh& mesh, const SidecarTile& tile, const std::uint32_t* samples,
                                  DoublePoint (&corner)[3]) {
  std::uint32_t triangles[kSamplesAtOnce];
  for (int lane = 0; lane < kSamplesAtOnce; ++lane) triangles[lane] = tile.nearest[samples[lane]];
  load_corners<kPacked>(mesh, triangles, kSamplesAtOnce, corner);
}

// Where the gradient points away from the distance's: -1, else 1. By bits, because stores of single numbers would have
// to be done before they are read as eight.
STANDOFF_INLINE WideDouble gradient_signs(const SidecarMesh& mesh, const SidecarTile& tile,
                                          const std::uint32_t* samples) {
  std::uint32_t negative = 0;
  for (int lane = 0; lane < kSamplesAtOnce; ++lane) {
    std::uint32_t value;
    __builtin_memcpy(&value, tile.values + samples[lane], sizeof value);
    negative |= value >> 31 << lane;
  }
  return select(double_mask_from_bits(mesh.has_negative ? negative : 0), WideDouble(-1.0), WideDouble(1.0));
}

// Three numbers of each of eight samples.
STANDOFF_INLINE void store_triples(const DoublePoint& v, const std::uint32_t* samples, float* out) {
  alignas(64) float xy[kSamplesAtOnce][2], z[kSamplesAtOnce];
  store_rounded_pairs(xy, v.x, v.y);
  store_rounded(z, v.z);
  for (int lane = 0; lane < kSamplesAtOnce; ++lane) {
    float* const to = out + 3 * samples[lane];
    __builtin_memcpy(to, xy[lane], sizeof xy[lane]);
    to[2] = z[lane];
  }
}

STANDOFF_INLINE void store_features(const WideDouble& features, const std::uint32_t* samples, std::uint8_t* out) {
  alignas(64) float feature[kSamplesAtOnce];
  store_rounded(feature, features);
  for (int lane = 0; lane < kSamplesAtOnce; ++lane) out[samples[lane]] = static_cast<std::uint8_t>(feature[lane]);
}

// The outputs of eight samples but for the gradient. A part has a point, weights and a feature, `at` is where they are.
template <class Part>
STANDOFF_INLINE void store_part(const Part& part, const DoublePoint& at, const SidecarMesh& mesh,
                                const SidecarTile& tile, const std::uint32_t* samples) {
  if (tile.closest_point) store_triples((at + part.point) * WideDouble(mesh.unscale), samples, tile.closest_point);
  if (tile.barycentric) store_triples(weights_of(part), samples, tile.barycentric);
  if (tile.feature) store_features(feature_of(part), samples, tile.feature);
}

// Fills the outputs of eight samples, and lists those whose answers are not sound (geometry/quick_part.h). `a` is the
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
