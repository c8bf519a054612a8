// SPDX-License-Identifier: Apache-2.0
#include "batch/field_array.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>

#include "files/atomic_file.h"
#include "files/atomic_folder.h"
#include "io/zarr/blosc.h"
#include "io/zarr/parts.h"
#include "standoff/error.h"

namespace standoff {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kLongestSide = 256;   // of a chunk: at most 64 MiB
constexpr std::int64_t kTableRows = 65'536;  // of a chunk of a table
// Of blosc: level 3, which stores have, takes 4.5 ms of a row of 64^3 in place of 1.5, for 4 % fewer bytes.
constexpr int kLevel = 1;
constexpr std::size_t kBlock = std::size_t{1} << 18;
constexpr const char* kDistance = "distance";
constexpr const char* kOurs = R"("rows": "batch")";              // by which the group's metadata are known
constexpr const char* kOurNames = R"(["mesh", "x", "y", "z"])";  // of dimensions, by which those of the array are
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::string list_text(std::span<const std::int64_t> numbers) {
  std::string text;
  for (const std::int64_t number : numbers) text += (text.empty() ? "" : ", ") + std::to_string(number);
  return "[" + text + "]";
}

// The text of an array's zarr.json. Names of chunks are parted by dots: with slashes each row would take four folders.
std::string array_text(const char* type, std::span<const std::int64_t> shape, std::span<const std::int64_t> chunk,
                       const char* fill, const char* names, bool blosc) {
  std::string codecs = R"({"name": "bytes")";
  if (std::string_view(type) != "uint8") codecs += R"(, "configuration": {"endian": "little"})";
  codecs += "}";
  if (blosc)
    codecs += R"(, {"name": "blosc", "configuration": {"cname": "zstd", "clevel": )" + std::to_string(kLevel) +
              R"(, "shuffle": "shuffle", "typesize": )" + std::to_string(zarr::kNumberBytes) + R"(, "blocksize": )" +
              std::to_string(kBlock) + "}}";
  return R"({"zarr_format": 3, "node_type": "array", "shape": )" + list_text(shape) + R"(, "data_type": ")" + type +
         R"(", "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": )" + list_text(chunk) +
         R"(}}, "chunk_key_encoding": {"name": "default", "configuration": {"separator": "."}}, "fill_value": )" +
         fill + R"(, "codecs": [)" + codecs + R"(], "dimension_names": )" + names + "}\n";
}

// Copies what a tile has of a window. In the chunk z varies fastest, as in arrays of NumPy, in the tile x does.
void copy_tile(const DistanceField& field, const Size3& tile, const zarr::Window& window, const Size3& chunk,
               float* out) {
  constexpr std::int64_t kSide = DistanceField::kTileSide;
  const Size3 at{kSide * tile.x, kSide * tile.y, kSide * tile.z};
  const zarr::Window part = window.common({at, {at.x + kSide, at.y + kSide, at.z + kSide}});
  const Size3 tiles = field.tile_count();
  const std::int32_t slot =
      field.slots().empty() ? DistanceField::kOutside
                            : field.slots()[static_cast<std::size_t>(tile.x + tiles.x * (tile.y + tiles.y * tile.z))];
  const auto background = static_cast<float>(slot == DistanceField::kInside ? -field.thickness() : field.thickness());
  const float* const values =
      slot < 0 ? nullptr : field.tile_values().data() + static_cast<std::ptrdiff_t>(DistanceField::kTileSamples) * slot;
  const std::int64_t count = part.end.z - part.first.z;
  for (std::int64_t x = part.first.x; x < part.end.x; ++x)
    for (std::int64_t y = part.first.y; y < part.end.y; ++y) {
      float* const to =
          out + ((x - window.first.x) * chunk.y + (y - window.first.y)) * chunk.z + (part.first.z - window.first.z);
      if (!values) {
        std::fill_n(to, count, background);
        continue;
      }
      const float* const from = values + (x - at.x) + kSide * ((y - at.y) + kSide * (part.first.z - at.z));
      for (std::int64_t n = 0; n < count; ++n) to[n] = from[kSide * kSide * n];
    }
}

