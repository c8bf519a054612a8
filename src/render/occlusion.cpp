// SPDX-License-Identifier: Apache-2.0
#include "render/occlusion.h"

#include "standoff/compute.h"
#include "standoff/mesh.h"

namespace standoff {
namespace {

constexpr std::int64_t kSamples = 96;  // along the longest side: shadows and creases of 1/50 of the scene
constexpr float kReach = 12;           // thickness of the band in spacings: how far a crease darkens
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
  MeshView mesh;
  if (casting.size() == 1) {
    mesh = {{&casting[0]->places[0].x, casting[0]->places.size()}, casting[0]->triangles};
  } else {
    for (const DrawnPart* part : casting) {
      const auto first = static_cast<std::uint32_t>(places.size());
      places.insert(places.end(), part->places.begin(), part->places.end());
      for (const Triangle& t : part->triangles) triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
    mesh = {{&places[0].x, places.size()}, triangles};
  }
  Box box;
  for (const DrawnPart* part : casting)
    for (std::size_t v = 0; v < part->places.size(); ++v)
      if (part->is_used(v)) box.include({part->places[v].x, part->places[v].y, part->places[v].z});
  const Grid grid = fit_samples(box, kSamples, Padding{});
  spacing_ = static_cast<float>(grid.max_spacing());
  thickness_ = kReach * spacing_;
  origin_ = {static_cast<float>(grid.origin.x), static_cast<float>(grid.origin.y), static_cast<float>(grid.origin.z)};
  size_[0] = static_cast<int>(grid.size.x);
  size_[1] = static_cast<int>(grid.size.y);
  size_[2] = static_cast<int>(grid.size.z);
  distances_.resize(static_cast<std::size_t>(grid.sample_count()));
  ComputeOptions options;
  options.hash_mesh = false;
  options.execution.backend = Backend::cpu;
  compute_into(mesh, grid, thickness_, distances_, options);
}

std::int64_t Occlusion::bytes(std::int64_t triangles, std::int64_t vertices) {
  const Grid most{{kSamples, kSamples, kSamples}, {}, {1, 1, 1}};
  return memory_needed(std::max(triangles, std::int64_t{1}), most, kReach, {}, true) +
         static_cast<std::int64_t>(sizeof(float)) * most.sample_count() +
         static_cast<std::int64_t>(sizeof(Triangle)) * triangles + static_cast<std::int64_t>(sizeof(Float3)) * vertices;
}

float Occlusion::distance(Float3 point) const {
  int cell[3];
  float t[3];
  const float at[3] = {(point.x - origin_.x) / spacing_, (point.y - origin_.y) / spacing_,
                       (point.z - origin_.z) / spacing_};
  for (int a = 0; a < 3; ++a) {
    if (!(at[a] >= 0 && at[a] < static_cast<float>(size_[a] - 1))) return thickness_;
    cell[a] = static_cast<int>(at[a]);
    t[a] = at[a] - static_cast<float>(cell[a]);
  }
  const std::size_t row = static_cast<std::size_t>(size_[0]), slice = row * static_cast<std::size_t>(size_[1]);
  const float* d = distances_.data() + static_cast<std::size_t>(cell[0]) + row * static_cast<std::size_t>(cell[1]) +
                   slice * static_cast<std::size_t>(cell[2]);
  const auto along_x = [&](const float* p) { return p[0] + (p[1] - p[0]) * t[0]; };
  const float low = along_x(d) + (along_x(d + row) - along_x(d)) * t[1];
  const float high = along_x(d + slice) + (along_x(d + slice + row) - along_x(d + slice)) * t[1];
  return low + (high - low) * t[2];
}

float Occlusion::ambient(Float3 point, Float3 normal) const {
  if (distances_.empty()) return 1;
  // How much nearer than the surface itself something else is, at a few heights above it (Evans 2006).
  constexpr struct { float height, weight; } kTaps[] = {{kLeave, 0.30F}, {3, 0.30F}, {6, 0.25F}, {11, 0.25F}};
  float missing = 0;
  for (const auto& tap : kTaps) {
    const float height = tap.height * spacing_;
    missing += tap.weight * std::max(0.0F, 1 - distance(point + normal * height) / height);
  }
  return 1 - std::min(0.85F, missing);
}

float Occlusion::lamp(Float3 point, Float3 normal, Float3 to_lamp) const {
  if (distances_.empty()) return 1;
  const Float3 start = point + normal * (kLeave * spacing_);
  constexpr int kMostSteps = 32;
  constexpr float kSharpness = 7;  // the half shadow is 1/7 as wide as what casts it is far away
  const float farthest = 2;        // the scene's diameter
  // Farther away the field's thickness stands for greater distances, which must not look like a half shadow.
  const float farthest_known = 0.95F * kSharpness * thickness_;
  float passes = 1;
  float along = kLeave * spacing_;
  for (int step = 0; step < kMostSteps && along < farthest; ++step) {
    const float d = distance(start + to_lamp * along);
    passes = std::min(passes, kSharpness * std::max(0.0F, d - 0.25F * spacing_) / std::min(along, farthest_known));
    if (passes < 0.01F) return 0;
    along += std::max(d, 0.75F * spacing_);
  }
  return passes * passes * (3 - 2 * passes);
}

}  // namespace standoff
