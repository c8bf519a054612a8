#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <string>

#include "difi/error.h"
#include "io/field_samples.h"
#include "io/field_text.h"

namespace difi {
namespace {

constexpr std::int64_t kSide = DistanceField::kTileSide;
constexpr std::size_t kTile = DistanceField::kTileSamples;

// Reads tiles of an array that lies in the file, each number on its own: numbers need not be aligned there.
template <class Sample>
class TileReader {
 public:
  TileReader(const FieldInput& file, const StoredArray& array, const Size3& size)
      : bytes_(file.text(array.offset, sizeof(Sample) * static_cast<std::uint64_t>(size.count())).data()),
        swapped_(array.big_endian),
        size_(size),
        step_(array.z_fastest ? Size3{size.y * size.z, size.z, 1} : Size3{1, size.x, size.x * size.y}) {}

  // The tile whose first sample is `first`, x fastest; `absent` where the grid ends.
  void read(Size3 first, Sample absent, std::array<Sample, kTile>& tile) const {
    tile.fill(absent);
    const std::int64_t nx = std::min(kSide, size_.x - first.x), ny = std::min(kSide, size_.y - first.y),
                       nz = std::min(kSide, size_.z - first.z);
    for (std::int64_t z = 0; z < nz; ++z)
      for (std::int64_t y = 0; y < ny; ++y) {
        const std::int64_t from = first.x * step_.x + (first.y + y) * step_.y + (first.z + z) * step_.z;
        Sample* row = tile.data() + kSide * (y + kSide * z);
        for (std::int64_t x = 0; x < nx; ++x) row[x] = number(from + x * step_.x);
      }
  }

 private:
  Sample number(std::int64_t at) const {
    std::uint32_t bits;
    std::memcpy(&bits, bytes_ + sizeof bits * static_cast<std::uint64_t>(at), sizeof bits);
    return std::bit_cast<Sample>(swapped_ ? __builtin_bswap32(bits) : bits);
  }

  const char* bytes_;
  bool swapped_;
  Size3 size_, step_;
};

enum class TileContent { far, near, bad };

// Branch-free, so that it costs little beside reading: NaN is neither near nor within the thickness.
TileContent content(const std::array<float, kTile>& tile, float far) {
  int near = 0, good = 0;
  for (const float value : tile) {
    near |= static_cast<int>(value < far);
    good += static_cast<int>(value <= far);
  }
  return good != static_cast<int>(kTile) ? TileContent::bad : near ? TileContent::near : TileContent::far;
}

// Branch-free as well: most tiles of a band's file have no triangle.
bool has_triangle(const std::array<std::uint32_t, kTile>& tile) {
  int found = 0;
  for (const std::uint32_t triangle : tile) found |= static_cast<int>(triangle != kNoTriangle);
  return found != 0;
}

[[noreturn]] void fail_at_bad(const FieldInput& file, const std::array<float, kTile>& tile, float far, Size3 first) {
  const auto bad = std::ranges::find_if(tile, [far](float value) { return !(value <= far); });
  const std::int64_t at = bad - tile.begin();
  const auto name = [](std::int64_t i) { return std::to_string(i); };
  file.fail("sample (" + name(first.x + at % kSide) + "," + name(first.y + at / kSide % kSide) + "," +
                name(first.z + at / (kSide * kSide)) + ")",
            "the value " + text_of(*bad) + " is not a number up to the thickness, " + text_of(far) +
                "; the file is damaged or no distance field");
}

void check(const FieldInput& file, const StoredField& stored) {
  if (!(stored.thickness > 0))
    file.fail("the thickness " + text_of(stored.thickness) + " is not positive; write the file again");
  require_valid(file, stored.grid);
  file.require(stored.distance.offset, sample_bytes(stored.grid), "the array of distances");
  if (stored.nearest) file.require(stored.nearest->offset, sample_bytes(stored.grid), "the array of nearest triangles");
}

DistanceField load(const FieldInput& file, const StoredField& stored) {
  check(file, stored);
  const Size3& size = stored.grid.size;
  DistanceField field(stored.grid, stored.thickness, stored.nearest.has_value());
  field.provenance = stored.provenance;
  const auto far = static_cast<float>(stored.thickness);
  const TileReader<float> values(file, stored.distance, size);
  std::optional<TileReader<std::uint32_t>> nearest;
  if (stored.nearest) nearest.emplace(file, *stored.nearest, size);

  std::array<float, kTile> tile;
  std::array<std::uint32_t, kTile> nearest_tile;
  const Size3 tiles = field.tile_count();
  for (std::int64_t tz = 0; tz < tiles.z; ++tz)
    for (std::int64_t ty = 0; ty < tiles.y; ++ty)
      for (std::int64_t tx = 0; tx < tiles.x; ++tx) {
        const Size3 first{tx * kSide, ty * kSide, tz * kSide};
        values.read(first, far, tile);
        const TileContent found = content(tile, far);
        if (found == TileContent::bad) fail_at_bad(file, tile, far, first);
        if (nearest) nearest->read(first, kNoTriangle, nearest_tile);
        // A distance that equals the thickness lies in the band: only its nearest triangle tells it from a clamped one.
        if (found == TileContent::far && !(nearest && has_triangle(nearest_tile))) continue;
        std::ranges::copy(tile, field.store_tile(tx, ty, tz));
        if (nearest) std::ranges::copy(nearest_tile, field.store_nearest(tx, ty, tz));
      }
  return field;
}

}  // namespace

void require_valid(const FieldInput& file, const Grid& grid) {
  try {
    validate(grid);
  } catch (const Error& error) {
    file.fail("header", error.what());
  }
}

DistanceField load_field(const FieldInput& file, const StoredField& stored) {
  try {
    return load(file, stored);
  } catch (const Error& error) {
    // What a field says of its own limits lacks the file's name.
    if (error.code() == ErrorCode::input) throw;
    throw Error(error.code(), file.path().string() + ": " + error.what());
  }
}

}  // namespace difi
