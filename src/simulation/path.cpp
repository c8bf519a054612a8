// SPDX-License-Identifier: Apache-2.0
// Paths as tables and as polylines.
#include <array>
#include <charconv>
#include <string>

#include "core/guarded.h"
#include "files/atomic_file.h"
#include "standoff/experimental/simulation.h"

namespace standoff::experimental {
namespace {

void write(AtomicFile& file, const std::string& text) { file.write(text.data(), text.size()); }

std::string exact(Vec3 p, char between) {
  std::string text;
  for (const double c : {p.x, p.y, p.z}) {
    // Not printf, which follows the locale.
    std::array<char, 32> number;
    const auto end = std::to_chars(number.begin(), number.end(), c, std::chars_format::general, 17).ptr;
    text.append(number.begin(), end) += between;
  }
  text.back() = '\n';
  return text;
}

void write_csv(AtomicFile& file, std::span<const PathPoint> points) {
  write(file, "flier,step,x,y,z\n");
  for (const PathPoint& p : points)
    write(file, std::to_string(p.flier) + ',' + std::to_string(p.step) + ',' + exact(p.point, ','));
}

void write_ply(AtomicFile& file, std::span<const PathPoint> points) {
  std::size_t edges = 0;
  for (std::size_t n = 1; n < points.size(); ++n) edges += points[n].flier == points[n - 1].flier;
  write(file, "ply\nformat ascii 1.0\nelement vertex " + std::to_string(points.size()) +
                  "\nproperty double x\nproperty double y\nproperty double z\nelement edge " + std::to_string(edges) +
                  "\nproperty int vertex1\nproperty int vertex2\nend_header\n");
  for (const PathPoint& p : points) write(file, exact(p.point, ' '));
  for (std::size_t n = 1; n < points.size(); ++n)
    if (points[n].flier == points[n - 1].flier) write(file, std::to_string(n - 1) + ' ' + std::to_string(n) + '\n');
}

}  // namespace

void write_path(const std::filesystem::path& path, std::span<const PathPoint> points, Existing existing) try {
  const std::string extension = path.extension().string();
  if (extension != ".csv" && extension != ".ply")
    throw Error(ErrorCode::usage,
                path.string() + ": a path is written as .csv or .ply; give the file one of these names");
  AtomicFile file(path, existing);
  if (extension == ".csv")
    write_csv(file, points);
  else
    write_ply(file, points);
  file.commit();
} catch (...) {
  throw_as_error("path");
}

}  // namespace standoff::experimental
