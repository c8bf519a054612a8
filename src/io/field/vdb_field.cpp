// SPDX-License-Identifier: Apache-2.0
#include "io/field/vdb_field.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "core/memory.h"
#include "core/number_text.h"
#include "files/zip.h"
#include "io/field/read_samples.h"
#include "standoff/error.h"

namespace standoff::vdb {
namespace {

// A block of LZ4: false unless it becomes exactly `to`.
bool unpack_lz4(std::string_view from, std::span<char> to) {
  std::size_t in = 0, out = 0;
  const auto more = [&](std::size_t& length) {
    for (unsigned char next = 255; next == 255; length += next) {
      if (in == from.size()) return false;
      next = static_cast<unsigned char>(from[in++]);
    }
    return true;
  };
  while (in < from.size()) {
    const auto token = static_cast<unsigned char>(from[in++]);
    std::size_t literals = token >> 4, match = token & 15;
    if (literals == 15 && !more(literals)) return false;
    if (literals > from.size() - in || literals > to.size() - out) return false;
    std::copy_n(from.data() + in, literals, to.data() + out);
    in += literals;
    out += literals;
    if (in == from.size()) return out == to.size();  // the last part has no match
    if (from.size() - in < 2) return false;
    const std::size_t distance =
        static_cast<unsigned char>(from[in]) | std::size_t{static_cast<unsigned char>(from[in + 1])} << 8;
    in += 2;
    if (match == 15 && !more(match)) return false;
    match += 4;
    if (distance == 0 || distance > out || match > to.size() - out) return false;
    for (; match > 0; --match, ++out) to[out] = to[out - distance];  // may overlap
  }
  return false;
}

std::uint32_t u32(std::string_view bytes, std::size_t at) {
  std::uint32_t number;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

}  // namespace

void unpack_blosc(const FileView& file, const std::string& where, std::string_view packed, std::span<char> to) {
  constexpr std::size_t kHeader = 16, kMostSplit = 16, kLeastSplit = 128;
  constexpr unsigned kShuffled = 1, kCopied = 2, kBitsShuffled = 4, kWhole = 16, kLz4 = 1;
  const auto fail = [&] { file.fail(where, "what Blosc packed is damaged; get the file again"); };
  if (packed.size() < kHeader) fail();
  const auto flags = static_cast<unsigned char>(packed[2]);
  const std::size_t type_bytes = std::max<std::size_t>(1, static_cast<unsigned char>(packed[3]));
  const std::size_t bytes = u32(packed, 4), block_bytes = u32(packed, 8), packed_bytes = u32(packed, 12);
  if (bytes != to.size() || packed_bytes != packed.size() || (bytes > 0 && block_bytes == 0)) fail();
  if (flags & kCopied) {
    if (packed.size() - kHeader != bytes) fail();
    std::copy_n(packed.data() + kHeader, bytes, to.data());
    return;
  }
  if (flags >> 5 != kLz4 || (flags & kBitsShuffled))
    file.fail(where, "Blosc packed it by another codec than LZ4, which is not read; save it with LZ4, zip or plain");
  const std::size_t blocks = bytes / block_bytes + (bytes % block_bytes > 0 ? 1 : 0);
  if (blocks > (packed.size() - kHeader) / 4) fail();
  std::vector<char> shuffled;
  for (std::size_t block = 0; block < blocks; ++block) {
    const std::size_t first = block * block_bytes, size = std::min(block_bytes, bytes - first);
    const bool split =
        !(flags & kWhole) && type_bytes <= kMostSplit && block_bytes / type_bytes >= kLeastSplit && size == block_bytes;
    const std::size_t parts = split ? type_bytes : 1, part_bytes = size / parts;
    if (part_bytes * parts != size) fail();
    std::span<char> out = to.subspan(first, size);
    const bool shuffle = (flags & kShuffled) && type_bytes > 1;
    if (shuffle) {
      shuffled.resize(size);
      out = shuffled;
    }
    std::size_t at = u32(packed, kHeader + 4 * block);
    for (std::size_t part = 0; part < parts; ++part) {
      if (at > packed.size() || packed.size() - at < 4) fail();
      const std::size_t length = u32(packed, at);
      at += 4;
      if (length > packed.size() - at) fail();
      const std::span<char> part_out = out.subspan(part * part_bytes, part_bytes);
      if (length == part_bytes)
        std::copy_n(packed.data() + at, length, part_out.data());
      else if (!unpack_lz4(packed.substr(at, length), part_out))
        fail();
      at += length;
    }
    if (!shuffle) continue;
    // All first bytes, all second ones and so on; what makes no whole number is at the end, as it is.
    const std::size_t numbers = size / type_bytes;
    for (std::size_t n = 0; n < numbers; ++n)
      for (std::size_t byte = 0; byte < type_bytes; ++byte)
        to[first + n * type_bytes + byte] = shuffled[byte * numbers + n];
    std::copy(shuffled.begin() + static_cast<std::ptrdiff_t>(numbers * type_bytes), shuffled.end(),
              to.begin() + static_cast<std::ptrdiff_t>(first + numbers * type_bytes));
  }
}

namespace {

std::string place(const Coordinates& at) {
  return "node (" + std::to_string(at[0]) + "," + std::to_string(at[1]) + "," + std::to_string(at[2]) + ")";
}

// Rounds towards minus infinity.
std::int64_t rounded_down(std::int64_t n, std::int64_t step) { return n - ((n % step) + step) % step; }

}  // namespace

FieldBuilder::FieldBuilder(const FileView& file, const Facts& facts, const FieldRequest& request)
    : file_(file), facts_(facts), request_(request), ours_(facts.size.has_value() && facts.thickness.has_value()) {
  const double thickness = ours_ ? *facts.thickness : facts.background;
  if (!(thickness > 0))
    file.fail("the background " + exact_text(thickness) +
              " is not positive, so it says no thickness; save a level set, whose background is its half width");
  facts_.thickness = thickness;
  far_ = static_cast<float>(thickness);
  least_.fill(std::numeric_limits<std::int64_t>::max());
  most_.fill(std::numeric_limits<std::int64_t>::min());
}

void FieldBuilder::grow(const Coordinates& at, std::int64_t x, std::int64_t y, std::int64_t z) {
  const std::array<std::int64_t, 3> by{x, y, z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    least_[axis] = std::min<std::int64_t>(least_[axis], at[axis] + by[axis]);
    most_[axis] = std::max<std::int64_t>(most_[axis], at[axis] + by[axis]);
  }
}

void FieldBuilder::find(const Leaf& leaf) {
  for (std::size_t n = 0; n < 512; ++n)
    if (leaf.active[n]) {
      const Size3 in_leaf = child_place<kLeafLog>(n);
      grow(leaf.at, in_leaf.x, in_leaf.y, in_leaf.z);
    }
}

void FieldBuilder::find(const Tile& tile) {
  if (!tile.active) return;
  grow(tile.at, 0, 0, 0);
  grow(tile.at, tile.side - 1, tile.side - 1, tile.side - 1);
}

void FieldBuilder::end_finding() {
  grid_.spacing = facts_.spacing;
  grid_.origin = facts_.origin;
  if (ours_) {
    grid_.size = *facts_.size;
  } else {
    if (least_[0] > most_[0]) file_.fail("no sample of the grid is active; save a level set of something");
    // The grid begins at a multiple of a leaf's side, so that leaves are tiles.
    for (std::size_t axis = 0; axis < 3; ++axis) base_[axis] = rounded_down(least_[axis], kLeafSide);
    grid_.size = {most_[0] - base_[0] + 1, most_[1] - base_[1] + 1, most_[2] - base_[2] + 1};
    grid_.origin = facts_.origin + facts_.spacing * Vec3{double(base_[0]), double(base_[1]), double(base_[2])};
  }
  require_valid(file_, grid_);
}

FieldBuilder::Range FieldBuilder::tiles_in(const Coordinates& at, std::int64_t side) const {
  const Size3 tiles = DistanceField::tiles_of(grid_.size);
  const std::array<std::int64_t, 3> all{tiles.x, tiles.y, tiles.z};
  std::array<std::int64_t, 3> first{}, last{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t from = (at[axis] - base_[axis]) / kLeafSide;  // a multiple
    first[axis] = std::clamp<std::int64_t>(from, 0, all[axis]);
    last[axis] = std::clamp<std::int64_t>(from + side / kLeafSide, 0, all[axis]);
  }
  return {{first[0], first[1], first[2]}, {last[0], last[1], last[2]}};
}

void FieldBuilder::count(const Leaf& leaf) {
  if (!tiles_in(leaf.at, kLeafSide).empty()) return void(++stored_);
  if (ours_) file_.fail(place(leaf.at), "it lies outside the grid; the file is damaged, write it again");
}

void FieldBuilder::count(const Tile& tile) {
  const Range range = tiles_in(tile.at, tile.side);
  if (range.empty() || is_clamped(checked(tile.value, tile.at))) return;
  stored_ += static_cast<double>(range.last.x - range.first.x) * static_cast<double>(range.last.y - range.first.y) *
             static_cast<double>(range.last.z - range.first.z);
}

void FieldBuilder::begin_filling() {
  const double needed = field_bytes(stored_, static_cast<double>(DistanceField::tiles_of(grid_.size).count()), false);
  const auto refuse = [&](const std::string& what, ErrorDetails details) {
    details.file = file_.path().string();
    throw Error(ErrorCode::limit, details.file + ": " + what, details);
  };
  if (const auto limit = static_cast<double>(request_.memory_limit); limit > 0 && needed > limit)
    refuse("its tiles need " + over_the_limit(needed, limit) + "; give a higher limit", limit_details(needed, limit));
  // A few bytes can ask for much memory: for a grid of which hardly anything is stored, or for tiles of one value.
  if (const auto most = static_cast<double>(most_unpacked(file_.size())); needed > 16 * most)
    refuse("its nodes lie so far apart that its tiles need " + over_the_limit(needed, 16 * most) +
               " for a file of its size; crop the grid",
           limit_details(needed, 16 * most));
  field_ = DistanceField(grid_, *facts_.thickness);
  field_.set_provenance(facts_.provenance);
}

// Other programs' values may be a little beyond the background.
float FieldBuilder::checked(float value, const Coordinates& at) const {
  if (std::isnan(value) || (ours_ && !(std::abs(value) <= far_) && !std::isinf(*facts_.thickness)))
    file_.fail(place(at), "the value " + exact_text(value) +
                              " is not a number, or larger in magnitude than the "
                              "thickness, " +
                              exact_text(far_) + "; the file is damaged, write it again");
  return std::clamp(value, -far_, far_);
}

void FieldBuilder::fill(const Leaf& leaf, std::span<const float, 512> values) {
  const Range range = tiles_in(leaf.at, kLeafSide);
  if (range.empty()) return;
  const Size3 first{8 * range.first.x, 8 * range.first.y, 8 * range.first.z}, size = grid_.size;
  std::array<float, 512> tile;
  bool outside = true, inside = true;
  for (std::size_t n = 0; n < 512; ++n) {
    const bool in_grid = first.x + static_cast<std::int64_t>(n >> 6) < size.x &&
                         first.y + static_cast<std::int64_t>(n >> 3 & 7) < size.y &&
                         first.z + static_cast<std::int64_t>(n & 7) < size.z;
    float value = checked(values[n], leaf.at);
    // Inactive values stand for the thickness, which may be infinite.
    if (!leaf.active[n] && ours_) value = std::signbit(value) ? -far_ : far_;
    tile[tile_sample(n)] = in_grid ? value : far_;
    if (in_grid) {
      outside = outside && value >= far_;
      inside = inside && value <= -far_;
    }
  }
  if (outside) return;
  if (inside) return field_.mark_inside(range.first.x, range.first.y, range.first.z);
  std::ranges::copy(tile, field_.store_tile(range.first.x, range.first.y, range.first.z).begin());
}

void FieldBuilder::fill(const Tile& tile) {
  const Range range = tiles_in(tile.at, tile.side);
  if (range.empty()) return;
  float value = checked(tile.value, tile.at);
  if (!tile.active && ours_) value = std::signbit(value) ? -far_ : far_;
  if (value >= far_) return;
  Leaf leaf{};
  std::array<float, 512> values;
  values.fill(value);
  for (std::size_t n = 0; n < 512; ++n) leaf.active.set(n);
  for (std::int64_t z = range.first.z; z < range.last.z; ++z)
    for (std::int64_t y = range.first.y; y < range.last.y; ++y)
      for (std::int64_t x = range.first.x; x < range.last.x; ++x) {
        if (value <= -far_) {
          field_.mark_inside(x, y, z);
          continue;
        }
        leaf.at = {static_cast<std::int32_t>(8 * x + base_[0]), static_cast<std::int32_t>(8 * y + base_[1]),
                   static_cast<std::int32_t>(8 * z + base_[2])};
        fill(leaf, values);
      }
}

}  // namespace standoff::vdb
