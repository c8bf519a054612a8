// SPDX-License-Identifier: Apache-2.0
// The boundary of a mesh as small closed polygons, each with a cap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/progress.h"
#include "sign/diagnosis/boundary.h"
#include "standoff/mesh.h"

namespace standoff {

/// A closed polygon of few corners. Its cap is the cone of triangles (apex, next corner, corner), `weight` times each.
struct Rim {
  std::span<const Vec3> corners;  ///< in the direction of the boundary: the last one is followed by the first
  Vec3 apex;
  std::int32_t weight;  ///< positive
};

/// Polygons whose sum is the boundary: the mesh and the caps of all rims are a closed mesh.
///
/// Each loop is taken apart into polygons without repeated corners. Those of many corners are cut up: arcs of a few
/// edges are closed by chords, the chords are a polygon of fewer corners, and so on. A chord belongs to two rims, in
/// both directions, so it is not in the sum. So every rim is small, or has few corners: far rims are summed up by their
/// areas, and near ones cost little.
class Rims {
 public:
  static constexpr std::size_t kMaxCorners = 96;

  explicit Rims(const Boundary& boundary) {
    ProgressMeter nobody;
    make(boundary, nobody);
  }
  /// The progress can end it.
  Rims(const Boundary& boundary, ProgressMeter& progress) { make(boundary, progress); }

  std::size_t size() const { return apexes_.size(); }
  Rim operator[](std::size_t n) const {
    return {std::span(corners_).subspan(begin_[n], begin_[n + 1] - begin_[n]), apexes_[n], weights_[n]};
  }

 private:
  void make(const Boundary& boundary, ProgressMeter& progress);
  void add(std::vector<Vec3> polygon, std::int32_t weight);
  void add_small(std::span<const Vec3> polygon, std::int32_t weight);

  std::vector<Vec3> corners_;
  std::vector<std::size_t> begin_ = {0};  // by rim
  std::vector<Vec3> apexes_;
  std::vector<std::int32_t> weights_;
};

/// The triangles of all caps, each as often as its rim's weight says.
Mesh caps_of(const Rims& rims);

}  // namespace standoff
