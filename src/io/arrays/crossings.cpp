// SPDX-License-Identifier: Apache-2.0
// Hermite data as NumPy arrays, a column each, and as a table.
#include <algorithm>
#include <string>
#include <vector>

#include "core/guarded.h"
#include "core/number_text.h"
#include "files/atomic_file.h"
#include "io/field/npy.h"
#include "standoff/crossings.h"
#include "standoff/error.h"

namespace standoff {
namespace {

using Crossings = std::span<const EdgeCrossing>;

// One array of `width` numbers for each crossing: put(crossing, numbers) sets them.
template <class Number, class Put>
void column(NpzArrays& arrays, const std::string& name, const char* type, std::size_t width, Crossings crossings,
            const Put& put) {
  constexpr std::size_t kAtOnce = 1 << 14;
  std::vector<std::int64_t> shape{std::ssize(crossings)};
  if (width > 1) shape.push_back(static_cast<std::int64_t>(width));
  arrays.begin(name, {type, shape, false}, crossings.size() * width * sizeof(Number));
  std::vector<Number> numbers(width * std::min(kAtOnce, crossings.size()));
  for (std::size_t first = 0; first < crossings.size(); first += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, crossings.size() - first);
    for (std::size_t n = 0; n < count; ++n) put(crossings[first + n], numbers.data() + width * n);
    arrays.write(std::as_bytes(std::span(numbers).first(width * count)));
  }
  arrays.end();
}

void write_crossing_npz(AtomicFile& file, Crossings crossings, const Grid& grid) {
  NpzArrays arrays(file);
  arrays.size("size", grid.size);
  arrays.vector("origin", grid.corner());
  arrays.vector("spacing", grid.spacing);
  using C = const EdgeCrossing&;
  column<std::int64_t>(arrays, "sample", "<i8", 3, crossings,
                       [](C c, std::int64_t* to) { std::ranges::copy(c.sample, to); });
  column<std::uint8_t>(arrays, "axis", "|u1", 1, crossings, [](C c, std::uint8_t* to) { *to = c.axis; });
  column<double>(arrays, "place", "<f8", 1, crossings, [](C c, double* to) { *to = c.place; });
  column<std::uint32_t>(arrays, "triangle", "<u4", 1, crossings, [](C c, std::uint32_t* to) { *to = c.triangle; });
  column<float>(arrays, "normal", "<f4", 3, crossings, [](C c, float* to) {
    to[0] = static_cast<float>(c.normal.x);
    to[1] = static_cast<float>(c.normal.y);
    to[2] = static_cast<float>(c.normal.z);
  });
  column<std::uint8_t>(arrays, "enters", "|b1", 1, crossings, [](C c, std::uint8_t* to) { *to = c.enters ? 1 : 0; });
  arrays.finish();
}

void write_csv(AtomicFile& file, Crossings crossings, const Grid& grid) {
  const auto write = [&](const std::string& text) { file.write(text.data(), text.size()); };
  write("i,j,k,axis,place,triangle,normal_x,normal_y,normal_z,enters,x,y,z\n");
  const auto three = [](const Vec3& v) { return exact_text(v.x) + ',' + exact_text(v.y) + ',' + exact_text(v.z); };
  for (const EdgeCrossing& c : crossings)
    write(std::to_string(c.sample[0]) + ',' + std::to_string(c.sample[1]) + ',' + std::to_string(c.sample[2]) + ',' +
          std::to_string(c.axis) + ',' + exact_text(c.place) + ',' + std::to_string(c.triangle) + ',' +
          three(c.normal) + ',' + (c.enters ? '1' : '0') + ',' + three(c.position(grid)) + '\n');
}

}  // namespace

void write_crossings(const std::filesystem::path& path, std::span<const EdgeCrossing> crossings, const Grid& grid,
                     Existing existing) try {
  const std::string extension = path.extension().string();
  if (extension != ".npz" && extension != ".csv")
    throw Error(ErrorCode::usage,
                path.string() + ": crossings are written as .npz or .csv; give the file one of these names");
  AtomicFile file(path, existing);
  if (extension == ".npz")
    write_crossing_npz(file, crossings, grid);
  else
    write_csv(file, crossings, grid);
  file.commit();
} catch (...) {
  throw_as_error("crossings");
}

}  // namespace standoff
