// SPDX-License-Identifier: Apache-2.0
// The table of formats: which reader a file of points gets, and which writer a file of answers.
#include <array>
#include <filesystem>
#include <limits>
#include <string_view>

#include "core/number_text.h"
#include "files/file_view.h"
#include "io/points/answer_format.h"
#include "io/points/format.h"
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
// Meshes, fields and other files that would be read as tables of nonsense.
constexpr std::array<std::string_view, 16> kOthers{".stl", ".obj", ".off", ".mesh", ".gltf",  ".glb",  ".3mf", ".3ds",
                                                   ".dae", ".gz",  ".vti", ".nrrd", ".query", ".body", ".zip", ".xlsx"};

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
  for (const std::string_view other : kOthers)
    if (extension == other)
      throw Error(ErrorCode::input,
                  name + ": points are not read from " + extension +
                      " files; give .csv, .ply, .npy or .npz (the vertices of a mesh: convert it to .ply)",
                  {.file = name});
  std::error_code ignored;
  // What comes through a pipe can be looked at once.
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

std::unique_ptr<AnswerWriter> create_answers(const std::filesystem::path& path, const AskedAnswers& asked,
                                             Existing existing) {
  const std::string extension = lower_extension(path.string());
  if (extension == ".csv") return csv_file(path, asked, existing);
  if (extension == ".ply") return ply_file(path, asked, existing);
  if (extension == ".npy") return npy_file(path, asked, existing);
  if (extension == ".npz") return npz_file(path, asked, existing);
  throw Error(ErrorCode::usage,
              path.string() + ": answers are not written as " + extension + " files; give .csv, .ply, .npy or .npz");
}

}  // namespace standoff
