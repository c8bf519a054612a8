// SPDX-License-Identifier: Apache-2.0
#include "io/field/read_samples.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/memory.h"
#include "core/number_text.h"
#include "core/tile_count.h"
#include "files/file_view.h"
#include "io/field/tile_content.h"
#include "standoff/error.h"

namespace standoff {
std::uint64_t sample_bytes(const Grid& grid) {
  // Valid grids count up to 2^62 samples; no file is that long, whatever a header says.
  return 4 * static_cast<std::uint64_t>(std::min(grid.sample_count(), std::int64_t{1} << 61));
}

namespace {

// Reads tiles of an array, a layer of them after the other: a layer spans the grid but for its slowest axis, along
// which it is a tile thick. Each number is read on its own: numbers need not be aligned.
template <class Sample>
class TileReader {
 public:
  TileReader(const FileView& file, const StoredArray& array, const Size3& size)
      : swapped_(array.big_endian),
        size_(size),
        step_(array.z_fastest ? Size3{size.y * size.z, size.z, 1} : Size3{1, size.x, size.x * size.y}),
        planes_(array.z_fastest ? size.x : size.z),
        plane_(size.count() / planes_),
        width_(array.planar ? 1 : array.components) {
    stream_ = array.open ? array.open() : std::make_unique<BytesInMemory>(file.text(array.offset, file.size()));
    if (array.open) stream_->next(array.offset);
  }

  // The next kSide planes, or what is left of them.
  void next_layer() {
    begin_ += layer_;
    layer_ = std::min(kSide, planes_ - read_) * plane_;
    read_ += layer_ / plane_;
    bytes_ = stream_->next(sizeof(Sample) * static_cast<std::uint64_t>(layer_ * width_)).data();
  }
  // After the last layer: the numbers of the next component follow, of planar arrays.
  void next_component() { read_ = begin_ = layer_ = 0; }
  void finish() { stream_->finish(); }

  // The tile whose first sample is `first`, x fastest; `absent` where the grid ends. It lies in the layer.
  void read(Size3 first, Sample absent, std::array<Sample, DistanceField::kTileSamples>& tile) const {
    tile.fill(absent);
    read_into(first, tile.data(), 1);
  }
  // The samples of the grid alone, each some numbers after the last.
  void read_into(Size3 first, Sample* tile, std::int64_t between) const {
    const std::int64_t nx = std::min(kSide, size_.x - first.x), ny = std::min(kSide, size_.y - first.y),
                       nz = std::min(kSide, size_.z - first.z);
    for (std::int64_t z = 0; z < nz; ++z)
      for (std::int64_t y = 0; y < ny; ++y) {
        const std::int64_t from = first.x * step_.x + (first.y + y) * step_.y + (first.z + z) * step_.z - begin_;
        Sample* row = tile + between * kSide * (y + kSide * z);
        for (std::int64_t x = 0; x < nx; ++x)
          for (std::int64_t c = 0; c < width_; ++c) row[between * x + c] = number((from + x * step_.x) * width_ + c);
      }
  }

 private:
  static constexpr std::int64_t kSide = DistanceField::kTileSide;

  Sample number(std::int64_t at) const {
    if constexpr (sizeof(Sample) == 1) {
      return static_cast<Sample>(bytes_[at]);
    } else {
      std::uint32_t bits;
      std::memcpy(&bits, bytes_ + sizeof bits * static_cast<std::uint64_t>(at), sizeof bits);
      return std::bit_cast<Sample>(swapped_ ? __builtin_bswap32(bits) : bits);
    }
  }

  std::unique_ptr<ByteStream> stream_;
  bool swapped_;
  Size3 size_, step_;
  std::int64_t planes_, plane_;         // of the slowest axis, and samples in each
  std::int64_t width_;                  // numbers of a sample
  std::int64_t read_ = 0;               // planes up to the end of the layer
  std::int64_t begin_ = 0, layer_ = 0;  // of the layer: its first sample, and how many there are
  const char* bytes_ = nullptr;
};

void check(const FileView& file, const StoredField& stored) {
  if (!(stored.thickness > 0))
    file.fail("the thickness " + exact_text(stored.thickness) + " is not positive; write the file again");
  require_valid(file, stored.grid);
  const auto require_array = [&](const StoredArray& array, const char* what) {
    if (!array.open) file.require(array.offset, sample_bytes(stored.grid), what);
  };
  require_array(stored.distance, "the array of distances");
  if (stored.nearest) require_array(*stored.nearest, "the array of nearest triangles");
}

// Goes through the tiles of a file, a layer along the slowest axis after the other.
class TileWalk {
 public:
  TileWalk(const FileView& file, const StoredField& stored)
      : file_(file), stored_(stored), size_(stored.grid.size), far_(static_cast<float>(stored.thickness)) {}

