// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/scene.h"

#include <cmath>
#include <limits>
#include <utility>

#include "core/number_text.h"
#include "standoff/error.h"

namespace standoff {
namespace {

// A vertex, its number while welding and its share of the table of those.
constexpr double kVertexBytes = sizeof(Vec3) + 4 + 24, kTriangleBytes = sizeof(Triangle), kCornerBytes = 4;
constexpr double kMiB = 1 << 20, kFreeBytes = 192 * kMiB, kTimes = 12;

}  // namespace

std::optional<Placement> Placement::inverse() const {
  const auto& m = rows;
  const auto minor = [&](std::size_t r, std::size_t c) {  // with its sign
    const std::size_t r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
    return m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
  };
  const double determinant = m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
  if (!(determinant != 0) || !std::isfinite(determinant)) return std::nullopt;
  Placement made{};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) made.rows[r][c] = minor(c, r) / determinant;
    made.rows[r][3] = -(made.rows[r][0] * m[0][3] + made.rows[r][1] * m[1][3] + made.rows[r][2] * m[2][3]);
  }
  return made;
}

Placement scaling(Vec3 by) { return {{{{by.x, 0, 0, 0}, {0, by.y, 0, 0}, {0, 0, by.z, 0}}}}; }

Placement rotation_about(Vec3 a, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad), t = 1 - c;
  return {{{{t * a.x * a.x + c, t * a.x * a.y - s * a.z, t * a.x * a.z + s * a.y, 0},
            {t * a.x * a.y + s * a.z, t * a.y * a.y + c, t * a.y * a.z - s * a.x, 0},
            {t * a.x * a.z - s * a.y, t * a.y * a.z + s * a.x, t * a.z * a.z + c, 0}}}};
}

void report_axes(const Placement& root, MeshReadReport& report) {
  constexpr double kRounding = 1e-5;
  const double scale = length({root.rows[0][0], root.rows[0][1], root.rows[0][2]});
  std::array<int, 3> axes{};
  double unit = 1;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 3; ++column) {
      const double entry = root.rows[row][column], share = entry / scale;
      if (std::abs(share) < kRounding) continue;
      if (!(std::abs(std::abs(share) - 1) <= kRounding) || axes[row] != 0) return;
      axes[row] = static_cast<int>(column + 1) * (share < 0 ? -1 : 1);
      if (row == 0) unit = std::abs(entry);
    }
  if (std::abs(axes[0] * axes[1] * axes[2]) != 6) return;
  report.axes = axes;
  report.unit_scale = unit;
}

void keep_used(std::vector<Vec3>& vertices, std::vector<Triangle>& triangles) {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> number(vertices.size(), kUnused);
  std::vector<Vec3> used;
  for (Triangle& t : triangles)
    for (auto& v : t) {
      if (number[v] == kUnused) {
        number[v] = static_cast<std::uint32_t>(used.size());
        used.push_back(vertices[v]);
      }
      v = number[v];
    }
  vertices = std::move(used);
}

void check_unfolded(const FileView& file, const Unfolded& unfolded, std::uint64_t bytes) {
  const double needed =
      kVertexBytes * unfolded.vertices + kTriangleBytes * unfolded.triangles + kCornerBytes * unfolded.corners;
  const double allowed = kFreeBytes + kTimes * static_cast<double>(bytes);
  if (needed <= allowed) return;
  throw Error(ErrorCode::limit, file.path().string() + ": its nodes place meshes until they have " +
                                    whole_text(unfolded.vertices) + " vertices and " + whole_text(unfolded.triangles) +
                                    " triangles, " + whole_text(needed / kMiB) +
                                    " MiB, where a file of its size may have " + whole_text(allowed / kMiB) +
                                    " MiB; place fewer, or write the placed triangles as STL or PLY");
}

}  // namespace standoff
