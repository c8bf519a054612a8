// SPDX-License-Identifier: Apache-2.0
// What a field file is written of: a field with its sidecars, or a field that comes slab by slab; its arrays, a number
// or a few for each sample, x fastest; and their way into a file, block by block, plain or deflated on all cores.
// Arrays are made of the tiles piece by piece: runs of samples that are not stored are never written out in memory.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/tile_count.h"
#include "standoff/field.h"
#include "standoff/sidecars.h"
#include "standoff/slabs.h"

namespace standoff {

enum class NumberType { float32, uint32, uint8 };
constexpr std::size_t bytes_of(NumberType type) { return type == NumberType::uint8 ? 1 : 4; }

/// One array: distances, nearest triangles or a sidecar.
struct SampleArray {
  std::string name;
  NumberType type;
  int components;
  const std::byte* values;                   ///< tile after tile, as DistanceField::tile_values()
  std::array<std::byte, 4> outside, inside;  ///< each number of samples that are not stored

  std::size_t number_bytes() const { return bytes_of(type); }
  std::size_t element_bytes() const { return number_bytes() * static_cast<std::size_t>(components); }
};

/// The most numbers that a sidecar has for a sample.
inline constexpr int kMostComponents = 64;

/// The array of distances; in the second place, of values that lie elsewhere.
SampleArray distance_array(const DistanceField& field);
SampleArray distance_array(double thickness, const std::byte* values);
/// Distances, nearest triangles where there are any, sidecars.
std::vector<SampleArray> arrays_of(const DistanceField& field, std::span<const Sidecar> sidecars);
/// The names of arrays that mean something else in one of the formats: no sidecar has them.
std::set<std::string> reserved_names();
/// Throws Error{usage} unless names are good and differ, and there are as many numbers as stored samples have.
void check_sidecars(const DistanceField& field, std::span<const Sidecar> sidecars);

/// Which numbers of an array are elements of their own in a file.
struct ArrayPart {
  std::optional<int> component = std::nullopt;  ///< this one; otherwise all, those of a sample together

  std::size_t element_bytes(const SampleArray& array) const {
    return component ? array.number_bytes() : array.element_bytes();
  }
};

/// The element of a sample that is not stored.
std::string unstored_element(const SampleArray& array, const ArrayPart& part, bool inside);

/// Passes elements [begin, end) on in order: out.elements(bytes, count) for samples of stored tiles, out.run(element,
/// count) for others.
template <class Out>
void send_elements(const DistanceField& field, const SampleArray& array, const ArrayPart& part, std::int64_t begin,
                   std::int64_t end, Out& out) {
  const Size3 size = field.grid().size, tiles = field.tile_count();
  const std::string outside = unstored_element(array, part, false), inside = unstored_element(array, part, true);
  const auto unstored = [&](std::int32_t slot) {
    return reinterpret_cast<const std::byte*>((slot == DistanceField::kInside ? inside : outside).data());
  };
  const std::span<const std::int32_t> slots = field.slots();
  if (slots.empty()) return out.run(unstored(DistanceField::kOutside), static_cast<std::uint64_t>(end - begin));
  const std::size_t all = array.element_bytes(), number = array.number_bytes();
  std::array<std::byte, kTileSide * 4> gathered;
  while (begin < end) {
    const std::int64_t row = begin / size.x, j = row % size.y, k = row / size.y;
    const std::int64_t last = std::min(end, (row + 1) * size.x) - row * size.x;
    const std::int32_t* const of_row = slots.data() + tiles.x * (j / kTileSide + tiles.y * (k / kTileSide));
    const std::int64_t in_tile = kTileSide * (j % kTileSide + kTileSide * (k % kTileSide));
    for (std::int64_t i = begin - row * size.x; i < last;) {
      std::int64_t tx = i / kTileSide;
      const std::int32_t slot = of_row[tx];
      if (slot < 0) {
        while (kTileSide * ++tx < last && of_row[tx] == slot) {
        }
        const std::int64_t to = std::min(last, kTileSide * tx);
        out.run(unstored(slot), static_cast<std::uint64_t>(to - i));
        i = to;
        continue;
      }
      const std::int64_t to = std::min(last, kTileSide * (tx + 1)), count = to - i;
      const std::byte* from =
          array.values + (std::size_t{DistanceField::kTileSamples} * static_cast<std::size_t>(slot) +
                          static_cast<std::size_t>(in_tile + i % kTileSide)) *
                             all;
      if (part.component) {
        from += number * static_cast<std::size_t>(*part.component);
        for (std::int64_t n = 0; n < count; ++n, from += all)
          std::memcpy(gathered.data() + number * static_cast<std::size_t>(n), from, number);
        from = gathered.data();
      }
      out.elements(from, static_cast<std::uint64_t>(count));
      i = to;
    }
    begin = row * size.x + last;
  }
}

/// Views a field, which must outlive it.
class FieldSource {
 public:
  explicit FieldSource(const DistanceField& field, std::span<const Sidecar> sidecars = {});
  /// Slabs come once, so they have one array: the distances.
  explicit FieldSource(FieldSlabs& slabs);

