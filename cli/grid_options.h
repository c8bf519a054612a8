// SPDX-License-Identifier: Apache-2.0
// The grid of `standoff compute`, from its options.
#pragma once

#include <optional>

#include <CLI/CLI.hpp>

#include "cli/parse.h"
#include "standoff/grid.h"

namespace standoff::cli {

/// A grid, and the thickness in world units.
struct GridChoice {
  Grid grid;
  double thickness;
};

class GridOptions {
 public:
  /// `samples`: on the longest side where nothing is said.
  explicit GridOptions(std::int64_t samples = kDefaultSamples) : samples_(samples) {}

  /// Adds -r, --spacing, --size, --bounds, --padding and --thickness, and says which exclude which.
  void add_to(CLI::App& verb);
  /// The same but for --thickness, for verbs that compute no field.
  void add_without_thickness_to(CLI::App& verb);

  /// Whether any of them was given.
  bool given() const { return samples_given_ || spacing_ || size_ || bounds_ || padding_; }
  /// Whether one was given that says more than how many samples the longest side has.
  bool shape_given() const { return spacing_ || size_ || bounds_ || padding_; }

  /// Adds --minimum and --speed, which exclude some of those. Call after it.
  void add_thesis_to(CLI::App& verb);

  /// The grid for a mesh with the given bounds. Errors: usage.
  GridChoice choose(const Box& mesh) const;

 private:
  Grid around(const Box& box) const;
  Padding padding() const;

  std::int64_t samples_;
  bool samples_given_ = false;
  std::optional<Vec3> spacing_;
  std::optional<Size3> size_;
  std::optional<double> minimum_;
  double speed_ = 0;
  std::optional<Box> bounds_;
  std::optional<double> padding_;  // samples
  Thickness thickness_{std::numeric_limits<double>::infinity()};
};

}  // namespace standoff::cli
