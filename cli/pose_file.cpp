// SPDX-License-Identifier: Apache-2.0
#include "cli/pose_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "cli/parse.h"
#include "files/text_file.h"
#include "standoff/error.h"
#include "standoff/io.h"

namespace standoff::cli {
namespace {

std::string standard_input() {
  std::string text;
  char part[1 << 16];
  while (const std::size_t got = std::fread(part, 1, sizeof part, stdin)) text.append(part, got);
  if (std::ferror(stdin))
    throw Error(ErrorCode::input, "standard input: cannot read it: " + std::string(std::strerror(errno)) +
                                      "; send it a file with one pose on each line");
  return text;
}

// read(numbers) of each line that holds some.
template <class T, class Read>
std::vector<T> read_lines(const std::string& name, const char* what, Read read) {
  const bool piped = name == "-";
  const std::string text = piped ? standard_input() : read_text(name), shown = piped ? "standard input" : name;
  constexpr std::string_view kMark = "\xEF\xBB\xBF";  // of UTF-8, as spreadsheets begin their files
  std::vector<T> found;
  std::size_t number = 0;
  for (std::size_t from = text.starts_with(kMark) ? kMark.size() : 0; from < text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    std::string_view line = std::string_view(text).substr(from, end - from);
    from = end + 1;
    ++number;
    line = line.substr(0, line.find('#'));
    line = line.substr(0, line.find_last_not_of(" \t\r") + 1);
    if (line.empty()) continue;
    try {
      found.push_back(read(numbers_in(line)));
    } catch (const Error& error) {
      throw Error(ErrorCode::input, shown + ":" + std::to_string(number) + ": " + error.what());
    }
  }
  if (found.empty()) throw Error(ErrorCode::input, shown + ": there is no " + what + " in it; give one on each line");
  return found;
}

}  // namespace

std::vector<Pose> read_poses(const std::string& name) { return read_lines<Pose>(name, "pose", pose_of); }

std::vector<RigidMotion> read_motions(const std::string& name, Vec3 center) {
  return read_lines<RigidMotion>(name, "motion", [center](const std::vector<double>& v) {
    const std::size_t half = v.size() / 2;
    if (half != 3 && half != 7 && half != 12)
      throw Error(ErrorCode::usage, std::to_string(v.size()) +
                                        " numbers; give those of two poses, from and to: two times x,y,z; "
                                        "x,y,z,ax,ay,az,degrees; or twelve of a 3x4 matrix");
    return RigidMotion{pose_of(std::span(v).first(half)), pose_of(std::span(v).subspan(half)), center};
  });
}

}  // namespace standoff::cli
