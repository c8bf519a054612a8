// SPDX-License-Identifier: Apache-2.0
#include "surface/methods.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "core/weld.h"
#include "sign/diagnosis/disjoint_sets.h"

namespace standoff {
namespace {

constexpr std::size_t kMostLostPoints = 1 << 14, kMostCornerPoints = 1 << 16, kMostLostTriangles = 1 << 16;
// A smaller share of the area is only tips of edges and needles.
constexpr double kLeastLostShare = 1e-3;

enum class Fate : std::uint8_t { elsewhere, kept, lost };

Fate fate_of(const Vec3& p, const DistanceField& field, float level) {
  const Grid& grid = field.grid();
  const Vec3 at = (p - grid.corner()) / grid.spacing;
  const auto within = [](double x, std::int64_t size) { return x >= 0 && x <= static_cast<double>(size - 1); };
  if (!within(at.x, grid.size.x) || !within(at.y, grid.size.y) || !within(at.z, grid.size.z)) return Fate::elsewhere;
  const auto cell = [](double x) { return static_cast<std::int64_t>(x); };
  const auto first = [&](double x) { return std::max<std::int64_t>(0, cell(x) - 1); };
  const auto last = [&](double x, std::int64_t size) { return std::min<std::int64_t>(size - 1, cell(x) + 2); };
  for (std::int64_t k = first(at.z); k <= last(at.z, grid.size.z); ++k)
    for (std::int64_t j = first(at.y); j <= last(at.y, grid.size.y); ++j)
      for (std::int64_t i = first(at.x); i <= last(at.x, grid.size.x); ++i)
        if (field.value(i, j, k) < level) return Fate::kept;
  return Fate::lost;
}

// The parts of a mesh, numbered in the order of their first triangles.
struct MeshParts {
  std::vector<std::uint32_t> of;     // by triangle: its part
  std::vector<std::uint32_t> first;  // by part: its first triangle
};

MeshParts mesh_parts_of(MeshView mesh) {
  std::vector<std::uint32_t> number(mesh.vertices.size());
  const std::uint32_t positions = weld([&](std::uint32_t v) { return mesh.vertices[v]; }, number);
  DisjointSets connected(positions);
  for (const Triangle& t : mesh.triangles) {
    connected.join(number[t[0]], number[t[1]]);
    connected.join(number[t[0]], number[t[2]]);
  }
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> part(positions, kNone);
  MeshParts parts;
  parts.of.reserve(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    std::uint32_t& mine = part[connected.find(number[mesh.triangles[t][0]]).set];
    if (mine == kNone) {
      mine = static_cast<std::uint32_t>(parts.first.size());
      parts.first.push_back(t);
    }
    parts.of.push_back(mine);
  }
  return parts;
}

struct PointInTriangle {
  std::uint32_t triangle;
  double u, v;  // the weights of the second and third corners
};

double triangle_area(MeshView mesh, std::size_t t) {
  const auto [a, b, c] = mesh.corners(t);
  return length(cross(b - a, c - a)) / 2;
}

// Spreads points evenly over the area in the order of the triangles, and within triangles by Roberts's sequence.
std::vector<PointInTriangle> spread_points(MeshView mesh) {
  double whole = 0, passed = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) whole += triangle_area(mesh, t);
  std::vector<PointInTriangle> points;
  if (!(whole > 0) || !std::isfinite(whole)) return points;
  points.reserve(kMostLostPoints);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    passed += triangle_area(mesh, t);
    const double due = std::min(passed / whole * kMostLostPoints + 0.5, double{kMostLostPoints});
    while (static_cast<double>(points.size() + 1) <= due) {
      const auto n = static_cast<double>(points.size() + 1);
      double u = std::fmod(n * 0.7548776662466927, 1), v = std::fmod(n * 0.5698402909980532, 1);
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      points.push_back({t, u, v});
    }
  }
  return points;
}

Vec3 place_in_triangle(MeshView mesh, const PointInTriangle& point) {
  const auto [a, b, c] = mesh.corners(point.triangle);
  return a + (b - a) * point.u + (c - a) * point.v;
}

std::vector<Fate> fates_of(MeshView mesh, std::span<const PointInTriangle> points, const DistanceField& field,
                           float level) {
  std::vector<Fate> fates(points.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 256), [&](const auto& range) {
    for (std::size_t n = range.begin(); n != range.end(); ++n)
      fates[n] = fate_of(place_in_triangle(mesh, points[n]), field, level);
  });
  return fates;
}