  const Grid& grid() const { return grid_; }
  double thickness() const { return thickness_; }
  const Provenance& provenance() const { return provenance_; }
  /// The whole field. Only a source that was made of a field has it.
  bool is_whole() const { return whole_ != nullptr; }
  const DistanceField& whole() const { return *whole_; }
  /// Distances, nearest triangles where there are any, sidecars.
  const std::vector<SampleArray>& arrays() const { return arrays_; }

  /// Calls use(field, its array, number of its first sample) for the parts of an array in order. Throws Error{usage}
  /// where slabs do not make up the grid.
  template <class Use>
  void for_each_part(const SampleArray& array, const Use& use) const {
    if (whole_) return use(*whole_, array, std::int64_t{0});
    std::int64_t slices = 0;
    while (const DistanceField* slab = next_slab(slices)) {
      SampleArray part = array;
      part.values = distance_array(*slab).values;
      use(*slab, part, slices * grid_.size.x * grid_.size.y);
      slices += slab->grid().size.z;
    }
  }

 private:
  const DistanceField* next_slab(std::int64_t slices_before) const;

  const Grid& grid_;
  double thickness_;
  const Provenance& provenance_;
  const DistanceField* whole_ = nullptr;
  FieldSlabs* slabs_ = nullptr;
  std::vector<SampleArray> arrays_;
};

/// Takes bytes in order.
using ByteSink = std::function<void(std::span<const std::byte>)>;

/// Passes on all elements of an array.
void send_samples(const FieldSource& source, const SampleArray& array, const ArrayPart& part, const ByteSink& sink);

/// Elements in each deflated block but the last.
std::int64_t block_elements(const SampleArray& array, const ArrayPart& part);

enum class BlockKind {
  zlib,     ///< each a zlib stream of its own (RFC 1950)
  deflate,  ///< parts of a deflate stream that the caller ends
};
struct PackedBlock {
  std::string bytes;
  std::uint32_t crc = 0;  ///< CRC-32 of all unpacked bytes up to its end; of BlockKind::deflate
};

struct PackOptions {
  BlockKind kind = BlockKind::zlib;
  int threads = 0;
  std::uint32_t crc = 0;  ///< CRC-32 of what came before
};
/// Deflates all elements of an array, and hands the blocks over in order, one at a time. A block depends on its
/// elements alone. Memory: a few blocks for each thread.
void pack_samples(const FieldSource& source, const SampleArray& array, const ArrayPart& part,
                  const PackOptions& options, const std::function<void(const PackedBlock&)>& take);

/// Ends a stream of BlockKind::deflate.
inline constexpr std::string_view kDeflateEnd{"\x03\x00", 2};

}  // namespace standoff
