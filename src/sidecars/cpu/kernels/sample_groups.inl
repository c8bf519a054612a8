// SPDX-License-Identifier: Apache-2.0
// Eight samples of a tile at once: the corners of their nearest triangles in, what is beside them out.
#pragma once

#include "sidecars/cpu/kernels.h"
#include "simd/points.inl"
#include "simd/target.h"
#include "standoff/mesh.h"

namespace standoff::cpu::STANDOFF_TARGET {

using namespace standoff::STANDOFF_TARGET;

namespace {

constexpr int kSamplesAtOnce = WideDouble::kLanes;

// The coordinates of a tile's samples, scaled: each in the place of its axis, so that those of a sample are a sum.
struct ScaledPlaces {
  using Vector = double __attribute__((vector_size(4 * sizeof(double))));
  Vector x[SidecarTile::kSide], yz[SidecarTile::kSide * SidecarTile::kSide];
};

STANDOFF_INLINE void set_places(const SidecarMesh& mesh, const SidecarTile& tile, ScaledPlaces& places) {
  constexpr int kSide = SidecarTile::kSide;
  for (int n = 0; n < kSide; ++n) places.x[n] = ScaledPlaces::Vector{tile.x[n] * mesh.scale, 0, 0, 0};
  for (int k = 0; k < kSide; ++k)
    for (int j = 0; j < kSide; ++j)
      places.yz[kSide * k + j] = ScaledPlaces::Vector{0, tile.y[j] * mesh.scale, tile.z[k] * mesh.scale, 0};
}

// Corners relative to their samples, scaled. Coordinates are taken relative before anything else, so that nothing is
// lost far from the origin. Names of samples past the end must be some of the tile's.
template <bool kPacked>
STANDOFF_INLINE void load_corners(const SidecarMesh& mesh, const SidecarTile& tile, const ScaledPlaces& places,
                                  const std::uint32_t* samples, DoublePoint (&corner)[3]) {
  alignas(64) double rows[3][kSamplesAtOnce][4];
  for (int lane = 0; lane < kSamplesAtOnce; ++lane) {
    const std::uint32_t n = samples[lane], triangle = tile.nearest[n];
    // Of one vector: a load of what was stored number by number would wait for all of them.
    const ScaledPlaces::Vector at = places.x[n % 8] + places.yz[n / 8];
    for (int which = 0; which < 3; ++which) {
      double room[3];
      store_local(rows[which][lane], corner_of<kPacked>(mesh.memory, triangle, which, room), mesh.scale,
                  reinterpret_cast<const double*>(&at));
    }
  }
  for (int which = 0; which < 3; ++which)
    corner[which] = {load_column(rows[which], 0), load_column(rows[which], 1), load_column(rows[which], 2)};
}

// Where the gradient points away from the distance's: -1, else 1.
STANDOFF_INLINE WideDouble gradient_signs(const SidecarMesh& mesh, const SidecarTile& tile,
                                          const std::uint32_t* samples) {
  alignas(64) double sign[kSamplesAtOnce];
  for (int lane = 0; lane < kSamplesAtOnce; ++lane)
    sign[lane] = mesh.has_negative && __builtin_signbit(tile.values[samples[lane]]) ? -1.0 : 1.0;
  return WideDouble::load(sign);
}

// In a loop of its own, which the compiler makes wide.
STANDOFF_INLINE void store_rounded(const WideDouble& from, float* to) {
  alignas(64) double exact[kSamplesAtOnce];
  from.store(exact);
  for (int lane = 0; lane < kSamplesAtOnce; ++lane) to[lane] = static_cast<float>(exact[lane]);
}

// Three numbers of each sample.
STANDOFF_INLINE void store_triples(const DoublePoint& v, const std::uint32_t* samples, int count, float* out) {
  alignas(64) float numbers[3][kSamplesAtOnce];
  store_rounded(v.x, numbers[0]);
  store_rounded(v.y, numbers[1]);
  store_rounded(v.z, numbers[2]);
  for (int lane = 0; lane < count; ++lane) {
    float* const to = out + 3 * samples[lane];
    for (int axis = 0; axis < 3; ++axis) to[axis] = numbers[axis][lane];
  }
}

// Points relative to their samples, scaled; stored in world units.
STANDOFF_INLINE void store_world(const DoublePoint& point, const SidecarMesh& mesh, const SidecarTile& tile,
                                 const std::uint32_t* samples, int count) {
  alignas(64) double numbers[3][kSamplesAtOnce];
  store_points(point * WideDouble(mesh.unscale), numbers);
  for (int lane = 0; lane < count; ++lane) {
    const std::uint32_t n = samples[lane];
    float* const to = tile.closest_point + 3 * n;
    to[0] = static_cast<float>(tile.x[n % 8] + numbers[0][lane]);
    to[1] = static_cast<float>(tile.y[n / 8 % 8] + numbers[1][lane]);
    to[2] = static_cast<float>(tile.z[n / 64] + numbers[2][lane]);
  }
}

STANDOFF_INLINE void store_features(const WideDouble& features, const std::uint32_t* samples, int count,
                                    std::uint8_t* out) {
  alignas(64) double feature[kSamplesAtOnce];
  features.store(feature);
  for (int lane = 0; lane < count; ++lane) out[samples[lane]] = static_cast<std::uint8_t>(feature[lane]);
}

// All that the tile asks for, but for the gradient. A part has a point, weights and a feature.
template <class Part>
STANDOFF_INLINE void store_part(const Part& part, const SidecarMesh& mesh, const SidecarTile& tile,
                                const std::uint32_t* samples, int count) {
  if (tile.closest_point) store_world(part.point, mesh, tile, samples, count);
  if (tile.barycentric) store_triples(part.weights, samples, count, tile.barycentric);
  if (tile.feature) store_features(part.feature, samples, count, tile.feature);
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
