// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/diagnose.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "core/tile_count.h"
#include "geometry/predicates.h"
#include "sign/diagnosis/boundary.h"
#include "sign/diagnosis/closed.h"
#include "sign/diagnosis/mesh_edges.h"
#include "sign/diagnosis/openness.h"
#include "sign/oriented_mesh.h"
#include "sign/rows/row_crossings.h"
#include "standoff/mesh_report.h"
#include "standoff/sign.h"

namespace standoff {

// Which winding numbers occur.

namespace {

// An estimate of the pairs of a triangle and a row through its box, by the boxes' areas, if there are `rows` by `rows`
// rows.
double tests_of(MeshView mesh, const Box& bounds, std::int64_t rows) {
  double share = 0;
  const Vec3 whole = bounds.extent();
  if (!(whole.y > 0 && whole.z > 0)) return 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Box box;
    for (const Vec3& corner : mesh.corners(t)) box.include(corner);
    share += box.extent().y / whole.y * (box.extent().z / whole.z);
  }
  return share * static_cast<double>(rows * rows);
}

// A grid through the bounds: 1024 samples in each of `rows` by `rows` rows, in the middle of cells of equal size.
Grid samples_in(const Box& bounds, std::int64_t rows) {
  Grid grid;
  grid.size = {1024, rows, rows};
  const Vec3 cells{1024, static_cast<double>(rows), static_cast<double>(rows)};
  Vec3 extent = bounds.extent();
  for (double* side : {&extent.x, &extent.y, &extent.z})
    if (!(*side > 0)) *side = 1;  // no sample can be inside
  grid.spacing = extent / cells;
  grid.origin = bounds.min + grid.spacing * 0.5;
  return grid;
}

struct WindingRange {
  std::int32_t least = 0, most = 0;
};

constexpr std::int64_t kMostRows = 128;           // to a side
constexpr std::int64_t kCrossingBytes = 1 << 18;  // what crossings may take at a time, where that is enough

// Thousands of shells inside each other have very many crossings, and show most of their winding numbers in any row.
std::int64_t rows_for(MeshView mesh, const Box& bounds) {
  constexpr double kMostTests = 2e7;
  std::int64_t rows = kMostRows;
  for (double tests = tests_of(mesh, bounds, rows); tests > kMostTests && rows > 8; tests /= 4) rows /= 2;
  return rows;
}

struct CrossingCounts {
  std::int64_t all = 0, most_of_tiles = 0;  // of the 64 rows of some tiles
};

// The most crossings that the rows through the middle of `rows` by `rows` cells may have, by the boxes of triangles.
CrossingCounts most_crossings(MeshView mesh, const Box& bounds, std::int64_t rows) {
  const std::int64_t tiles = tiles_along(rows);
  std::vector<std::int64_t> of_tiles(static_cast<std::size_t>(tiles * tiles));
  // Widened by more than rounding.
  const auto first = [&](double at, double low, double extent) {
    const double row = extent > 0 ? (at - low) / extent * static_cast<double>(rows) - 0.5 : 0;
    return static_cast<std::int64_t>(std::clamp(std::ceil(row - 1e-6), 0.0, static_cast<double>(rows)));
  };
  const auto last = [&](double at, double low, double extent) {
    const double row = extent > 0 ? (at - low) / extent * static_cast<double>(rows) - 0.5 : static_cast<double>(rows);
    return static_cast<std::int64_t>(std::clamp(std::floor(row + 1e-6), -1.0, static_cast<double>(rows - 1)));
  };
  const Vec3 low = bounds.min, extent = bounds.extent();
  CrossingCounts found;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Box box;
    for (const Vec3& corner : mesh.corners(t)) box.include(corner);
    const std::int64_t y_begin = first(box.min.y, low.y, extent.y), y_last = last(box.max.y, low.y, extent.y),
                       z_begin = first(box.min.z, low.z, extent.z), z_last = last(box.max.z, low.z, extent.z);
    for (std::int64_t z = z_begin; z <= z_last; ++z)
      for (std::int64_t y = y_begin; y <= y_last; ++y)
        ++of_tiles[static_cast<std::size_t>(y / kTileSide + tiles * (z / kTileSide))], ++found.all;
  }
  found.most_of_tiles = *std::ranges::max_element(of_tiles);
  return found;
}

