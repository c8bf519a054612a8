// SPDX-License-Identifier: Apache-2.0
// Points with distances: what neural fields are trained with.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "standoff/existing.h"
#include "standoff/points.h"

namespace standoff {

struct TrainingPointOptions {
  std::int64_t count = 0;  ///< 1 to 2^31
  /// The share of points near the surface, 0 to 1, rounded to whole points; the others are uniform in the box.
  double near_share = 0.8;
  /// Standard deviations of the offsets from the surface along each axis, as shares of the box's longest side: one for
  /// every other point near it. Finite, not negative.
  std::array<double, 2> sigma{0.02, 0.005};
  std::uint64_t seed = 0;
};

struct TrainingPoints {
  std::vector<std::array<float, 3>> points;  ///< first those near the surface, then the uniform ones
  std::vector<float> distances;              ///< exact for the points as they are stored; negative inside
};

/// The points and their distances. Near the surface: a point of a triangle, all of the surface being as likely, moved
/// by a nearly gaussian offset (the sum of twelve uniform numbers, which unlike a logarithm has the same bits on every
/// machine; never more than six deviations). They depend on the mesh, the box and the options alone. Runs on `threads`
/// threads. Errors: usage (options), input (a mesh without area, if points near it are asked for), limit.
TrainingPoints training_points(const MeshQuery& query, const Box& box, const TrainingPointOptions& options,
                               int threads = 0);

/// Writes them as .npz: `points` (n, 3) and `distances` (n), both float32, and `sign`, the name of the sign's method.
/// The file appears whole or not at all. `sync`: wait until it is on the disk. Errors: output.
void write_training_points(const std::filesystem::path& path, const TrainingPoints& made, const MeshQuery& query,
                           Existing existing, bool sync);

}  // namespace standoff