  Size3 tile_count() const { return DistanceField::tiles_of(size_); }
  // Returns the bytes that packed arrays hold: a layer each.
  double held() const {
    const Size3& n = size_;
    double bytes = 0;
    for (const StoredArray* array : {&stored_.distance, stored_.nearest ? &*stored_.nearest : nullptr})
      if (array && array->packed) {
        const std::int64_t planes = array->z_fastest ? n.x : n.z;
        bytes += 4 * static_cast<double>(n.count() / planes * std::min<std::int64_t>(planes, kTileSide));
      }
    return bytes;
  }

  // store(tile, values, nearest) for each tile that is to be stored, mark_inside(tile) for each that is deep inside.
  // Throws at a value that is none.
  template <class Store, class MarkInside>
  void operator()(Store store, MarkInside mark_inside) const {
    TileReader<float> values(file_, stored_.distance, size_);
    std::optional<TileReader<std::uint32_t>> nearest;
    if (stored_.nearest) nearest.emplace(file_, *stored_.nearest, size_);
    const Size3 tiles = tile_count();
    const bool along_x = stored_.distance.z_fastest;
    for (std::int64_t layer = 0; layer < (along_x ? tiles.x : tiles.z); ++layer) {
      values.next_layer();
      if (nearest) nearest->next_layer();
      for (std::int64_t tz = along_x ? 0 : layer; tz < (along_x ? tiles.z : layer + 1); ++tz)
        for (std::int64_t ty = 0; ty < tiles.y; ++ty) {
          file_.check();
          for (std::int64_t tx = along_x ? layer : 0; tx < (along_x ? layer + 1 : tiles.x); ++tx)
            visit(values, nearest, {tx, ty, tz}, store, mark_inside);
        }
    }
    values.finish();
    if (nearest) nearest->finish();
  }

 private:
  template <class Store, class MarkInside>
  void visit(const TileReader<float>& values, const std::optional<TileReader<std::uint32_t>>& nearest, Size3 at,
             const Store& store, const MarkInside& mark_inside) const {
    const Size3 first{at.x * kTileSide, at.y * kTileSide, at.z * kTileSide};
    std::array<float, kTileSamples> tile;
    values.read(first, far_, tile);
    const TileContent found = content(tile, far_, samples_from(first));
    if (found == TileContent::bad) fail_at_bad(file_, tile, far_, first);
    std::array<std::uint32_t, kTileSamples> triangles;
    if (nearest) nearest->read(first, kNoTriangle, triangles);
    // A distance that equals the thickness lies in the band: only its nearest triangle tells it from a clamped one.
    if (found == TileContent::near || (nearest && has_triangle(triangles)))
      store(at, tile, triangles);
    else if (found == TileContent::inside)
      mark_inside(at);
  }
  // Samples of the grid in the tile whose first sample is `first`.
  std::int64_t samples_from(const Size3& first) const {
    return std::min<std::int64_t>(kTileSide, size_.x - first.x) * std::min<std::int64_t>(kTileSide, size_.y - first.y) *
           std::min<std::int64_t>(kTileSide, size_.z - first.z);
  }

