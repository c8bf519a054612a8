// SPDX-License-Identifier: Apache-2.0
// What formats with scenes share: nodes that place meshes, some of them many times.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "files/file_view.h"
#include "standoff/io.h"
#include "standoff/mesh.h"

namespace standoff {

/// An affine map: rows of a matrix, the shift in their last column.
struct Placement {
  std::array<std::array<double, 4>, 3> rows{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

  Vec3 operator()(Vec3 p) const {
    const auto along = [&](const std::array<double, 4>& r) { return r[0] * p.x + r[1] * p.y + r[2] * p.z + r[3]; };
    return {along(rows[0]), along(rows[1]), along(rows[2])};
  }

  /// First `inner`, then this one.
  Placement operator*(const Placement& inner) const {
    Placement both{};
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 4; ++c) {
        double sum = c == 3 ? rows[r][3] : 0;
        for (std::size_t k = 0; k < 3; ++k) sum += rows[r][k] * inner.rows[k][c];
        both.rows[r][c] = sum;
      }
    return both;
  }

  /// Whether it turns left hands into right hands.
  bool mirrors() const {
    const auto& [a, b, c] = rows;
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]) <
           0;
  }

  /// Nothing where it flattens space.
  std::optional<Placement> inverse() const;
};

Placement scaling(Vec3 by);
/// About an axis of length 1.
Placement rotation_about(Vec3 axis, double angle_rad);

/// Reports what `root`, which stands above all nodes, does to axes and unit. Where that is no such thing, but a place
/// of the file's own making, nothing is reported.
void report_axes(const Placement& root, MeshReadReport& report);

/// Leaves the vertices that triangles use, in the order of their first use.
void keep_used(std::vector<Vec3>& vertices, std::vector<Triangle>& triangles);

/// What a scene becomes once each of its nodes has a copy of its mesh. Doubles: files can ask for more than 64 bits
/// count.
struct Unfolded {
  double vertices = 0, triangles = 0;
  double corners = 0;  ///< of the longest list of corners, which is held while its triangles are made
};

/// A few bytes of a file can ask for more memory than there is: before any copy is made, throws Error{limit} where they
/// would take more than 192 MiB and twelve times the `bytes` of the file and of those that were read with it.
void check_unfolded(const FileView& file, const Unfolded& unfolded, std::uint64_t bytes);

}  // namespace standoff
