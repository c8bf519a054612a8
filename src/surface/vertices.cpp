// SPDX-License-Identifier: Apache-2.0
// Chooses the clearance of vertices and the type of their coordinates, and limits their number.
#include "surface/vertices.h"

#include <limits>
#include <string>

#include "core/number_text.h"
#include "standoff/error.h"

namespace standoff {
namespace {

// The least clearance, in spacings: far below the accuracy of interpolation.
constexpr double kLeastCrossing = 0x1p-16;
// A larger clearance for floats would move the surface by more than a thousandth of the spacing: doubles are better.
constexpr double kMostForFloats = 0x1p-10;
// The largest clearance, even if floats are asked for.
constexpr double kMostSnap = 0x1p-5;
// Rounding moves a vertex by half a unit in the last place: two vertices that differ by four remain three apart.
constexpr double kUnits = 4;

}  // namespace

EdgePoints::EdgePoints(const Grid& window, const Grid& grid, double level, Coordinates coordinates)
    : grid_(window), level_(level) {
  double far = 0;  // the largest quotient of an axis' coordinate and its spacing
  double largest = 0, least = std::numeric_limits<double>::infinity();
  const Vec3 beyond = grid.position(grid.size.x + 1, grid.size.y + 1, grid.size.z + 1);
  const Vec3 corner = grid.corner();
  const auto look = [&](double origin, double end, double spacing) {
    const double size = std::max({std::abs(origin - spacing), std::abs(end), spacing});
    far = std::max(far, size / spacing);
    largest = std::max(largest, size);
    least = std::min(least, spacing);
  };
  look(corner.x, beyond.x, grid.spacing.x);
  look(corner.y, beyond.y, grid.spacing.y);
  look(corner.z, beyond.z, grid.spacing.z);

  // A unit in the last place of a number below 2^n is 2^(n - 24), or 2^(n - 53).
  const double for_floats = std::max(kLeastCrossing, kUnits * far * 0x1p-23);
  const double for_doubles = std::max(kLeastCrossing, kUnits * far * 0x1p-52);
  const bool in_range = largest < 0x1p127 && least * kLeastCrossing > 0x1p-100;
  const bool floats_do = in_range && for_floats <= (coordinates == Coordinates::single ? kMostSnap : kMostForFloats);
  if (coordinates == Coordinates::single && !floats_do)
    throw Error(ErrorCode::limit,
                "surface: 32-bit floats do not tell vertices apart that are " + number_text(far) +
                    " spacings from the origin; take 64-bit coordinates, or move the mesh nearer to the origin");
  if (!(for_doubles <= kMostSnap))
    throw Error(ErrorCode::limit, "surface: the grid is " + number_text(far) +
                                      " spacings from the origin, too far to tell its vertices apart; move the mesh "
                                      "nearer to the origin, or take a larger spacing");
  floats_ = coordinates != Coordinates::full && floats_do;
  clearance_ = floats_ ? for_floats : for_doubles;
}

void expect_countable(std::uint64_t vertices) {
  constexpr std::uint64_t kMost = 0xfffffffe;
  if (vertices > kMost)
    throw Error(ErrorCode::limit, "surface: " + std::to_string(vertices) +
                                      " vertices are more than 32-bit indices can number; take fewer samples");
}

void grow(Mesh& mesh, std::uint64_t vertices, std::uint64_t triangles, MemoryBudget& budget) {
  const auto grow_to = [&](auto& all, std::uint64_t count) {
    if (count <= all.capacity()) return all.resize(count);
    const std::size_t before = all.capacity() * sizeof all[0];
    const std::size_t room = all.empty() ? count : std::max<std::size_t>(count, all.capacity() + all.capacity() / 2);
    budget.take(room * sizeof all[0]);
    all.reserve(room);
    budget.give_back(before);
    all.resize(count);
  };
  grow_to(mesh.vertices, vertices);
  grow_to(mesh.triangles, triangles);
}

}  // namespace standoff
