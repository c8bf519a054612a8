#include "io/mesh/unfolding.h"

#include <array>
#include <charconv>
#include <string>

#include "standoff/error.h"
#include "standoff/mesh.h"

namespace standoff {
namespace {

// A vertex, its number while welding and its share of the table of those.
constexpr double kVertexBytes = sizeof(Vec3) + 4 + 24, kTriangleBytes = sizeof(Triangle), kCornerBytes = 4;
constexpr double kMiB = 1 << 20, kAlways = 192 * kMiB, kTimes = 12;

// Without exponent, as far as doubles go.
std::string whole(double number) {
  std::array<char, 320> text;
  const auto end = std::to_chars(text.begin(), text.end(), number, std::chars_format::fixed, 0).ptr;
  return {text.begin(), end};
}

}  // namespace

void check_unfolded(const FileView& file, const Unfolded& unfolded, std::uint64_t bytes) {
  const double needed =
      kVertexBytes * unfolded.vertices + kTriangleBytes * unfolded.triangles + kCornerBytes * unfolded.corners;
  const double allowed = kAlways + kTimes * static_cast<double>(bytes);
  if (needed <= allowed) return;
  throw Error(ErrorCode::limit, file.path().string() + ": its nodes place meshes until they have " +
                                    whole(unfolded.vertices) + " vertices and " + whole(unfolded.triangles) +
                                    " triangles, " + whole(needed / kMiB) + " MiB, where a file of its size may have " +
                                    whole(allowed / kMiB) +
                                    " MiB; place fewer, or write the placed triangles as STL or PLY");
}

}  // namespace standoff
