// SPDX-License-Identifier: Apache-2.0
#include "cli/pose_file.h"

#include <string_view>

#include "cli/parse.h"
#include "files/file_view.h"
#include "standoff/error.h"

namespace standoff::cli {
namespace {

// read(numbers) of each line that holds some.
template <class T, class Read>
std::vector<T> read_lines(const std::string& name, Read read) {
  LineReader lines{InputStream(name)};
  std::vector<T> found;
  for (std::string_view line; lines.next(line);) {
    try {
      found.push_back(read(numbers_in(line)));
    } catch (const Error& error) {
      throw Error(ErrorCode::input, lines.name() + ":" + std::to_string(lines.number()) + ": " + error.what());
    }
  }
  return found;
}

}  // namespace

std::vector<Pose> read_poses(const std::string& name) { return read_lines<Pose>(name, pose_of); }

std::vector<RigidMotion> read_motions(const std::string& name, Vec3 center) {
  return read_lines<RigidMotion>(name, [center](const std::vector<double>& v) {
    const std::size_t half = v.size() / 2;
    if (half != 3 && half != 7 && half != 12)
      throw Error(ErrorCode::usage, std::to_string(v.size()) +
                                        " numbers; give those of two poses, from and to: two times x,y,z; "
                                        "x,y,z,ax,ay,az,degrees; or twelve of a 3x4 matrix");
    return RigidMotion{pose_of(std::span(v).first(half)), pose_of(std::span(v).subspan(half)), center};
  });
}

}  // namespace standoff::cli
