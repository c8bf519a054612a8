// SPDX-License-Identifier: Apache-2.0
// Compares the fields of two programs.
#pragma once

#include <cmath>
#include <functional>
#include <span>
#include <vector>

#include <nlohmann/json.hpp>

#include "raw.h"
#include "standoff/compute.h"
#include "workload.h"

namespace standoff::bench {

/// The exact field, by standoff's default method.
inline std::vector<float> exact_field(const Workload& work) {
  std::vector<float> values(static_cast<std::size_t>(work.grid.sample_count()));
  ComputeOptions options{.sign = {SignMethod::none}, .execution = {.threads = work.threads}};
  compute_into(work.mesh, work.grid, work.thickness, values, options);
  return values;
}

/// Writes the values where the workload asks for them.
inline void save_values(const Workload& work, std::span<const float> values) {
  if (!work.values.empty()) write_raw(work.values, values.data(), values.size());
}

/// Counts the band samples of both fields, and measures the errors of `values` (clamped to the thickness).
inline nlohmann::json compare_with_exact(const Workload& work, std::span<const float> values) {
  const std::vector<float> exact = exact_field(work);
  const auto thickness = static_cast<float>(work.thickness);
  std::int64_t band = 0, band_exact = 0;
  double largest = 0, sum = 0;
  for (std::size_t n = 0; n < exact.size(); ++n) {
    band += values[n] < thickness;
    if (!(exact[n] < thickness)) continue;
    ++band_exact;
    const double difference = std::abs(static_cast<double>(values[n]) - exact[n]);
    largest = std::max(largest, difference);
    sum += difference;
  }
  const double spacing = work.grid.max_spacing();
  return {{"band", band},
          {"band_exact", band_exact},
          {"largest_error_samples", largest / spacing},
          {"mean_error_samples", band_exact ? sum / static_cast<double>(band_exact) / spacing : 0}};
}

}  // namespace standoff::bench
