// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/recommend.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include "sign/diagnosis/solid.h"

namespace standoff {
namespace {

std::string counted(std::int64_t n, const char* one, const char* many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, share < 0.0995 ? "%.2g %%" : "%.0f %%", 100 * share);
  return text;
}

// What was done to the mesh, as the beginning of a sentence.
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
  // Solids may have a sum of 0: one and its equal inside out. Then some winding number shows it.
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

// Of an open mesh that may enclose something after all.
std::string what_may_work(bool has_volume) {
  return std::string("; if it does enclose something, ") +
         (has_volume ? "`winding` closes its holes by a smooth surface, and " : "") +
         "`flood` takes gaps narrower than a spacing for closed";
}

// Triangles of a cracked mesh cannot be made consistent with neighbours they do not touch.
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
    return {
        SignMethod::none, false,
        is_open + holes +
            ": it is a sheet rather than a body, and has no inside; `normal` tells its front from its back, "
            "`shell` makes it a solid" +
            (report.openness < kFlat || report.patches > kFewPatches ? what_may_work(!flat && report.openness < kFlat)
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
    return {SignMethod::none, false,
            text + ", and there are open edges: it has no inside; `shell` makes it a solid" + what_may_work(false)};
  }
  if (report.boundary_edges == 0) return closed(report, findings.area_used);
  const Recommendation fitting = open(report, findings.area_used);
  // A sheet that was folded over itself along a crack is closed in this sense too, and a flood finds nothing in it.
  const bool doubtful = fitting.method == SignMethod::none || findings.cracks.inconsistent_edges > 0;
  return findings.cracks.all && doubtful ? cracked(report) : fitting;
}

}  // namespace

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

}  // namespace standoff
