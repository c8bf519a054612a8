// SPDX-License-Identifier: Apache-2.0
// The kernel that makes the sidecars of a tile from its nearest triangles, eight samples at once, in double. It has
// three measures (geometry/closest_part.h): the first assumes that samples are over the inside of their triangles, the
// second works by regions, the third, slower one always has an answer.
#pragma once

#include "geometry/closest_part.h"
#include "sidecars/cpu/kernels.h"
#include "simd/points.inl"
#include "simd/target.h"
#include "standoff/mesh.h"

namespace standoff::cpu::STANDOFF_TARGET {

using namespace standoff::STANDOFF_TARGET;

namespace {

// Samples are sorted by their nearest triangle, so that a triangle is prepared once.

constexpr int kSamplesAtOnce = WideDouble::kLanes;

// Samples of a tile; a group of eight may read past the end.
struct Samples {
  alignas(64) std::uint32_t at[SidecarTile::kSamples + WideFloat::kLanes];
  int count = 0;

  void add(std::uint32_t sample) { at[count++] = sample; }
};

// Calls use(eight samples, how many) for each group of samples. The last group is filled up with the last sample.
template <class Use>
STANDOFF_INLINE void for_each_group(const std::uint32_t* samples, int count, const Use& use) {
  int first = 0;
  for (; first + kSamplesAtOnce <= count; first += kSamplesAtOnce) use(samples + first, kSamplesAtOnce);
  if (first == count) return;
  std::uint32_t last[kSamplesAtOnce];
  for (int n = 0; n < kSamplesAtOnce; ++n) last[n] = samples[first + n < count ? first + n : count - 1];
  use(last, count - first);
}

// Triangles and the samples that they are nearest to: triangle n has the samples samples.at[first[n]] up to
// samples.at[first[n + 1]].
struct SamplesByTriangle {
  std::uint32_t triangle[SidecarTile::kSamples];
  int first[SidecarTile::kSamples + 1];
  int triangles = 0;
  Samples samples;  // filled up with the last sample, as far as a group reads
  Samples others;   // the other samples, and samples that are not over the inside of their triangle
};

// Finds the samples with a nearest triangle, and these triangles. Returns whether the mesh has all of them.
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

// Sorts the samples by triangle while this pays: each triangle costs a pass over all samples. Returns whether the mesh
// has all nearest triangles.
STANDOFF_INLINE bool sort_by_triangle(const SidecarMesh& mesh, const SidecarTile& tile, SamplesByTriangle& sorted) {
  constexpr int kLanes = WideFloat::kLanes;
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
  sorted.first[0] = 0;
  for (int v = 0; v < vectors; ++v) {
    while (left[v] != 0 && prepares_more(sorted.triangles, samples.count)) {
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

// The scaled coordinates of a tile's samples along each axis.
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

// The scaled corners of eight triangles; the last of `count` fills up the rest.
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

// The scaled corners of the nearest triangles of eight samples.
template <bool kPacked>
STANDOFF_INLINE void load_nearest(const SidecarMesh& mesh, const SidecarTile& tile, const std::uint32_t* samples,
                                  DoublePoint (&corner)[3]) {
  std::uint32_t triangles[kSamplesAtOnce];
  for (int lane = 0; lane < kSamplesAtOnce; ++lane) triangles[lane] = tile.nearest[samples[lane]];
  load_corners<kPacked>(mesh, triangles, kSamplesAtOnce, corner);
}

// -1 if the gradient is opposite to the distance's gradient, else 1. The signs are collected as bits, because loading
// eight numbers would wait for eight single stores.
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

// Stores three numbers for each of eight samples.
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

// Stores the outputs of eight samples except the gradient. A part has a point, weights and a feature; `at`: the
// samples' places.
template <class Part>
STANDOFF_INLINE void store_part(const Part& part, const DoublePoint& at, const SidecarMesh& mesh,
                                const SidecarTile& tile, const std::uint32_t* samples) {
  if (tile.closest_point) store_triples((at + part.point) * WideDouble(mesh.unscale), samples, tile.closest_point);
  if (tile.barycentric) store_triples(weights_of(part), samples, tile.barycentric);
  if (tile.feature) store_features(feature_of(part), samples, tile.feature);
}

// Fills the outputs of eight samples by quick_part(), and lists the samples whose answers are not sound. `a`: the first
// corner of the triangles.
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

// Fills the outputs of eight samples as if all were over the inside of one triangle, and lists the samples in use that
// are not. It does not write the feature: cleared memory means the face. Requires sixteen readable samples.
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

// Fills the samples of triangles with several samples: eight triangles are prepared at once, and then taken one by one.
// A triangle's last group runs on into samples of the next triangle, which are filled again later.
template <bool kPacked>
STANDOFF_INLINE void fill_by_triangle(const SidecarMesh& mesh, const SidecarTile& tile, const ScaledPlaces& places,
                                      SamplesByTriangle& sorted) {
  const auto corner_of_tile = [&](int n) __attribute__((always_inline)) {
    return DoublePoint{WideDouble(places.at[0][n]), WideDouble(places.at[1][n]), WideDouble(places.at[2][n])};
  };
  const DoublePoint low = corner_of_tile(0), high = corner_of_tile(SidecarTile::kSide - 1);
  for (int begin = 0; begin < sorted.triangles; begin += kSamplesAtOnce) {
    const int count = sorted.triangles - begin < kSamplesAtOnce ? sorted.triangles - begin : kSamplesAtOnce;
    DoublePoint corner[3];
    load_corners<kPacked>(mesh, sorted.triangle + begin, count, corner);
    const QuickFace<WideDouble> eight = quick_face(corner[0], corner[1], corner[2], reach_sq(low, high, corner[0]));
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

// Fills samples that each have their own triangle.
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
    const bool reversed = (mesh.use && mesh.use[tile.nearest[samples[lane]]] < 0) != mesh.is_reversed;
    orientation[lane] = !mesh.has_sign ? 0.0 : reversed ? -1.0 : 1.0;
  }
  return WideDouble::load(orientation);
}

// The same for any triangles, by closest_part(). Returns the number of samples on the surface, or kTooFar.
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
        // Up to this bound squares of squares are finite; if something overflowed, one of these is NaN or infinite.
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

constexpr SidecarKernels kTable{.fill = fill};

}  // namespace standoff::cpu::STANDOFF_TARGET

const standoff::cpu::SidecarKernels standoff::cpu::SidecarKernels::STANDOFF_TARGET =
    standoff::cpu::STANDOFF_TARGET::kTable;