  const FileView& file_;
  const StoredField& stored_;
  Size3 size_;
  float far_;
};

// A file whose tiles might not fit, were all of them stored, is gone through once to count them.
void check_memory(const TileWalk& walk, bool with_nearest, std::int64_t memory_limit) {
  if (memory_limit == 0) return;
  const double limit = static_cast<double>(memory_limit), all = static_cast<double>(walk.tile_count().count()),
               held = walk.held();
  if (held + field_bytes(all, all, with_nearest) <= limit) return;
  const double least = held + field_bytes(0, all, with_nearest);
  if (least > limit)
    throw Error(ErrorCode::limit, "its tiles need more than " + over_the_limit(least, limit) + "; give a higher limit",
                limit_details(least, limit));
  double stored = 0;
  walk([&](auto&&...) { ++stored; }, [](const Size3&) {});
  const double needed = held + field_bytes(stored, all, with_nearest);
  if (needed > limit)
    throw Error(ErrorCode::limit, "its tiles need " + over_the_limit(needed, limit) + "; give a higher limit",
                limit_details(needed, limit));
}

DistanceField load(const FileView& file, const StoredField& stored, std::int64_t memory_limit) {
  check(file, stored);
  const bool with_nearest = stored.nearest.has_value();
  const TileWalk walk(file, stored);
  check_memory(walk, with_nearest, memory_limit);
  DistanceField field(stored.grid, stored.thickness, with_nearest);
  field.set_provenance(stored.provenance);
  walk(
      [&](const Size3& tile, const auto& values, const auto& nearest) {
        std::ranges::copy(values, field.store_tile(tile.x, tile.y, tile.z).begin());
        if (with_nearest) std::ranges::copy(nearest, field.store_nearest(tile.x, tile.y, tile.z).begin());
      },
      [&](const Size3& tile) { field.mark_inside(tile.x, tile.y, tile.z); });
  return field;
}

void check_sidecar_memory(const StoredField& stored, const DistanceField& field, std::int64_t memory_limit) {
  if (memory_limit == 0) return;
  double needed = static_cast<double>(field.memory_bytes());
  for (const StoredSidecar& sidecar : stored.sidecars)
    needed += static_cast<double>(field.stored_tiles()) * DistanceField::kTileSamples * sidecar.array.components *
              static_cast<double>(bytes_of(sidecar.array.type));
  const auto limit = static_cast<double>(memory_limit);
  if (needed > limit)
    throw Error(ErrorCode::limit,
                "its tiles and sidecars need " + over_the_limit(needed, limit) + "; give a higher limit",
                limit_details(needed, limit));
}

// store(tile) for every stored tile of a layer along the slowest axis.
template <class Store>
void each_stored_tile(const DistanceField& field, bool along_x, std::int64_t layer, const Store& store) {
  const Size3 tiles = field.tile_count();
  for (std::int64_t tz = along_x ? 0 : layer; tz < (along_x ? tiles.z : layer + 1); ++tz)
    for (std::int64_t ty = 0; ty < tiles.y; ++ty)
      for (std::int64_t tx = along_x ? layer : 0; tx < (along_x ? layer + 1 : tiles.x); ++tx) {
        const std::int32_t slot = field.slots()[static_cast<std::size_t>(tx + tiles.x * (ty + tiles.y * tz))];
        if (slot >= 0) store(Size3{8 * tx, 8 * ty, 8 * tz}, slot);
      }
}

template <class Number>
std::vector<Number> load_numbers(const FileView& file, const StoredArray& array, const DistanceField& field) {
  const std::int64_t components = array.components;
  std::vector<Number> values(static_cast<std::size_t>(field.stored_tiles() * DistanceField::kTileSamples * components));
  TileReader<Number> reader(file, array, field.grid().size);
  const std::int64_t layers = array.z_fastest ? field.tile_count().x : field.tile_count().z;
  for (std::int64_t component = 0; component < (array.planar ? components : 1); ++component) {
    if (component > 0) reader.next_component();
    for (std::int64_t layer = 0; layer < layers; ++layer) {
      file.check();
      reader.next_layer();
      each_stored_tile(field, array.z_fastest, layer, [&](Size3 first, std::int64_t slot) {
        reader.read_into(first, values.data() + DistanceField::kTileSamples * components * slot + component,
                         components);
      });
    }
  }
  reader.finish();
  return values;
}

// The numbers of a sidecar at the stored tiles of a field.
Sidecar load_sidecar(const FileView& file, const StoredSidecar& stored, const DistanceField& field) {
  Sidecar sidecar{stored.name, stored.array.components, {}};
  if (stored.array.type == NumberType::uint8)
    sidecar.values = load_numbers<std::uint8_t>(file, stored.array, field);
  else
    sidecar.values = load_numbers<float>(file, stored.array, field);
  return sidecar;
}

}  // namespace

void require_valid(const FileView& file, const Grid& grid) {
  try {
    validate(grid);
  } catch (const Error& error) {
    file.fail("header", std::string(diagnosis(error.what())) + "; write the file again");
  }
}

FieldFile load_field(const FileView& file, const StoredField& stored, const FieldRequest& request) {
  try {
    FieldFile loaded{load(file, stored, request.memory_limit), {}};
    if (!request.sidecars) return loaded;
    check_sidecar_memory(stored, loaded.field, request.memory_limit);
    for (const StoredSidecar& sidecar : stored.sidecars)
      loaded.sidecars.push_back(load_sidecar(file, sidecar, loaded.field));
    return loaded;
  } catch (const Error& error) {
    // A field's own errors lack the name of the file.
    if (error.code() == ErrorCode::input) throw;
    ErrorDetails details = error.details();
    details.file = file.path().string();
    throw Error(error.code(), details.file + ": " + error.what(), details);
  }
}

}  // namespace standoff
