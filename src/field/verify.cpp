// SPDX-License-Identifier: Apache-2.0
#include "standoff/verify.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/execution.h"
#include "core/guarded.h"
#include "core/progress.h"
#include "core/promised_error.h"
#include "core/threads.h"
#include "field/triangle_groups.h"

namespace standoff {
namespace {

struct Sample {
  std::int64_t i, j, k;
};

std::vector<Sample> all_samples(const Size3& size) {
  std::vector<Sample> samples;
  for (std::int64_t k = 0; k < size.z; ++k)
    for (std::int64_t j = 0; j < size.y; ++j)
      for (std::int64_t i = 0; i < size.x; ++i) samples.push_back({i, j, k});
  return samples;
}

std::vector<Sample> choose_samples(const DistanceField& field, std::int64_t count, std::uint64_t seed) {
  constexpr std::int64_t side = DistanceField::kTileSide;
  const Size3 size = field.grid().size;
  if (field.grid().sample_count() <= count) return all_samples(size);
  // The generator's numbers are the same everywhere, which the standard does not promise of its distributions.
  std::mt19937_64 random(seed);
  const auto below = [&random](std::int64_t n) {
    return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(n));
  };
  std::vector<Size3> stored;
  for (const DistanceField::Tile& tile : field.tiles()) stored.push_back(tile.at);
  std::vector<Sample> samples;
  samples.reserve(static_cast<std::size_t>(count));
  for (std::int64_t n = 0; n < count; ++n) {
    if (n % 2 == 0 || stored.empty()) {
      samples.push_back({below(size.x), below(size.y), below(size.z)});
      continue;
    }
    const Size3& tile = stored[static_cast<std::size_t>(below(static_cast<std::int64_t>(stored.size())))];
    const auto within = [&](std::int64_t t, std::int64_t samples_along) {
      return t * side + below(std::min(side, samples_along - t * side));
    };
    samples.push_back({within(tile.x, size.x), within(tile.y, size.y), within(tile.z, size.z)});
  }
  return samples;
}

struct Finding {
  SampleCheck sample;
  bool in_band = false;
  bool wrong = false;
  bool nearest_wrong = false;
};

Finding check(const DistanceField& field, const TriangleGroups& groups, const Sample& at) {
  const Vec3 position = field.grid().position(at.i, at.j, at.k);
  const double distance = groups.distance(position);
  Finding finding{{at.i, at.j, at.k, position, field.value(at.i, at.j, at.k), std::min(distance, field.thickness())}};
  SampleCheck& sample = finding.sample;
  sample.allowed = allowed_error(field.grid(), sample.expected);
  // The distance alone is checked, not the side.
  sample.error = std::abs(std::abs(sample.stored) - sample.expected);
  if (std::isnan(sample.error)) sample.error = std::numeric_limits<double>::infinity();
  finding.in_band = distance <= field.thickness();
  // A grid beyond the range of double has infinite distances, which no comparison can confirm.
  finding.wrong = !(std::isfinite(distance) && sample.error <= sample.allowed);
  if (!field.has_nearest()) return finding;
  // Near the thickness rounding decides whether there is a nearest triangle.
  const std::uint32_t nearest = field.nearest(at.i, at.j, at.k);
  if (nearest == kNoTriangle)
    finding.nearest_wrong = distance < field.thickness() - sample.allowed;
  else
    finding.nearest_wrong =
        nearest >= groups.triangle_count() || groups.distance(position, nearest) > distance + sample.allowed;
  return finding;
}

}  // namespace

double allowed_error(const Grid& grid, double distance) {
  const Box box = grid.bounds();
  const double resolution = 4 * std::numeric_limits<double>::epsilon() * std::max(max_norm(box.min), max_norm(box.max));
  return promised_error(distance, grid.max_spacing()) + resolution;
}

VerifyResult verify(const DistanceField& field, MeshView mesh, const VerifyOptions& options) try {
  if (options.samples < 1) throw Error(ErrorCode::usage, "verify: at least one sample must be tested; give 1 or more");
  validate("verify", options.execution, Runs::on_the_cpu);
  validate(mesh);

  ProgressMeter progress(options.progress);
  const auto samples = choose_samples(field, options.samples, options.seed);
  std::vector<Finding> findings(samples.size());
  Threads(options.execution.threads).run([&] {
    progress.stage("sort", 1, 0, 0.05);
    const TriangleGroups groups(mesh);
    progress.stage("verify", static_cast<std::int64_t>(samples.size()), 0.05, 1);
    tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t n) {
      findings[n] = check(field, groups, samples[n]);
      progress.advance();
    });
  });

  VerifyResult result;
  result.samples = static_cast<std::int64_t>(samples.size());
  result.mesh_differs = field.provenance().mesh_hash != 0 && field.provenance().mesh_hash != content_hash(mesh);
  result.largest = result.worst = findings.front().sample;
  for (const Finding& finding : findings) {
    const SampleCheck& sample = finding.sample;
    result.samples_band += finding.in_band;
    result.samples_wrong += finding.wrong;
    result.nearest_wrong += finding.nearest_wrong;
    if (sample.error > result.largest.error) result.largest = sample;
    if (sample.error / sample.allowed > result.worst.error / result.worst.allowed) result.worst = sample;
  }
  return result;
} catch (...) {
  throw_as_error("verify", "test fewer samples, or provide more memory");
}

}  // namespace standoff
