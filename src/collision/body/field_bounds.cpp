// SPDX-License-Identifier: Apache-2.0
// Builds the two fields of a body through compute(), rounds them down to lower bounds, and makes the view of them that
// kernels read.
#include <tbb/parallel_for.h>

#include <cmath>
#include <span>
#include <string>

#include "collision/body/body.h"
#include "core/number_text.h"
#include "core/tile_count.h"
#include "geometry/rounding.h"
#include "sign/diagnosis/closed.h"
#include "standoff/compute.h"
#include "standoff/error.h"

namespace standoff::collision {
namespace {

// Samples of a field by default. Small meshes get fewer: with as many as large ones, a field takes longer to build than
// all else of a body, and queries are no faster. With fewer, large meshes that touch take up to four times as long.
constexpr double kFewestSamples = 6e6, kMostSamples = 12e6, kSamplesOfTriangle = 24;
constexpr double kEdgeShare = 0.25;
constexpr double kMostCoarse = 0x1p28;
// The largest sample index per axis: the kernels round indices in single precision, which has no halves beyond this.
constexpr std::int64_t kMostAlong = (std::int64_t{1} << 23) - 1;

std::uint8_t rounded_down(float value, double spacing) {
  const double band = kBandSamples * spacing;
  if (value >= static_cast<float>(band)) return kClampedSample;
  // A lower bound of the distance, whatever the error of compute() is.
  const double bound = value - promised_error(value, spacing);
  return static_cast<std::uint8_t>(std::max(0.0, std::floor(bound / band * kClampedSample)));
}

// The signs of eight values: a bit is set if its value is negative.
std::uint8_t signs_of(const float* values) {
  unsigned bits = 0;
  for (unsigned n = 0; n < 8; ++n) bits |= unsigned{values[n] < 0} << n;
  return static_cast<std::uint8_t>(bits);
}

void fill_fine(FieldBounds& bounds, const DistanceField& field, bool has_sign) {
  bounds.slots.assign(static_cast<std::size_t>(field.tile_count().count()), 0);
  std::vector<DistanceField::TileValues> stored;
  for (const DistanceField::Tile& tile : field.tiles()) {
    stored.push_back(tile.values);
    bounds.slots[static_cast<std::size_t>(tile.index)] = static_cast<std::int32_t>(stored.size());
  }
  constexpr std::size_t kSize = DistanceField::kTileSamples;
  bounds.samples.resize((stored.size() + 1) * kSize);
  std::fill_n(bounds.samples.begin(), kSize, std::uint8_t{kClampedSample});
  if (has_sign) bounds.inside.resize(bounds.samples.size() / 8);
  tbb::parallel_for(std::size_t{0}, stored.size(), [&](std::size_t t) {
    for (std::size_t n = 0; n < kSize; ++n)
      bounds.samples[(t + 1) * kSize + n] = rounded_down(std::abs(stored[t][n]), bounds.spacing);
    if (has_sign)
      for (std::size_t n = 0; n < kSize; n += 8) bounds.inside[((t + 1) * kSize + n) / 8] = signs_of(&stored[t][n]);
  });
}

// A coarse sample coincides with a fine one, unless it is past the last fine sample, and so outside the surface's box.
void fill_coarse_inside(FieldBounds& bounds, const DistanceField& fine) {
  const Size3 size = bounds.coarse_size;
  bounds.coarse_inside.resize(static_cast<std::size_t>((size.count() + 7) / 8));
  std::size_t n = 0;
  for (std::int64_t k = 0; k < size.z; ++k)
    for (std::int64_t j = 0; j < size.y; ++j)
      for (std::int64_t i = 0; i < size.x; ++i, ++n) {
        const std::int64_t x = kCoarseStep * i, y = kCoarseStep * j, z = kCoarseStep * k;
        const bool in_fine = x < bounds.size.x && y < bounds.size.y && z < bounds.size.z;
        bounds.coarse_inside[n / 8] |= static_cast<std::uint8_t>((in_fine && fine.value(x, y, z) < 0) << n % 8);
      }
}

}  // namespace

double default_spacing(MeshView mesh, const Box& box) {
  double edges = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) edges += length(mesh.corner(t, k) - mesh.corner(t, (k + 1) % 3));
  const double mean_edge = edges / (3.0 * static_cast<double>(mesh.triangles.size()));
  const Vec3 e = box.extent();
  const double longest = box.longest_side();
  if (!(longest > 0)) return 1;
  // The band pads flat boxes too: the thinnest side counts as at least a hundredth of the longest.
  const double volume =
      longest * std::max(e.x, longest / 100) * std::max(e.y, longest / 100) * std::max(e.z, longest / 100) / longest;
  const double samples =
      std::clamp(kSamplesOfTriangle * static_cast<double>(mesh.triangles.size()), kFewestSamples, kMostSamples);
  return std::max({std::cbrt(volume / samples), kEdgeShare * mean_edge, longest / 1024});
}