// The least and the largest winding number at 1024 samples of each of 128 x 128 rows along x through the bounds, or of
// fewer rows where triangles cover many of them. It is exact there, and sees nothing between the samples. Requires a
// mesh that is closed in the orientation given. Runs on the threads of the calling TBB arena.
WindingRange find_winding_range(const OrientedMesh& mesh, const Box& bounds) {
  const ProgressCallback none;
  ProgressMeter progress(none);
  const Grid grid = samples_in(bounds, rows_for(mesh.mesh, bounds));
  RowCrossings crossings(mesh, grid, progress, kCrossingBytes);
  WindingRange range;
  const std::int64_t tiles_y = tiles_along(grid.size.y), rows_of_tiles = tiles_y * tiles_along(grid.size.z);
  for (std::int64_t first = 0, end = 0; first < rows_of_tiles; first = end) {
    end = std::min(rows_of_tiles, crossings.load(first));
    for (std::int64_t tiles = first; tiles < end; ++tiles) {
      const std::span<const RowCrossing> row = crossings.of_tiles(tiles % tiles_y, tiles / tiles_y);
      std::int32_t winding = 0;
      for (std::size_t n = 0; n < row.size(); ++n) {
        if (n > 0 && row[n].row() != row[n - 1].row()) winding = 0;
        winding += row[n].step();
        const bool last = n + 1 == row.size() || row[n + 1].row() != row[n].row() || row[n + 1].past() != row[n].past();
        if (!last) continue;
        range.least = std::min(range.least, winding);
        range.most = std::max(range.most, winding);
      }
    }
  }
  return range;
}

}  // namespace

std::int64_t winding_range_bytes(MeshView mesh, int threads) {
  const Box box = bounds(mesh);
  const std::int64_t rows = rows_for(mesh, box);
  const auto triangles = static_cast<std::int64_t>(mesh.triangles.size());
  const CrossingCounts most = most_crossings(mesh, box, rows);
  const std::int64_t limit = std::max(kCrossingBytes, RowCrossings::least_bytes(triangles, threads));
  // Crossings are found row by row only where those of the 64 rows of some tiles do not fit.
  const bool fit = RowCrossings::least_bytes(most.most_of_tiles, threads) <= limit;
  return std::min(limit, RowCrossings::least_bytes(most.all, threads)) +
         RowCrossings::other_bytes(fit ? 0 : triangles, samples_in(box, rows), threads);
}

std::int64_t winding_range_bytes(std::int64_t triangles, int threads) {
  return std::max(kCrossingBytes, RowCrossings::least_bytes(triangles, threads)) +
         RowCrossings::other_bytes(triangles, samples_in({{0, 0, 0}, {1, 1, 1}}, kMostRows), threads);
}

std::string counted(std::int64_t n, const char* one, const char* many) {
  return std::to_string(n) + ' ' + (n == 1 ? one : many);
}

// Which sign method fits a mesh.

namespace {

// An open mesh has no inside if it is open in two ways: its openness (openness.h), and the area of its caps as a share
// of its own, are at least this. Both are 0.2 for a cube without a lid, at least 0.36 for a hemisphere, and about 0.9
// for terrain. Cracks and T-junctions have no openness, whatever caps they need. Walls within a body need small caps,
// whatever the winding numbers beside them.
constexpr double kSheet = 1.0 / 3;
// It has no inside either, but is a crumpled sheet, if its |volume| with closed holes is at most this times area^1.5.
// The ratio is 0.094 for a ball, and 3.5e-4 for a plate as thick as a thousandth of its sides.
constexpr double kSheetVolume = 1e-4;

// Caps close no holes if they take more than kCrackCaps of the area and more than kCrackRatio times the openness: then
// triangles or faces are there once more that share no edges with their neighbours, but lie beside them. The ratio is 1
// to 2 for random holes in up to 40 % of a ball, and for a hemisphere or a flat sheet.
constexpr double kCrackCaps = 0.1, kCrackRatio = 4;
bool is_cracked(const MeshReport& report) {
  return report.cap_share > kCrackCaps && report.cap_share > kCrackRatio * report.openness;
}

// An open mesh may enclose something if its openness is less than kFlat: terrain is above, a half-open body below. So
// may a mesh of more than kFewPatches patches, whose openness depends on their orientations.
constexpr double kFlat = 0.8;
constexpr std::int64_t kFewPatches = 3;

// Parts that are there in both orientations and count for nothing are named if they have kNamedShare of the area. With
// kDoubtfulShare they make the sign doubtful.
constexpr double kNamedShare = 0.01, kDoubtfulShare = 0.1;

struct Recommendation {
  SignMethod method = SignMethod::none;
  bool sure = false;
  std::string why;  // one sentence without a capital and a full stop
};

// Findings that the report does not hold.
struct Findings {
  double area_used;  // of the triangles in use
  bool even;         // whether each edge has an even number of triangles
  Cracks cracks;
};

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, share < 0.0995 ? "%.2g %%" : "%.0f %%", 100 * share);
  return text;
}

// The repairs of the mesh, as the beginning of a sentence.
std::string after_repairs(const MeshReport& report) {
  std::string done;
  if (report.flipped > 0) done = counted(report.flipped, "triangle", "triangles") + " flipped";
  if (report.left_out > 0)
    done += (done.empty() ? "" : " and ") + counted(report.left_out, "triangle", "triangles") + " left out";
  return done.empty() ? "" : "with " + done + " ";
}