// The row of a chunk's file "c.ROW.X.Y.Z", and which of its parts it is; nothing for other names.
struct ChunkName {
  std::int64_t row;
  Size3 part;
};
std::optional<ChunkName> chunk_of(std::string_view name) {
  if (!name.starts_with("c")) return std::nullopt;
  std::array<std::int64_t, 4> numbers{};
  const char *at = name.data() + 1, *const end = name.data() + name.size();
  for (std::int64_t& number : numbers) {
    if (at == end || *at != '.') return std::nullopt;
    const auto [stop, error] = std::from_chars(at + 1, end, number);
    if (error != std::errc() || number < 0) return std::nullopt;
    at = stop;
  }
  if (at != end) return std::nullopt;
  return ChunkName{numbers[0], {numbers[1], numbers[2], numbers[3]}};
}

// Nobody needs an earlier file meanwhile. Where there is none, the new one takes its name in one step, and a process
// that is killed leaves no other beside it.
void write(const fs::path& path, std::span<const std::byte> bytes) {
  std::error_code ignored;
  fs::remove(path, ignored);
  AtomicFile file(path);
  file.leave_to_system();
  file.write(bytes.data(), bytes.size());
  file.commit();
}

void make(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) fail_to_write(folder, error.value(), folder.parent_path());
}

void remove_file(const fs::path& path) {
  std::error_code error;
  fs::remove(path, error);
  if (error) fail_to_write(path, error.value(), path.parent_path());
}

}  // namespace

Size3 FieldArrayLayout::chunks() const { return zarr::parts_of(shape, {kLongestSide, kLongestSide, kLongestSide}); }

Size3 FieldArrayLayout::chunk() const { return zarr::parts_of(shape, chunks()); }

FieldArray::FieldArray(const fs::path& folder, const FieldArrayLayout& layout) : folder_(folder), layout_(layout) {
  if (layout.compress && !zarr::have_blosc())
    throw Error(ErrorCode::usage,
                std::string("rows cannot be compressed: ") + zarr::kWithoutBlosc + ", or leave them uncompressed");
}

std::vector<fs::path> FieldArray::files_of(std::int64_t row) const {
  std::vector<fs::path> files;
  const Size3 chunks = layout_.chunks();
  for (std::size_t n = 0; n < static_cast<std::size_t>(chunks.count()); ++n) {
    const Size3 at = zarr::part_at(n, chunks);
    files.push_back(folder_ / kDistance /
                    ("c." + std::to_string(row) + "." + std::to_string(at.x) + "." + std::to_string(at.y) + "." +
                     std::to_string(at.z)));
  }
  return files;
}

std::vector<std::byte> FieldArray::packed(const DistanceField& field, const Size3& part) const {
  const Size3 chunk = layout_.chunk();
  const Size3 first = zarr::times(part, chunk);
  const zarr::Window window{first, zarr::least(zarr::plus(first, chunk), layout_.shape)};
  std::vector<std::byte> bytes(sizeof(float) * static_cast<std::size_t>(chunk.count()));
  auto* const values = reinterpret_cast<float*>(bytes.data());
  if (window.size() != chunk)  // beyond the grid
    std::fill_n(values, chunk.count(), std::numeric_limits<float>::quiet_NaN());
  constexpr std::int64_t kSide = DistanceField::kTileSide;
  const zarr::Window tiles = zarr::parts_in(window, {kSide, kSide, kSide});
  for (std::int64_t x = tiles.first.x; x < tiles.end.x; ++x)
    for (std::int64_t y = tiles.first.y; y < tiles.end.y; ++y)
      for (std::int64_t z = tiles.first.z; z < tiles.end.z; ++z) copy_tile(field, {x, y, z}, window, chunk, values);
  return layout_.compress ? zarr::blosc_packed(bytes, kLevel, kBlock) : bytes;
}

void FieldArray::put(std::int64_t row, const DistanceField& field) const {
  if (field.grid().size != layout_.shape)
    throw Error(ErrorCode::usage, "a field of " + std::to_string(field.grid().size.x) + " x " +
                                      std::to_string(field.grid().size.y) + " x " +
                                      std::to_string(field.grid().size.z) +
                                      " samples is no row of this array; give all fields one shape");
  const std::vector<fs::path> files = files_of(row);
  if (files.size() > 1) remove(row);
  for (std::size_t n = 0; n < files.size(); ++n) write(files[n], packed(field, zarr::part_at(n, layout_.chunks())));
}

void FieldArray::remove(std::int64_t row) const {
  for (const fs::path& file : files_of(row)) remove_file(file);
}

FieldArray::Table::Table(std::int64_t rows_of)
    : rows(rows_of),
      origin(static_cast<std::size_t>(3 * rows), kNone),
      spacing(origin),
      thickness(static_cast<std::size_t>(rows), kNone),
      code(static_cast<std::size_t>(rows), kUnknown) {}

