// SPDX-License-Identifier: Apache-2.0
#include "standoff/confidence.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "core/guarded.h"
#include "core/mesh_copy.h"
#include "core/threads.h"
#include "sign/flood/flood.h"
#include "sign/open_winding/cap_tree.h"
#include "sign/open_winding/open_winding.h"
#include "sign/plan.h"
#include "sign/rows/row_crossings.h"
#include "sign/sign_field.h"
#include "sign/sign_text.h"
#include "standoff/error.h"

namespace standoff {
namespace {

constexpr const char* kFewerSamples = "take fewer samples, or provide more memory";
constexpr double kMarginError = 1e-3, kDoubtful = 0.05;

// Rotates the axes: from x, y, z to y, z, x.
Vec3 rotated(const Vec3& v) { return {v.y, v.z, v.x}; }
Grid rotated(const Grid& grid) {
  const auto rotated_counts = [](const Size3& s) { return Size3{s.y, s.z, s.x}; };
  return {rotated_counts(grid.size), rotated(grid.origin), rotated(grid.spacing), rotated_counts(grid.first)};
}
Mesh rotated(Mesh mesh) {
  for (Vec3& v : mesh.vertices) v = rotated(v);
  return mesh;
}

SampleBits parities_along_x(const Mesh& mesh, const Grid& grid, ProgressMeter& progress) {
  IntegerWinding parity({mesh}, grid, WindingRule::odd, progress);
  return bits_of(parity, false, grid, progress);
}

struct ConfidenceCounts {
  std::int64_t samples = 0, doubtful = 0, axes = 0, flood = 0;
  friend ConfidenceCounts operator+(const ConfidenceCounts& a, const ConfidenceCounts& b) {
    return {a.samples + b.samples, a.doubtful + b.doubtful, a.axes + b.axes, a.flood + b.flood};
  }
};

// The sum of counts after add(counts, i, j, k) for each sample.
template <class Add>
ConfidenceCounts sum_over(const Size3& size, const Add& add) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::int64_t>(0, size.y * size.z, 64), ConfidenceCounts{},
      [&](const auto& range, ConfidenceCounts counts) {
        for (std::int64_t row = range.begin(); row != range.end(); ++row)
          for (std::int64_t i = 0; i < size.x; ++i) add(counts, i, row % size.y, row / size.y);
        return counts;
      },
      std::plus<>());
}

}  // namespace

std::vector<float> winding_margins(MeshView mesh, const Grid& grid, const ConfidenceOptions& options) try {
  validate("confidence", options.execution, Runs::on_the_cpu);
  validate(grid);
  const SignOptions by_winding{.method = SignMethod::winding, .as_oriented = options.sign.as_oriented};
  validate(by_winding);
  validate(mesh);
  ProgressMeter meter(options.progress);
  std::vector<float> margins(static_cast<std::size_t>(grid.sample_count()), 0.5f);
  Threads(options.execution.threads).run([&] {
    meter.stage("confidence", 1, 0, 1);
    const SignPlan plan = plan_sign(mesh, by_winding, meter);
    if (plan.boundary.edges.empty()) return;
    const auto caps = std::make_shared<const Caps>(plan.boundary, meter);
    OpenWinding winding({mesh, plan.use}, caps, grid, WindingRule::positive, meter);
    const std::int64_t tiles_y = tiles_along(grid.size.y), rows_of_tiles = tiles_y * tiles_along(grid.size.z);
    for (std::int64_t first = 0, end; first < rows_of_tiles; first = end) {
      end = winding.load(first);
      tbb::parallel_for(first, end, [&](std::int64_t tiles) {
        WorkCheck check(meter, kLooks);
        const std::int64_t low_y = kTileSide * (tiles % tiles_y), low_z = kTileSide * (tiles / tiles_y);
        for (std::int64_t k = low_z; k < std::min(low_z + kTileSide, grid.size.z); ++k)
          for (std::int64_t j = low_y; j < std::min(low_y + kTileSide, grid.size.y); ++j)
            for (std::int64_t i = 0; i < grid.size.x; ++i) {
              const double w = winding.winding_number(i, j, k, kMarginError, check);
              const double margin = std::max(0.0, 0.5 - std::abs(w - std::round(w)));
              margins[static_cast<std::size_t>(grid.index(i, j, k))] = static_cast<float>(margin);
            }
      });
    }
  });
  meter.stage("done", 1, 1, 1);
  return margins;
} catch (...) {
  throw_as_error("confidence", kFewerSamples);
}

SignConfidence sign_confidence(MeshView mesh, const DistanceField& field, const std::vector<float>& margins,
                               const ConfidenceOptions& options) try {
  validate("confidence", options.execution, Runs::on_the_cpu);
  validate(mesh);
  const Grid grid = field.grid();
  if (static_cast<std::int64_t>(margins.size()) != grid.sample_count())
    throw Error(ErrorCode::usage, "confidence: there must be a margin for each of the field's " +
                                      std::to_string(grid.sample_count()) +
                                      " samples; take winding_margins() of its grid");
  ProgressMeter meter(options.progress);
  ConfidenceCounts counts;
  Threads(options.execution.threads).run([&] {
    meter.stage("confidence", 1, 0, 1);
    // Lines along x, y and z, each as rows along x of a mesh with rotated axes.
    const Mesh as_it_is = copy_of(mesh), along_y = rotated(as_it_is), along_z = rotated(along_y);
    const Grid grid_y = rotated(grid), grid_z = rotated(grid_y);
    const SampleBits x = parities_along_x(as_it_is, grid, meter), y = parities_along_x(along_y, grid_y, meter),
                     z = parities_along_x(along_z, grid_z, meter);
    Flood flood(mesh, grid, meter);
    const auto sign = sign_text_in(field.provenance().sign);
    const SampleBits flooded = bits_of(flood, sign && sign->invert, grid, meter);
    const auto far = static_cast<float>(field.thickness());
    counts = sum_over(grid.size, [&](ConfidenceCounts& sum, std::int64_t i, std::int64_t j, std::int64_t k) {
      const float value = field.value(i, j, k);
      if (!(std::abs(value) < far)) return;
      ++sum.samples;
      sum.doubtful += margins[static_cast<std::size_t>(grid.index(i, j, k))] < kDoubtful;
      const bool along_x = x(i, j, k);
      sum.axes += along_x != y(j, k, i) || along_x != z(k, i, j);
      sum.flood += value != 0 && (value < 0) != flooded(i, j, k);
    });
  });
  meter.stage("done", 1, 1, 1);
  const auto share = [&](std::int64_t count) {
    return counts.samples > 0 ? static_cast<double>(count) / static_cast<double>(counts.samples) : 0;
  };
  return {counts.samples, share(counts.doubtful), share(counts.axes), share(counts.flood)};
} catch (...) {
  throw_as_error("confidence", kFewerSamples);
}

}  // namespace standoff
