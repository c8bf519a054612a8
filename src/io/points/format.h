// SPDX-License-Identifier: Apache-2.0
// What the readers of points share, and their functions, which formats.cpp lists.
#pragma once

#include <memory>
#include <string>

#include "files/file_view.h"
#include "io/points/point_reader.h"

namespace standoff {

/// Whether a point can be asked about. If not, it becomes NaN where invalid points are marked; where they are rejected
/// nothing is done to it.
bool check_point(Vec3& point, InvalidPoints invalid);
/// The end of an error about such a point: "point 5 is not finite; ..".
std::string invalid_point(std::uint64_t number, const Vec3& point);

// Each takes what it reads; binary files are mapped.
std::unique_ptr<PointReader> text_points(LineReader lines, InvalidPoints invalid);
std::unique_ptr<PointReader> ply_points(std::unique_ptr<FileView> file, InvalidPoints invalid);
std::unique_ptr<PointReader> npy_points(std::unique_ptr<FileView> file, InvalidPoints invalid);
std::unique_ptr<PointReader> npz_points(std::unique_ptr<FileView> file, InvalidPoints invalid);

}  // namespace standoff