void FieldArray::Table::set(std::int64_t row, const Vec3& first, const Vec3& step, double half_width) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    origin[3 * static_cast<std::size_t>(row) + axis] = first[axis];
    spacing[3 * static_cast<std::size_t>(row) + axis] = step[axis];
  }
  thickness[static_cast<std::size_t>(row)] = half_width;
}

void FieldArray::begin() const {
  std::error_code ignored;
  const fs::path group = folder_ / "zarr.json", array = folder_ / kDistance / "zarr.json";
  const auto has = [](const fs::path& metadata, const char* ours) {
    return read_text(metadata).find(ours) != std::string::npos;
  };
  // Where a run was killed the array may be there without the group.
  const bool is_ours = fs::exists(group, ignored)   ? has(group, kOurs)
                       : fs::exists(array, ignored) ? has(array, kOurNames)
                                                    : true;
  if (!is_ours)
    throw Error(ErrorCode::output, folder_.string() +
                                       ": a store is there that is no array of a batch, and it stays as "
                                       "it is; give another folder");
  make(folder_ / kDistance);
  remove_file(group);
  remove_file(array);
}

void FieldArray::write_zarr_json(const char* name, const std::string& text) const {
  make(folder_ / name);
  write(folder_ / name / "zarr.json", std::as_bytes(std::span(text)));
}

template <class Number>
void FieldArray::write_table(const char* name, const char* type, const std::vector<Number>& values,
                             std::int64_t columns) const {
  const std::int64_t rows = static_cast<std::int64_t>(values.size()) / columns;
  std::vector<std::int64_t> shape{rows}, chunk{kTableRows};
  if (columns > 1) shape.push_back(columns), chunk.push_back(columns);
  constexpr bool kWhole = std::is_integral_v<Number>;
  const std::string fill = kWhole ? std::to_string(kUnknown) : R"("NaN")";
  write_zarr_json(
      name, array_text(type, shape, chunk, fill.c_str(), columns > 1 ? R"(["mesh", "axis"])" : R"(["mesh"])", false));
  for (std::int64_t first = 0; first < rows; first += kTableRows) {
    std::vector<Number> part(static_cast<std::size_t>(kTableRows * columns),
                             kWhole ? static_cast<Number>(kUnknown) : std::numeric_limits<Number>::quiet_NaN());
    const auto* const from = values.data() + first * columns;
    std::copy_n(from, std::min(kTableRows, rows - first) * columns, part.begin());
    const std::string chunk_name = "c." + std::to_string(first / kTableRows) + (columns > 1 ? ".0" : "");
    write(folder_ / name / chunk_name, std::as_bytes(std::span(part)));
  }
}

// Files of rows behind the last one, of rows without a field, and of rows that had other chunks.
void FieldArray::remove_strangers(const Table& table) const {
  const Size3 chunks = layout_.chunks();
  std::vector<fs::path> strangers;
  const fs::path folder = folder_ / kDistance;
  const bool readable = all_entries(folder, [&](const char* name, bool) {
    const auto chunk = chunk_of(name);
    if (chunk && (chunk->row >= table.rows || table.code[static_cast<std::size_t>(chunk->row)] != 0 ||
                  chunk->part.x >= chunks.x || chunk->part.y >= chunks.y || chunk->part.z >= chunks.z))
      strangers.push_back(folder / name);
    return true;
  });
  if (!readable)
    throw Error(ErrorCode::output,
                folder.string() + ": cannot read the folder; see to its permissions, and go on with --resume");
  for (const fs::path& path : strangers) remove_file(path);
}

void FieldArray::end(const Table& table) const {
  remove_strangers(table);
  write_table("origin", "float64", table.origin, 3);
  write_table("spacing", "float64", table.spacing, 3);
  write_table("thickness", "float64", table.thickness, 1);
  write_table("code", "uint8", table.code, 1);
  const Size3 &shape = layout_.shape, chunk = layout_.chunk();
  write_zarr_json(kDistance, array_text("float32", std::array{table.rows, shape.x, shape.y, shape.z},
                                        std::array{std::int64_t{1}, chunk.x, chunk.y, chunk.z}, R"("NaN")", kOurNames,
                                        layout_.compress));
  // The last file: a group whose arrays are all there.
  write_zarr_json(".", R"({"zarr_format": 3, "node_type": "group", "attributes": {"standoff": {"format": 1, )" +
                           std::string(kOurs) + "}}}\n");
}

}  // namespace standoff