constexpr const char* kTwoSides = " (nearly every face is there in both orientations, and one of each pair is used)";

bool has_no_volume(const MeshReport& report, double area, double limit) {
  return !(std::abs(report.volume) > limit * area * std::sqrt(area));
}

Recommendation closed(const MeshReport& report, double area) {
  // Volumes of solids may add up to 0: one and its equal inside out. Then some winding number is not 0.
  if (report.most_winding == 0 && has_no_volume(report, area, kNoVolume))
    return {SignMethod::none, true, "the mesh is closed, but has no volume: there is no inside"};
  const std::string is_closed = after_repairs(report) + "the mesh is closed";
  if (report.two_sided) return {SignMethod::winding, false, is_closed + kTwoSides};
  if (!report.nesting_known)
    return {SignMethod::winding, false,
            is_closed + ", but it has too many parts to find out which of them are cavities"};
  if (report.least_winding < 0)
    return {SignMethod::winding, true, is_closed + "; some winding numbers are negative, and count as outside"};
  return {SignMethod::winding, true, is_closed + ", so that each winding number is an integer"};
}

// Advice for an open mesh that may enclose something after all.
std::string advice_if_it_encloses(bool has_volume) {
  return std::string("; if it does enclose something, ") +
         (has_volume ? "`winding` closes its holes by a smooth surface, and " : "") +
         "`flood` takes gaps narrower than a spacing for closed";
}

// Triangles of a cracked mesh cannot be made consistent with neighbours that they do not touch.
Recommendation cracked(const MeshReport& report) {
  return {SignMethod::flood, false,
          "the mesh is open along " + counted(report.boundary_edges, "edge", "edges") +
              ", and the orientation of its triangles does not tell inside from outside; but its gaps are cracks, at "
              "most " +
              percent(kCrackWidth) +
              " of its extent wide: `flood` takes gaps narrower than a spacing for closed, and finds what is enclosed"};
}

Recommendation open(const MeshReport& report, double area) {
  const std::string is_open = "the mesh is open";
  const std::string holes = ", and closing its " + counted(report.boundary_loops, "hole", "holes") + " takes " +
                            percent(report.cap_share) + " of its area";
  const bool flat = has_no_volume(report, area, kSheetVolume);
  if (std::min(report.openness, report.cap_share) >= kSheet || flat)
    return {SignMethod::none, false,
            is_open + holes +
                ": it is a sheet rather than a body, and has no inside; `normal` tells its front from its back, "
                "`shell` makes it a solid" +
                (report.openness < kFlat || report.patches > kFewPatches
                     ? advice_if_it_encloses(!flat && report.openness < kFlat)
                     : "")};
  if (report.volume < 0)
    return {SignMethod::none, false,
            is_open +
                ", and its triangles look inwards: nothing has a positive winding number; turn them, or take "
                "`winding` with the rule nonzero, or `flood` if its gaps are narrower than a spacing"};
  const bool cracked = is_cracked(report);
  return {
      SignMethod::winding, false,
      after_repairs(report) + is_open +
          (cracked ? " along " + counted(report.boundary_edges, "edge", "edges") + ", but its triangles fit together"
                   : holes) +
          (report.two_sided ? kTwoSides : "") + ": the generalised winding number decides, with doubt near the " +
          (cracked ? "gaps" : "holes")};
}

Recommendation by_shape(const MeshReport& report, const Findings& findings) {
  if (report.triangles == 0) return {SignMethod::none, true, "there are no triangles"};
  if (!(findings.area_used > 0)) return {SignMethod::none, true, "no triangle has an area"};
  if (report.unorientable > 0) {
    const std::string text = counted(report.unorientable, "patch has", "patches have") + " but one side";
    if (findings.even)
      return {SignMethod::flood, false, text + ", and no edge is open: `flood` finds what is enclosed"};
    return {
        SignMethod::none, false,
        text + ", and there are open edges: it has no inside; `shell` makes it a solid" + advice_if_it_encloses(false)};
  }
  if (report.boundary_edges == 0) return closed(report, findings.area_used);
  const Recommendation fitting = open(report, findings.area_used);
  // A sheet that is folded over itself along a crack has no open edge left either, but a flood finds nothing in it.
  const bool doubtful = fitting.method == SignMethod::none || findings.cracks.inconsistent_edges > 0;
  return findings.cracks.all && doubtful ? cracked(report) : fitting;
}

