// SPDX-License-Identifier: Apache-2.0
// Points from files, a block at a time: files may hold more than memory does.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/file_view.h"
#include "standoff/vec.h"

namespace standoff {

/// What happens to points with a coordinate that is NaN, infinite or beyond kMaxCoordinate.
enum class InvalidPoints {
  reject,  ///< an error that names the first of them
  mark,    ///< all their coordinates become NaN
};

class PointReader {
 public:
  PointReader() = default;
  PointReader(const PointReader&) = delete;
  PointReader& operator=(const PointReader&) = delete;
  virtual ~PointReader() = default;

  /// Reads the next points, as many as there is room for: fewer at the end alone. Errors: input, as `FILE:WHERE: what;
  /// what to do`.
  virtual std::size_t read(std::span<Vec3> points) = 0;
  /// The numbers of the points that were read last in the column `distance`, as standoff points writes it; empty in
  /// files without one.
  std::span<const double> distances() const { return distances_; }
  /// How many points there are in all, where that is known before they are read.
  virtual std::optional<std::uint64_t> count() const { return std::nullopt; }
  /// The share that was read, 0 to 1; 0 where the end is unknown.
  virtual double fraction() const = 0;

 protected:
  std::vector<double> distances_;
};

/// Opens a file of points. Its content decides the format; "-" is text from the standard input. The names of formats
/// are in docs/formats_points.md. Errors: input.
std::unique_ptr<PointReader> open_points(const std::string& name, InvalidPoints invalid);

/// Says whether a point is valid. If not, it becomes NaN where invalid points are marked; where they are rejected, it
/// stays.
bool check_point(Vec3& point, InvalidPoints invalid);
/// The end of an error about such a point: "point 5 is not finite; ..".
std::string invalid_point(std::uint64_t number, const Vec3& point);

// Each takes what it reads; binary files are mapped.
std::unique_ptr<PointReader> text_points(LineReader lines, InvalidPoints invalid);
std::unique_ptr<PointReader> ply_points(std::unique_ptr<FileView> file, InvalidPoints invalid);
std::unique_ptr<PointReader> npy_points(std::unique_ptr<FileView> file, InvalidPoints invalid);
std::unique_ptr<PointReader> npz_points(std::unique_ptr<FileView> file, InvalidPoints invalid);

/// Whether the points of a file are the corners of lines, by its beginning: a table of fliers and their steps, or a PLY
/// file with edges and no faces.
bool is_path(std::string_view head);

/// The index of each line's first point, ascending: in a table where its first column changes, in a PLY file where no
/// edge leads on from the point before. `text` is the whole file, which has so many points. Errors: input (a binary PLY
/// file).
std::vector<std::size_t> path_starts(const std::string& name, std::string_view text, std::size_t points);

}  // namespace standoff
