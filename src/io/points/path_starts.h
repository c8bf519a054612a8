// SPDX-License-Identifier: Apache-2.0
// Which files of points are paths, and where their lines begin: tables and PLY files as write_path() makes them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace standoff {

/// Whether the points of a file are the corners of lines, by its beginning: a table of fliers and their steps, or a PLY
/// file with edges and no faces.
bool is_path(std::string_view head);

/// The index of each line's first point, ascending: in a table where its first column changes, in a PLY file where no
/// edge leads on from the point before. `text` is the whole file, which has so many points. Errors: input (a binary PLY
/// file).
std::vector<std::size_t> path_starts(const std::string& name, std::string_view text, std::size_t points);

}  // namespace standoff
