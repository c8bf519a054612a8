// SPDX-License-Identifier: Apache-2.0
#include "collision/body/field_side.h"

#include <algorithm>
#include <cmath>

namespace standoff::collision {
namespace {

// The sample of a grid that is nearest to a point, and their distance.
struct NearestSample {
  std::int64_t i, j, k;
  double off;
};

NearestSample nearest_sample(Vec3 x, Vec3 origin, double spacing, Size3 size) {
  const Vec3 u = (x - origin) * (1 / spacing);
  const auto nearest = [](double at, std::int64_t count) {
    return static_cast<std::int64_t>(std::clamp(at, 0.0, static_cast<double>(count - 1)) + 0.5);
  };
  const NearestSample at{nearest(u.x, size.x), nearest(u.y, size.y), nearest(u.z, size.z), 0};
  const Vec3 position = origin + Vec3{double(at.i), double(at.j), double(at.k)} * spacing;
  return {at.i, at.j, at.k, length(x - position)};
}

std::size_t coarse_sample(const FieldBounds& field, std::int64_t i, std::int64_t j, std::int64_t k) {
  return static_cast<std::size_t>((k * field.coarse_size.y + j) * field.coarse_size.x + i);
}

Side side_of_bit(const HugePageVector<std::uint8_t>& bits, std::size_t n) {
  return (bits[n / 8] >> n % 8 & 1) != 0 ? Side::inside : Side::outside;
}

Side side_of_coarse(const FieldBounds& field, std::int64_t i, std::int64_t j, std::int64_t k) {
  return side_of_bit(field.coarse_inside, coarse_sample(field, i, j, k));
}

// A tile that is not stored is farther than the band from the surface, and the nearest coarse sample, at most two
// spacings away along each axis, is nearer than that.
static_assert(kCoarseStep * kCoarseStep * 3 < 4 * kBandSamples * kBandSamples);
Side side_of_fine(const FieldBounds& field, std::int32_t i, std::int32_t j, std::int32_t k, std::int32_t slot) {
  constexpr std::int32_t kHalf = kCoarseStep / 2;
  if (slot == 0)
    return side_of_coarse(field, (i + kHalf) / kCoarseStep, (j + kHalf) / kCoarseStep, (k + kHalf) / kCoarseStep);
  const auto tile = static_cast<std::size_t>(slot), within = static_cast<std::size_t>(index_in_tile(i, j, k));
  return side_of_bit(field.inside, DistanceField::kTileSamples * tile + within);
}

}  // namespace

Side side_of(const ModelData& body, Vec3 x, double slack) {
  const FieldBounds& field = body.field;
  const Vec3 out = max(field.box.min - x, x - field.box.max);
  if (std::max({out.x, out.y, out.z}) > slack) return Side::outside;
  const NearestSample coarse = nearest_sample(x, field.origin, kCoarseStep * field.spacing, field.coarse_size);
  if (field.coarse[coarse_sample(field, coarse.i, coarse.j, coarse.k)] > coarse.off + slack)
    return side_of_coarse(field, coarse.i, coarse.j, coarse.k);
  const NearestSample fine = nearest_sample(x, field.origin, field.spacing, field.size);
  const auto i = static_cast<std::int32_t>(fine.i), j = static_cast<std::int32_t>(fine.j),
             k = static_cast<std::int32_t>(fine.k);
  const std::int32_t tile = tile_of(body.view, i, j, k), within = index_in_tile(i, j, k);
  if (fine_sample(body.view, tile, within) * field.thickness() / kClampedSample > fine.off + slack)
    return side_of_fine(field, i, j, k, field.slots[static_cast<std::size_t>(tile)]);
  return Side::unknown;
}

}  // namespace standoff::collision
