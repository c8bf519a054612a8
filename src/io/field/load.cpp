#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <string>

#include "core/field_bytes.h"
#include "io/field/header_text.h"
#include "io/field/samples.h"
#include "standoff/error.h"

namespace standoff {
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
                "; the file is damaged or no distance field, write it again");
}

void check(const FieldInput& file, const StoredField& stored) {
  if (!(stored.thickness > 0))
    file.fail("the thickness " + text_of(stored.thickness) + " is not positive; write the file again");
  require_valid(file, stored.grid);
  file.require(stored.distance.offset, sample_bytes(stored.grid), "the array of distances");
  if (stored.nearest) file.require(stored.nearest->offset, sample_bytes(stored.grid), "the array of nearest triangles");
}

// Goes through the tiles of a file in order.
class TileWalk {
 public:
  TileWalk(const FieldInput& file, const StoredField& stored)
      : file_(file),
        size_(stored.grid.size),
        far_(static_cast<float>(stored.thickness)),
        values_(file, stored.distance, size_) {
    if (stored.nearest) nearest_.emplace(file, *stored.nearest, size_);
  }

  Size3 tile_count() const {
    const auto along = [](std::int64_t samples) { return (samples + kSide - 1) / kSide; };
    return {along(size_.x), along(size_.y), along(size_.z)};
  }

  // visit(tx, ty, tz, values, nearest) for each tile that is to be stored. Throws at a value that is none.
  template <class Visit>
  void operator()(Visit visit) const {
    std::array<float, kTile> tile;
    std::array<std::uint32_t, kTile> nearest;
    const Size3 tiles = tile_count();
    for (std::int64_t tz = 0; tz < tiles.z; ++tz)
      for (std::int64_t ty = 0; ty < tiles.y; ++ty)
        for (std::int64_t tx = 0; tx < tiles.x; ++tx) {
          const Size3 first{tx * kSide, ty * kSide, tz * kSide};
          values_.read(first, far_, tile);
          const TileContent found = content(tile, far_);
          if (found == TileContent::bad) fail_at_bad(file_, tile, far_, first);
          if (nearest_) nearest_->read(first, kNoTriangle, nearest);
          // A distance that equals the thickness lies in the band: only its nearest triangle tells it from a clamped
          // one.
          if (found == TileContent::far && !(nearest_ && has_triangle(nearest))) continue;
          visit(tx, ty, tz, tile, nearest);
        }
  }

 private:
  const FieldInput& file_;
  Size3 size_;
  float far_;
  TileReader<float> values_;
  std::optional<TileReader<std::uint32_t>> nearest_;
};

// A file whose tiles might not fit, were all of them stored, is gone through once to count them.
void check_memory(const FieldInput& file, const TileWalk& walk, bool with_nearest) {
  if (file.memory_limit() == 0) return;
  const auto limit = static_cast<double>(file.memory_limit()), all = static_cast<double>(walk.tile_count().count());
  if (field_bytes(all, all, with_nearest) <= limit) return;
  const double least = field_bytes(0, all, with_nearest);
  if (least > limit)
    throw Error(ErrorCode::limit, "its tiles need more than " + over_the_limit(least, limit) + "; give a higher limit",
                limit_details(least, limit));
  double stored = 0;
  walk([&](auto&&...) { ++stored; });
  const double needed = field_bytes(stored, all, with_nearest);
  if (needed > limit)
    throw Error(ErrorCode::limit, "its tiles need " + over_the_limit(needed, limit) + "; give a higher limit",
                limit_details(needed, limit));
}

DistanceField load(const FieldInput& file, const StoredField& stored) {
  check(file, stored);
  const bool with_nearest = stored.nearest.has_value();
  const TileWalk walk(file, stored);
  check_memory(file, walk, with_nearest);
  DistanceField field(stored.grid, stored.thickness, with_nearest);
  field.provenance = stored.provenance;
  walk([&](std::int64_t tx, std::int64_t ty, std::int64_t tz, const auto& values, const auto& nearest) {
    std::ranges::copy(values, field.store_tile(tx, ty, tz));
    if (with_nearest) std::ranges::copy(nearest, field.store_nearest(tx, ty, tz));
  });
  return field;
}

}  // namespace

void require_valid(const FieldInput& file, const Grid& grid) {
  try {
    validate(grid);
  } catch (const Error& error) {
    file.fail("header", std::string(diagnosis(error.what())) + "; write the file again");
  }
}

DistanceField load_field(const FieldInput& file, const StoredField& stored) {
  try {
    return load(file, stored);
  } catch (const Error& error) {
    // What a field says of its own limits lacks the file's name.
    if (error.code() == ErrorCode::input) throw;
    ErrorDetails details = error.details();
    details.file = file.path().string();
    throw Error(error.code(), details.file + ": " + error.what(), details);
  }
}

}  // namespace standoff