FieldBounds plan_field_bounds(const Box& box, double spacing) {
  FieldBounds bounds;
  bounds.spacing = spacing;
  bounds.box = box;
  const Grid fine = fit_spacing(box, {spacing, spacing, spacing}, {.length = bounds.thickness(), .least_samples = 0});
  Size3 coarse;
  for (auto n : {&Size3::x, &Size3::y, &Size3::z}) coarse.*n = (fine.size.*n + kCoarseStep - 2) / kCoarseStep + 1;
  if (std::max({fine.size.x, fine.size.y, fine.size.z}) > kMostAlong ||
      static_cast<double>(coarse.x) * static_cast<double>(coarse.y) * static_cast<double>(coarse.z) > kMostCoarse)
    throw Error(ErrorCode::limit, "body: a spacing of " + number_text(spacing) + " makes a field of " +
                                      std::to_string(fine.size.x) + " x " + std::to_string(fine.size.y) + " x " +
                                      std::to_string(fine.size.z) + " samples; take a larger spacing");
  bounds.size = fine.size;
  bounds.coarse_size = coarse;
  bounds.origin = fine.origin;
  return bounds;
}

FieldBounds build_field_bounds(MeshView mesh, Vec3 middle, double spacing, const Execution& execution,
                               ProgressMeter& progress) {
  std::vector<Vec3> vertices(mesh.vertices.size());
  tbb::parallel_for(std::size_t{0}, vertices.size(), [&](std::size_t v) { vertices[v] = mesh.vertices[v] - middle; });
  const MeshView moved{vertices, mesh.triangles};
  FieldBounds bounds = plan_field_bounds(standoff::bounds(moved), spacing);
  const double coarse_spacing = kCoarseStep * spacing;
  const Grid fine{bounds.size, bounds.origin, {spacing, spacing, spacing}};
  const Grid coarse{bounds.coarse_size, bounds.origin, {coarse_spacing, coarse_spacing, coarse_spacing}};
  ComputeOptions options;
  options.sign = {SignMethod::none};
  options.memory_limit = kNoMemoryLimit;
  options.execution = execution;
  options.progress = [&progress](const Progress&) {
    progress.check();
    return true;
  };
  const bool has_sign = is_closed(moved).oriented;
  // Keep the triangles' orientation: containment counts crossings near the surface with it too.
  if (has_sign) options.sign = {.method = SignMethod::winding, .as_oriented = true};
  {
    const DistanceField field = compute(moved, fine, bounds.thickness(), options).field;
    fill_fine(bounds, field, has_sign);
    if (has_sign) fill_coarse_inside(bounds, field);
  }
  progress.advance();
  options.sign = {SignMethod::none};
  bounds.coarse.resize(static_cast<std::size_t>(coarse.sample_count()));
  compute_into(moved, coarse, kFullField, bounds.coarse, options);
  for (float& value : bounds.coarse) value = static_cast<float>(value - promised_error(value, coarse_spacing));
  return bounds;
}

FieldView FieldBounds::view() const {
  FieldView view{};
  const double coarse_spacing = kCoarseStep * spacing;
  view.spacing = static_cast<float>(spacing);
  view.coarse_spacing = static_cast<float>(coarse_spacing);
  view.per_spacing = static_cast<float>(1 / spacing);
  view.per_coarse_spacing = static_cast<float>(1 / coarse_spacing);
  view.step = static_cast<float>(thickness() / kClampedSample);
  const auto set = [](float(&to)[3], Vec3 v) {
    to[0] = static_cast<float>(v.x), to[1] = static_cast<float>(v.y), to[2] = static_cast<float>(v.z);
  };
  const auto last = [](Size3 n) { return Vec3{double(n.x - 1), double(n.y - 1), double(n.z - 1)}; };
  set(view.origin, origin);
  set(view.last, last(size));
  set(view.coarse_last, last(coarse_size));
  set(view.min, box.min);
  set(view.max, box.max);
  view.tiles[0] = static_cast<std::int32_t>((size.x + kTileSide - 1) / kTileSide);
  view.tiles[1] = static_cast<std::int32_t>((size.y + kTileSide - 1) / kTileSide);
  view.coarse_size[0] = static_cast<std::int32_t>(coarse_size.x);
  view.coarse_size[1] = static_cast<std::int32_t>(coarse_size.y);
  view.slots = slots.data();
  view.samples = samples.data();
  view.coarse = coarse.data();
  return view;
}

}  // namespace standoff::collision