// Looks at the figures of the report that diagnose() finds, whose `method` is not set yet.
Recommendation recommend(const MeshReport& report, const Findings& findings) {
  Recommendation fitting = by_shape(report, findings);
  if (report.cancelled_parts == 0 || !(report.cancelled_share >= kNamedShare)) return fitting;
  fitting.sure = fitting.sure && report.cancelled_share < kDoubtfulShare;
  const bool one = report.cancelled_parts == 1;
  fitting.why += "; " + counted(report.cancelled_parts, "part", "parts") + " with " + percent(report.cancelled_share) +
                 " of the area " + (one ? "is" : "are") + " there in both orientations, without an inside, and " +
                 (one ? "is" : "are") + " left out: `shell` makes solids of sheets";
  return fitting;
}

// The diagnosis.

bool is_degenerate(const Corners& t) {
  const Vec3 u = t[1] - t[0], v = t[2] - t[0];
  // A longer normal is no result of rounding.
  if (max_norm(cross(u, v)) > 1e-14 * max_norm(u) * max_norm(v)) return false;
  return normal_direction(t) == Vec3{};
}

void add_triangles(MeshView mesh, MeshReport& found) {
  found.triangles = static_cast<std::int64_t>(mesh.triangles.size());
  found.bounds = bounds(mesh);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Corners corners = mesh.corners(t);
    found.area += length(cross(corners[1] - corners[0], corners[2] - corners[0])) / 2;
    found.degenerate += is_degenerate(corners);
  }
}

void add_orientation(const Orientation& orientation, MeshReport& found) {
  found.duplicate = orientation.repeated;
  found.duplicate_same = orientation.same;
  found.duplicate_opposite = orientation.opposite;
  found.two_sided = orientation.two_sided;
  found.inconsistent_edges = orientation.inconsistent_before;
  found.flipped = orientation.flipped;
  found.left_out = orientation.left_out;
  found.cancelled_parts = orientation.cancelled_parts;
  found.cancelled_share = orientation.cancelled_share;
  found.inconsistent_after = orientation.inconsistent_after;
  found.unorientable = orientation.unorientable;
  found.patches = orientation.patches;
  found.boundary_edges = orientation.boundary_edges;
  found.nesting_known = orientation.nesting_known;
}

// Reports the boundary, and returns the sums of its caps. Volumes are relative to the centre of the bounds.
CapSums add_boundary(const Boundary& boundary, MeshReport& found) {
  found.boundary_loops = static_cast<std::int64_t>(boundary.loops());
  for (std::size_t n = 0; n < boundary.loops(); ++n) {
    const std::span<const BoundaryEdge> loop = boundary.loop(n);
    found.boundary_length += length_of(loop);
    found.largest_hole = std::max(found.largest_hole, diameter_of(loop));
  }
  CapSums caps;
  for_each_polygon(boundary, [&](const BoundaryPolygon& polygon) {
    const CapSums cap = cap_sums_of(polygon, found.bounds.center());
    caps.area += cap.area;
    caps.volume += cap.volume;
  });
  return caps;
}

PartSums sums_of(const OrientedMesh& mesh, const Vec3& relative_to) {
  PartSums sums;
  for (std::size_t t = 0; t < mesh.mesh.triangles.size(); ++t) {
    if (mesh.use_of(t) == 0) continue;
    const auto [a, b, c] = mesh.corners(t);
    sums.add(a, b, c, relative_to);
  }
  return sums;
}

}  // namespace

Diagnosis diagnose(MeshView mesh, const MeshEdges& edges, ProgressMeter& progress) {
  Diagnosis all;
  MeshReport& found = all.report;
  add_triangles(mesh, found);
  progress.check();
  found.positions = edges.positions();
  for_each_edge(edges, {}, [&](std::span<const HalfEdge> sides) {
    found.open_edges += sides.size() == 1;
    found.nonmanifold_edges += sides.size() > 2;
  });
  progress.check();
  all.orientation = orient(mesh, edges);
  progress.check();
  add_orientation(all.orientation, found);
  const OrientedMesh oriented{mesh, all.orientation.use};
  all.boundary = net_boundary(oriented, edges);
  progress.check();
  const PartSums sums = sums_of(oriented, found.bounds.center());
  const CapSums caps = add_boundary(all.boundary, found);
  progress.check();
  found.cap_share = sums.area > 0 ? caps.area / sums.area : 0;
  found.openness = openness_of(oriented, all.boundary);
  progress.check();
  found.volume = sums.volume + (is_cracked(found) ? 0 : caps.volume);
  if (found.closed()) {
    const WindingRange range = find_winding_range(oriented, found.bounds);
    found.least_winding = range.least;
    found.most_winding = range.most;
  }
  const bool even = found.unorientable > 0 && is_closed(mesh).unoriented;
  const Cracks cracks = found.closed() ? Cracks() : find_cracks(mesh, edges);
  progress.check();
  const Recommendation fitting = recommend(found, {sums.area, even, cracks});
  found.method = fitting.method;
  found.sure = fitting.sure;
  found.why = fitting.why;
  return all;
}

}  // namespace standoff
