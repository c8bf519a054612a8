// SPDX-License-Identifier: Apache-2.0
// Eight samples of a tile at once: their places and the corners of triangles in, what is beside them out.
#pragma once

#include "sidecars/cpu/kernels/samples_by_triangle.inl"
#include "simd/points.inl"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

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

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
