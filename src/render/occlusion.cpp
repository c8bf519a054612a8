// SPDX-License-Identifier: Apache-2.0
#include "render/occlusion.h"

#include "render/thinned.h"
#include "standoff/compute.h"
#include "standoff/mesh.h"

namespace standoff {
namespace {

constexpr std::int64_t kSamples = 96;  // along the longest side: shadows and creases of 1/50 of the scene
// Triangles smaller than this, in the unit space, are thinned out: a quarter of the spacing in a scene of usual shape.
constexpr float kSmall = 0.004F;
constexpr float kReach = 12;  // thickness of the band in spacings: how far a crease darkens
// Nearer than this to a surface the interpolated field says little about it, in spacings.
constexpr float kLeave = 1.5F;

bool casts(const DrawnPart& part) { return part.casts_shadow && part.opacity >= 1 && !part.triangles.empty(); }

}  // namespace

Occlusion::Occlusion(std::span<const DrawnPart> parts) {
  std::vector<const DrawnPart*> casting;
  for (const DrawnPart& part : parts)
    if (casts(part)) casting.push_back(&part);
  if (casting.empty()) return;

  static_assert(sizeof(Float3) == 3 * sizeof(float));
  std::vector<Float3> places;
  std::vector<Triangle> triangles;
  for (const DrawnPart* part : casting) {
    const auto first = static_cast<std::uint32_t>(places.size());
    if (casting.size() > 1) places.insert(places.end(), part->places.begin(), part->places.end());
    for (const Triangle& t : thinned(part->places, part->triangles, kSmall))
      triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  const std::vector<Float3>& all = casting.size() > 1 ? places : casting[0]->places;
  Box box;
  for (const Triangle& t : triangles)
    for (const std::uint32_t v : t) box.include({all[v].x, all[v].y, all[v].z});
  const Grid grid = fit_samples(box, kSamples, Padding{});
  lattice_ = {{static_cast<float>(grid.origin.x), static_cast<float>(grid.origin.y), static_cast<float>(grid.origin.z)},
              static_cast<float>(grid.max_spacing()),
              {static_cast<std::size_t>(grid.size.x), static_cast<std::size_t>(grid.size.y),
               static_cast<std::size_t>(grid.size.z)}};
  thickness_ = kReach * lattice_.spacing;
  distances_.resize(lattice_.samples());
  ComputeOptions options;
  options.hash_mesh = false;
  options.execution.backend = Backend::cpu;
  compute_into({{&all[0].x, all.size()}, triangles}, grid, thickness_, distances_, options);
}

std::int64_t Occlusion::bytes(std::int64_t triangles, std::int64_t vertices) {
  const Grid most{{kSamples, kSamples, kSamples}, {}, {1, 1, 1}};
  return memory_needed(std::max(triangles, std::int64_t{1}), most, kReach, {}, true) +
         static_cast<std::int64_t>(sizeof(float)) * most.sample_count() +
         static_cast<std::int64_t>(sizeof(Triangle)) * triangles + static_cast<std::int64_t>(sizeof(Float3)) * vertices;
}

float Occlusion::distance(Float3 place) const {
  const auto cell = lattice_.cell(place);
  return cell ? lattice_.interpolate(*cell, [&](std::size_t sample) { return distances_[sample]; }) : thickness_;
}

Float3 Occlusion::above(Float3 point, Float3 normal) const { return point + normal * (kLeave * lattice_.spacing); }

float Occlusion::ambient(Float3 point, Float3 normal) const {
  if (distances_.empty()) return 1;
  // How much nearer than the surface itself something else is, at a few heights above it (Evans 2006).
  constexpr struct { float height, weight; } kTaps[] = {{kLeave, 0.30F}, {3, 0.30F}, {6, 0.25F}, {11, 0.25F}};
  float missing = 0;
  for (const auto& tap : kTaps) {
    const float height = tap.height * lattice_.spacing;
    missing += tap.weight * std::max(0.0F, 1 - distance(point + normal * height) / height);
  }
  return 1 - std::min(0.85F, missing);
}

float Occlusion::lamp(Float3 place, Float3 to_lamp) const {
  if (distances_.empty()) return 1;
  const float spacing = lattice_.spacing;
  constexpr int kMostSteps = 32;
  constexpr float kSharpness = 7;  // the half shadow is 1/7 as wide as what casts it is far away
  const float farthest = 2;        // the scene's diameter
  // Farther away the field's thickness stands for greater distances, which must not look like a half shadow.
  const float farthest_known = 0.95F * kSharpness * thickness_;
  float passes = 1;
  float along = kLeave * spacing;
  for (int step = 0; step < kMostSteps && along < farthest; ++step) {
    const float d = distance(place + to_lamp * along);
    passes = std::min(passes, kSharpness * std::max(0.0F, d - 0.25F * spacing) / std::min(along, farthest_known));
    if (passes < 0.01F) return 0;
    along += std::max(d, 0.75F * spacing);
  }
  return passes * passes * (3 - 2 * passes);
}

}  // namespace standoff
