// SPDX-License-Identifier: Apache-2.0
// Voxels as files: NumPy, NRRD, VTK and binvox.
#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/guarded.h"
#include "core/number_text.h"
#include "files/atomic_file.h"
#include "io/field/npy.h"
#include "standoff/error.h"
#include "standoff/voxels.h"

namespace standoff {
namespace {

std::string three(double x, double y, double z, const char* between) {
  return exact_text(x) + between + exact_text(y) + between + exact_text(z);
}

void write_text(AtomicFile& file, const std::string& text) { file.write(text.data(), text.size()); }

// Passes on a byte per voxel, x fastest, some rows at a time.
template <class Sink>
void send_bytes(const Occupancy& voxels, const Sink& sink) {
  constexpr std::size_t kAtOnce = 1 << 20;
  const Size3 size = voxels.grid.size;
  std::vector<std::uint8_t> bytes;
  bytes.reserve(std::min(kAtOnce, static_cast<std::size_t>(size.count())) + 8);
  const auto pass_on = [&] {
    sink(std::as_bytes(std::span(bytes)));
    bytes.clear();
  };
  for (std::int64_t row = 0; row < size.y * size.z; ++row) {
    const std::uint8_t* const bits = voxels.bits.data() + row * voxels.row_bytes();
    for (std::int64_t i = 0; i < size.x; i += 8) {
      for (std::int64_t n = i; n < std::min(i + 8, size.x); ++n)
        bytes.push_back(static_cast<std::uint8_t>(bits[i / 8] >> (n - i) & 1));
      if (bytes.size() >= kAtOnce) pass_on();
    }
  }
  pass_on();
}

void write_voxel_npz(AtomicFile& file, const Occupancy& voxels) {
  const Grid& grid = voxels.grid;
  NpzArrays arrays(file);
  arrays.vector("origin", grid.corner());
  arrays.vector("spacing", grid.spacing);
  arrays.begin("voxels", {"|u1", {grid.size.x, grid.size.y, grid.size.z}, true},
               static_cast<std::uint64_t>(grid.sample_count()));
  send_bytes(voxels, [&](std::span<const std::byte> part) { arrays.write(part); });
  arrays.end();
  arrays.finish();
}

void write_voxel_nrrd(AtomicFile& file, const Occupancy& voxels) {
  const Grid& g = voxels.grid;
  const Vec3 corner = g.corner();
  const auto vector = [](double x, double y, double z) { return std::string("(") + three(x, y, z, ",") + ")"; };
  write_text(file,
             "NRRD0005\n# Voxels of a triangle mesh, by standoff\ntype: uchar\ndimension: 3\nspace dimension: 3\n"
             "sizes: " +
                 std::to_string(g.size.x) + " " + std::to_string(g.size.y) + " " + std::to_string(g.size.z) +
                 "\nspace directions: " + vector(g.spacing.x, 0, 0) + " " + vector(0, g.spacing.y, 0) + " " +
                 vector(0, 0, g.spacing.z) +
                 "\ncenters: cell cell cell\nkinds: domain domain domain\nencoding: raw\nspace origin: " +
                 vector(corner.x, corner.y, corner.z) + "\n\n");
  send_bytes(voxels, [&](std::span<const std::byte> part) { file.write(part.data(), part.size()); });
}

// Point data, as fields are: a point of the image is a sample, the centre of its voxel.
void write_voxel_vti(AtomicFile& file, const Occupancy& voxels) {
  const Grid& g = voxels.grid;
  const Vec3 corner = g.corner();
  const auto last = [](std::int64_t side) { return std::to_string(side - 1); };
  const std::string extent = "0 " + last(g.size.x) + " 0 " + last(g.size.y) + " 0 " + last(g.size.z);
  write_text(file,
             "<?xml version=\"1.0\"?>\n"
             "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
             "  <ImageData WholeExtent=\"" +
                 extent + "\" Origin=\"" + three(corner.x, corner.y, corner.z, " ") + "\" Spacing=\"" +
                 three(g.spacing.x, g.spacing.y, g.spacing.z, " ") +
                 "\" Direction=\"1 0 0 0 1 0 0 0 1\">\n    <Piece Extent=\"" + extent +
                 "\">\n      <PointData Scalars=\"voxels\">\n"
                 "        <DataArray type=\"UInt8\" Name=\"voxels\" format=\"appended\" offset=\"0\"/>\n"
                 "      </PointData>\n      <CellData/>\n    </Piece>\n  </ImageData>\n"
                 "  <AppendedData encoding=\"raw\">\n_");
  const auto bytes = static_cast<std::uint64_t>(g.sample_count());
  file.write(&bytes, sizeof bytes);
  send_bytes(voxels, [&](std::span<const std::byte> part) { file.write(part.data(), part.size()); });
  write_text(file, "\n  </AppendedData>\n</VTKFile>\n");
}

// https://www.patrickmin.com/binvox/binvox.html: a cube of voxels, y fastest, then z, then x, in runs of a value and a
// count to 255. Its corner is at `translate`, its side is `scale`.
void write_binvox(AtomicFile& file, const Occupancy& voxels) {
  const Grid& g = voxels.grid;
  const std::int64_t side = std::max({g.size.x, g.size.y, g.size.z});
  const std::string sides = std::to_string(side);
  const Vec3 corner = g.corner() - g.spacing * 0.5;
  write_text(file, "#binvox 1\ndim " + sides + " " + sides + " " + sides + "\ntranslate " +
                       three(corner.x, corner.y, corner.z, " ") + "\nscale " +
                       exact_text(g.spacing.x * static_cast<double>(side)) + "\ndata\n");
  std::array<std::uint8_t, 2> run{0, 0};
  const auto add = [&](std::uint8_t value, std::int64_t count) {
    if (value != run[0] && run[1] > 0) file.write(run.data(), run.size()), run[1] = 0;
    run[0] = value;
    while (count > 0) {
      const std::int64_t more = std::min<std::int64_t>(count, 255 - run[1]);
      run[1] = static_cast<std::uint8_t>(run[1] + more);
      count -= more;
      if (run[1] == 255) file.write(run.data(), run.size()), run[1] = 0;
    }
  };
  for (std::int64_t i = 0; i < g.size.x; ++i) {
    for (std::int64_t k = 0; k < g.size.z; ++k) {
      for (std::int64_t j = 0; j < g.size.y; ++j) add(voxels.inside(i, j, k) ? 1 : 0, 1);
      add(0, side - g.size.y);
    }
    add(0, side * (side - g.size.z));
  }
  for (std::int64_t i = g.size.x; i < side; ++i) add(0, side * side);
  if (run[1] > 0) file.write(run.data(), run.size());
}

void check_cubes(const std::string& name, const Grid& grid) {
  constexpr std::int64_t kMostSamples = 1 << 13;  // the cube's empty rest is written too
  if (std::max({grid.size.x, grid.size.y, grid.size.z}) > kMostSamples)
    throw Error(ErrorCode::usage, name + ": a .binvox has at most " + std::to_string(kMostSamples) +
                                      " voxels along each side here; write .npz, .nrrd or .vti");
  const Vec3 s = grid.spacing;
  // Exactly, and within what a spacing that was computed is off by.
  const double least = std::min({s.x, s.y, s.z});
  if (grid.max_spacing() - least <= 1e-9 * least) return;
  throw Error(ErrorCode::usage, name + ": .binvox holds cubes, but the spacings are " + number_text(s.x) + ", " +
                                    number_text(s.y) + " and " + number_text(s.z) +
                                    "; take one spacing for all axes, or write .npz, .nrrd or .vti");
}

}  // namespace

void write_voxels(const std::filesystem::path& path, const Occupancy& voxels, Existing existing) try {
  struct Format {
    std::string_view extension;
    void (*write)(AtomicFile&, const Occupancy&);
  };
  constexpr Format formats[] = {
      {".npz", write_voxel_npz}, {".nrrd", write_voxel_nrrd}, {".vti", write_voxel_vti}, {".binvox", write_binvox}};
  const std::string extension = path.extension().string();
  const auto* const format = std::ranges::find(formats, extension, &Format::extension);
  if (format == std::end(formats))
    throw Error(ErrorCode::usage, path.string() +
                                      ": voxels are written as .npz, .nrrd, .vti or .binvox; give the file one of "
                                      "these names");
  validate(voxels.grid);
  const Size3& size = voxels.grid.size;
  if (static_cast<std::int64_t>(voxels.bits.size()) != voxels.row_bytes() * size.y * size.z)
    throw Error(ErrorCode::usage,
                path.string() + ": the bits are not those of the grid; give row_bytes() for each row");
  if (extension == ".binvox") check_cubes(path.string(), voxels.grid);
  AtomicFile file(path, existing);
  format->write(file, voxels);
  file.commit();
} catch (...) {
  throw_as_error("voxels");
}

}  // namespace standoff