// The approximate thickness of the thinnest lost part with a volume; 0 if there is none.
double least_thickness(MeshView mesh, const MeshParts& parts, const std::vector<Fate>& fates) {
  struct Sums {
    double volume = 0, area = 0;
  };
  std::vector<Sums> sums(parts.first.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (fates[parts.of[t]] != Fate::lost) continue;
    const Vec3 origin = mesh.corners(parts.first[parts.of[t]])[0];
    const auto [a, b, c] = mesh.corners(t);
    const Vec3 normal = cross(b - a, c - a) * 0.5;
    sums[parts.of[t]].volume += dot(a - origin, normal) / 3;
    sums[parts.of[t]].area += length(normal);
  }
  double least = 0;
  for (const Sums& part : sums) {
    const double thickness = part.area > 0 ? 2 * std::abs(part.volume) / part.area : 0;
    if (thickness > 1e-6 * std::sqrt(part.area) && (least == 0 || thickness < least)) least = thickness;
  }
  return least;
}

std::string sentence_of_lost(const SurfaceReport& report) {
  if (report.lost_parts == 0 && report.lost_share < kLeastLostShare) return "";
  char share[32];
  std::snprintf(share, sizeof share, report.lost_share < 0.0995 ? "%.2g %%" : "%.0f %%", 100 * report.lost_share);
  std::string text = std::string(share) + " of the mesh's area";
  if (report.lost_parts > 0)
    text += ", " + std::to_string(report.lost_parts) + " of its " + std::to_string(report.parts) +
            (report.parts == 1 ? " part" : " parts") + " as a whole,";
  text += " is farther than a spacing from the surface: no sample is inside there; ";
  char thickness[32];
  std::snprintf(thickness, sizeof thickness, "%.3g", report.lost_thickness);
  text += report.lost_thickness > 0 ? std::string("a spacing below ") + thickness : "a finer grid";
  return text + ", the sign shell, or a positive distance from the mesh keeps it";
}

}  // namespace

void find_lost_parts(MeshView mesh, const DistanceField& field, double level, MemoryBudget& budget,
                     SurfaceReport& report, ProgressMeter& progress) {
  MemoryShare memory(budget);
  memory.take(20 * mesh.vertices.size() + 8 * mesh.triangles.size() + (kMostLostPoints + kMostCornerPoints) * 32);
  const auto at = static_cast<float>(level);
  const MeshParts parts = mesh_parts_of(mesh);
  progress.check();
  std::vector<PointInTriangle> points = spread_points(mesh);
  const std::size_t spread = points.size();
  const std::size_t extra = std::min(parts.first.size(), kMostCornerPoints);
  for (std::size_t n = 0; n < extra; ++n) points.push_back({parts.first[n], 0, 0});
  const std::vector<Fate> fates = fates_of(mesh, points, field, at);
  progress.check();

  std::vector<Fate> of_part(parts.first.size(), Fate::elsewhere);
  std::size_t lost = 0, counted = 0;
  for (std::size_t n = 0; n < points.size(); ++n) {
    if (fates[n] == Fate::elsewhere) continue;
    if (n < spread) {
      ++counted;
      lost += fates[n] == Fate::lost;
    }
    Fate& part = of_part[parts.of[points[n].triangle]];
    if (part != Fate::kept) part = fates[n];
  }
  report.parts = std::ssize(parts.first);
  report.lost_share = counted > 0 ? static_cast<double>(lost) / static_cast<double>(counted) : 0;
  std::size_t looked_at = 0;
  for (std::uint32_t t = 0; t < mesh.triangles.size() && looked_at < kMostLostTriangles; ++t) {
    Fate& part = of_part[parts.of[t]];
    if (part != Fate::lost) continue;
    ++looked_at;
    for (const auto& [u, v] : {std::pair(0.0, 0.0), {1.0, 0.0}, {0.0, 1.0}, {1.0 / 3, 1.0 / 3}})
      if (fate_of(place_in_triangle(mesh, {t, u, v}), field, at) == Fate::kept) part = Fate::kept;
  }
  report.lost_parts = std::ranges::count(of_part, Fate::lost);
  report.lost_thickness = report.lost_parts > 0 ? least_thickness(mesh, parts, of_part) : 0;
  report.lost = sentence_of_lost(report);
}

}  // namespace standoff
