// SPDX-License-Identifier: Apache-2.0
// The formats of points, and the lines of paths.
#include "io/points/points.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <limits>
#include <string_view>
#include <utility>

#include "core/number_text.h"
#include "files/file_view.h"
#include "io/field/format.h"
#include "io/mesh/format.h"
#include "standoff/error.h"

namespace standoff {
namespace {

using Open = std::unique_ptr<PointReader> (*)(std::unique_ptr<FileView>, InvalidPoints);

struct BinaryFormat {
  std::string_view extension, start;  // how its names end, and how its files begin
  Open open;
};

constexpr std::array<BinaryFormat, 3> kPointFormats{
    {{".npy", "\x93NUMPY", npy_points}, {".npz", "PK\x03\x04", npz_points}, {".ply", "ply", ply_points}}};
// Packed files, and what standoff build writes: read as tables they would give nonsense, as meshes and fields would.
constexpr std::array<std::string_view, 5> kOthers{".gz", ".query", ".body", ".zip", ".xlsx"};

bool is_no_table(std::string_view extension) {
  const std::string_view name = extension.substr(std::min<std::size_t>(1, extension.size()));
  return std::ranges::find(kOthers, extension) != kOthers.end() || find_mesh_format(name) || find_field_format(name);
}

std::string lower_extension(const std::string& name) {
  std::string extension = std::filesystem::path(name).extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return extension;
}

// "ply" may begin a word of a table.
bool begins(std::string_view content, const BinaryFormat& format) {
  if (!content.starts_with(format.start)) return false;
  return format.extension != ".ply" || content.size() == 3 || static_cast<unsigned char>(content[3]) <= ' ';
}

}  // namespace

bool check_point(Vec3& point, InvalidPoints invalid) {
  if (max_norm(point) <= kMaxCoordinate && is_finite(point)) return true;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  if (invalid == InvalidPoints::mark) point = {kNan, kNan, kNan};
  return false;
}

std::string invalid_point(std::uint64_t number, const Vec3& point) {
  return "point " + std::to_string(number) +
         (is_finite(point) ? " lies beyond " + number_text(kMaxCoordinate) : std::string(" is not finite")) +
         "; repair it, or skip invalid points";
}

std::unique_ptr<PointReader> open_points(const std::string& name, InvalidPoints invalid) {
  const std::string extension = lower_extension(name);
  if (name == "-") return text_points(LineReader(InputStream(name)), invalid);
  if (std::ranges::find(kPointFormats, extension, &BinaryFormat::extension) == kPointFormats.end() &&
      is_no_table(extension))
    throw Error(ErrorCode::input,
                name + ": points are not read from " + extension +
                    " files; give .csv, .ply, .npy or .npz (the vertices of a mesh: convert it to .ply)",
                {.file = name});
  std::error_code ignored;
  // A pipe can be read only once.
  const bool file = std::filesystem::is_regular_file(name, ignored);
  char start[8];
  std::size_t got = 0;
  if (file) {
    InputStream input(name);
    while (got < sizeof start) {
      const std::size_t more = input.read(start + got, sizeof start - got);
      if (more == 0) break;
      got += more;
    }
  }
  for (const BinaryFormat& format : kPointFormats) {
    const bool named = extension == format.extension;
    const bool is = file ? begins({start, got}, format) : named;
    if (file && named && !is)
      throw Error(
          ErrorCode::input,
          name + ": its content is not that of a " + extension + " file; give the file another name, or save it again",
          {.file = name});
    if (is) return format.open(std::make_unique<FileView>(name, FileView::Access::map), invalid);
  }
  return text_points(LineReader(InputStream(name)), invalid);
}

namespace {

// Calls use(line) for each line of a text.
template <class Use>
void for_lines(std::string_view text, const Use& use) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    use(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

std::vector<std::size_t> starts_of_ply(std::string_view text, std::size_t points) {
  std::vector<std::size_t> starts;
  std::vector<char> joined(points, 0);  // to the point before
  std::size_t row = 0, header_end = text.find("end_header");
  header_end = header_end == std::string::npos ? text.size() : std::min(text.find('\n', header_end), text.size());
  for_lines(text.substr(header_end), [&](std::string_view line) {
    if (line.empty()) return;
    if (row++ < points) return;
    std::array<std::size_t, 2> ends{};
    const char *at = line.data(), *const end = line.data() + line.size();
    at = std::from_chars(at, end, ends[0]).ptr;
    while (at != end && *at == ' ') ++at;
    std::from_chars(at, end, ends[1]);
    if (ends[1] == ends[0] + 1 && ends[1] < points) joined[ends[1]] = 1;
  });
  for (std::size_t n = 0; n < points; ++n)
    if (!joined[n]) starts.push_back(n);
  return starts;
}

std::vector<std::size_t> starts_of_table(std::string_view text) {
  std::vector<std::size_t> starts;
  std::size_t row = 0;
  std::string_view before;
  bool header = true;
  for_lines(text, [&](std::string_view line) {
    if (std::exchange(header, false) || line.empty()) return;
    const std::string_view flier = line.substr(0, line.find(','));
    if (row == 0 || flier != before) starts.push_back(row);
    before = flier;
    ++row;
  });
  return starts;
}

}  // namespace

bool is_path(std::string_view head) {
  const auto has = [&](std::string_view words) { return head.find(words) != std::string_view::npos; };
  if (head.starts_with("ply")) return has("element edge") && !has("element face");
  return head.starts_with("flier,step,");
}

std::vector<std::size_t> path_starts(const std::string& name, std::string_view text, std::size_t points) {
  if (!text.starts_with("ply")) return starts_of_table(text);
  if (text.substr(0, text.find("end_header")).find("format ascii") == std::string_view::npos)
    throw Error(ErrorCode::input,
                name + ": paths are read from PLY files of text only; write it as ASCII, or as CSV by standoff fly");
  return starts_of_ply(text, points);
}

}  // namespace standoff
