// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/unfolding.h"

#include <string>

#include "core/number_text.h"
#include "standoff/error.h"
#include "standoff/mesh.h"

namespace standoff {
namespace {

// A vertex, its number while welding and its share of the table of those.
constexpr double kVertexBytes = sizeof(Vec3) + 4 + 24, kTriangleBytes = sizeof(Triangle), kCornerBytes = 4;
constexpr double kMiB = 1 << 20, kFreeBytes = 192 * kMiB, kTimes = 12;

}  // namespace

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
